"""The pages that people write: those of docs/, the contribution guide, the changelog, the licence.

On a Git host they are read where they lie, so that their links are those of the repository. Here
links to what is no page of the site lead to its own page of that name.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from docs.site.notebook_page import notebook_page

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
TOP_PAGES = {"CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
"""Pages at the top of the repository, and what they are called in the site."""
LICENSE = "license.md"
FILES = (".png", ".svg", ".yaml", ".ipynb")
"""Kinds of files that pages show or link to."""
_LINK = re.compile(r"(?<=\]\()([^)#\s]+)(?=[)#])")


def written_pages() -> list[Path]:
    """Return every page of docs/, below its own folder of sources apart."""
    return sorted(path for path in DOCS.rglob("*.md") if "site" not in path.parts)


def _in_site(target: str, folder: Path) -> str:
    """Return where a relative link of a page in ``folder`` leads in the site."""
    path = (folder / target).resolve()
    names = {ROOT / name: place for name, place in TOP_PAGES.items()}
    names |= {ROOT / "LICENSE": LICENSE, ROOT / "README.md": "index.md"}
    if path in names:
        up = "../" * len(folder.relative_to(DOCS).parts) if folder.is_relative_to(DOCS) else ""
        return up + names[path]
    return path.relative_to(DOCS).as_posix() if folder == ROOT else target


def for_site(text: str, folder: Path) -> str:
    """Return a page with its links as the site needs them.

    Args:
        text: the page as it lies in the repository.
        folder: where it lies.
    """

    def moved(match: re.Match[str]) -> str:
        target = match[1]
        return target if "://" in target else _in_site(target, folder)

    return _LINK.sub(moved, text)


def stage_pages(into: Path) -> None:
    """Copy the pages, and the pictures that they show, into a folder."""
    for path in sorted(DOCS.rglob("*")):
        place = into / path.relative_to(DOCS)
        if "site" in path.relative_to(DOCS).parts or not path.is_file():
            continue
        place.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".md":
            text = for_site(path.read_text(encoding="utf-8"), path.parent)
            place.write_text(text, encoding="utf-8")
        elif path.suffix in FILES:
            shutil.copyfile(path, place)
        if path.suffix == ".ipynb":
            text = notebook_page(path.read_text(encoding="utf-8"), path.name)
            place.with_suffix(".md").write_text(text, encoding="utf-8")
    for name, called in TOP_PAGES.items():
        text = for_site((ROOT / name).read_text(encoding="utf-8"), ROOT)
        (into / called).write_text(text, encoding="utf-8")
    text = (ROOT / "LICENSE").read_text(encoding="utf-8")
    (into / LICENSE).write_text(f"# Licence\n\n{text}", encoding="utf-8")
