"""The built site: all of it is there, its links lead somewhere, and it needs no network."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urljoin, urlparse

from docs.site.build import HERE
from docs.site.notebook_page import notebook_page
from docs.site.written_pages import DOCS, written_pages
from tests.docs.built import Html
from tests.docs.pages import ROOT, anchors

STYLE_ADDRESS = re.compile(r"url\(\s*['\"]?(?!data:|#)([^'\")]+)|@import\s+['\"]([^'\"]+)")
ELSEWHERE = re.compile(r"(?:https?:)?//")


def listed(nav: list[dict[str, Any]]) -> list[str]:
    """Return the pages of a navigation."""
    found: list[str] = []
    for entry in nav:
        for value in entry.values():
            found += listed(value) if isinstance(value, list) else [value]
    return found


def navigation() -> list[str]:
    settings = tomllib.loads((HERE / "zensical.toml").read_text(encoding="utf-8"))
    return listed(settings["project"]["nav"])


def test_every_page_stands_in_the_navigation_once() -> None:
    pages = navigation()
    assert len(pages) == len(set(pages))
    notebooks = [path.with_suffix(".md") for path in (DOCS / "notebooks").glob("*.ipynb")]
    written = {page.relative_to(DOCS).as_posix() for page in (*written_pages(), *notebooks)}
    assert written - set(pages) == set()


def test_every_page_of_the_navigation_is_built(built: dict[str, Html]) -> None:
    wanted = {Path(page).with_suffix(".html").as_posix() for page in navigation()}
    assert wanted | {"404.html"} == set(built)


def test_every_link_of_the_site_leads_to_a_page_and_an_anchor(
    site: Path, built: dict[str, Html]
) -> None:
    lost = []
    for name, page in built.items():
        for link in (*page.links, *page.loaded):
            address = urlparse(urljoin(f"http://site/{name}", link))
            if address.scheme != "http" or address.netloc != "site":
                continue
            path = unquote(address.path).lstrip("/") or "index.html"
            target = built.get(path)
            anchor = unquote(address.fragment)
            if not (site / path).is_file():
                lost.append(f"{name}: {link}: no such file")
            elif anchor and target and anchor not in target.ids and name != "404.html":
                lost.append(f"{name}: {link}: no such anchor")
    assert lost == []


def test_nothing_is_loaded_from_elsewhere(site: Path, built: dict[str, Html]) -> None:
    loaded = [f"{name}: {one}" for name, page in built.items() for one in page.loaded]
    assert len(loaded) > 100
    assert [one for one in loaded if ELSEWHERE.match(one.split(": ", 1)[1])] == []
    for style in site.rglob("*.css"):
        text = style.read_text(encoding="utf-8")
        addresses = ["".join(found) for found in STYLE_ADDRESS.findall(text)]
        assert [one for one in addresses if ELSEWHERE.match(one)] == [], style.name


def test_headings_have_the_anchors_that_a_git_host_gives_them(built: dict[str, Html]) -> None:
    for page in written_pages():
        name = page.relative_to(DOCS).with_suffix(".html").as_posix()
        assert anchors(page) - built[name].ids == set(), name


def test_what_is_a_list_or_a_table_on_a_git_host_is_one_here(site: Path) -> None:
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        for paragraph in re.findall(r"<p>(.*?)</p>", text, re.DOTALL):
            assert not re.search(r"^(- |\d+\. |\| )", paragraph, re.MULTILINE), (
                f"{page.name}: {paragraph[:200]}"
            )


def test_a_notebook_becomes_a_page_with_its_code() -> None:
    cells = [
        {"cell_type": "markdown", "source": ["# Title\n", "\n", "Words."]},
        {"cell_type": "code", "source": ["x = 1\n", "x"], "outputs": []},
        {"cell_type": "markdown", "source": "The end."},
    ]
    text = notebook_page(json.dumps({"cells": cells}), "one.ipynb")
    assert text.startswith("# Title\n\nWords.\n\n[The notebook itself](one.ipynb)")
    assert text.endswith("```python\nx = 1\nx\n```\n\nThe end.\n")


def test_building_writes_nothing_into_the_repository(site: Path) -> None:
    assert not site.is_relative_to(ROOT)
    assert not any(path.suffix == ".html" for path in DOCS.rglob("*"))
    assert sorted(path.name for path in site.parent.iterdir()) == ["site"]
