"""The site: written and generated pages side by side, made into HTML by Zensical.

Everything is put together in a folder beside the site, so that nothing is written into docs/. No
step needs a network, nor do the pages: no font, script or picture comes from elsewhere.
"""

from __future__ import annotations

import asyncio
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from docs.site.command_page import command_page
from docs.site.field_pages import fields_page, gains_page
from docs.site.http_pages import http_page, messages_page
from docs.site.live_page import live_page
from docs.site.own_documents import own_documents
from docs.site.python_page import python_page, stage_sources
from docs.site.written_pages import ROOT, stage_pages

HERE = Path(__file__).parent
STAGING = ".site"
"""Folder beside the site in which it is put together."""
SHIM = re.compile(r"https://[\w./-]+/iframe-worker/shim")
"""What Zensical loads so that its search works from a disk; ours takes its place."""
SEARCH_FROM_DISK = "search_from_disk.js"


class SiteError(RuntimeError):
    """The site could not be built; the message says what Zensical complains of."""


def generated_pages() -> Mapping[str, str]:
    """Return the pages of the reference as Markdown, by the name of their file."""
    openapi, asyncapi = asyncio.run(own_documents())
    return {
        "reference/python.md": python_page(),
        "reference/commands.md": command_page(),
        "reference/experiment.md": fields_page(),
        "reference/gains.md": gains_page(),
        "reference/http.md": http_page(openapi),
        "reference/http-messages.md": messages_page(openapi),
        "reference/websocket.md": live_page(asyncapi),
    }


def _use_own_shim(site: Path) -> None:
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        up = "../" * (len(page.relative_to(site).parts) - 1)
        text, count = SHIM.subn(f"{up}{SEARCH_FROM_DISK}", text)
        if count != 1:
            raise SiteError(f"{page.name} loads the shim for workers {count} times, not once")
        page.write_text(text, encoding="utf-8")
    shutil.copyfile(HERE / SEARCH_FROM_DISK, site / SEARCH_FROM_DISK)


def build(site: Path) -> None:
    """Build the site.

    Args:
        site: folder for it; what is in there is replaced. Its neighbour `.site` is used meanwhile.

    Raises:
        SiteError: if Zensical finds something wrong, such as a link that leads nowhere.
    """
    staging = site.parent / STAGING
    shutil.rmtree(staging, ignore_errors=True)
    pages = staging / "pages"
    stage_pages(pages)
    for name, text in generated_pages().items():
        path = pages / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    shutil.copyfile(HERE / "looks.css", pages / "looks.css")
    stage_sources(staging / "sources")
    settings = shutil.copyfile(HERE / "zensical.toml", staging / "zensical.toml")
    command = [sys.executable, "-m", "zensical", "build", "--strict", "--config-file"]
    run = subprocess.run(
        [*command, str(settings)], cwd=staging, capture_output=True, text=True, check=False
    )
    if run.returncode:
        raise SiteError(f"Zensical did not build the site:\n{run.stdout}{run.stderr}")
    _use_own_shim(staging / "site")
    shutil.rmtree(site, ignore_errors=True)
    (staging / "site").rename(site)
    shutil.rmtree(staging)


__all__ = ["ROOT", "SiteError", "build", "generated_pages"]
