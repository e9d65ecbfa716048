"""The built site: built once in a test session, by whichever of its processes comes first."""

from __future__ import annotations

import fcntl
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from tests.docs.pages import ROOT


def built_once(factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the site; builds it as ``make docs`` does, but into another folder."""
    base = factory.getbasetemp()
    if base.name.startswith("popen-"):  # one of several processes: their parent is shared
        base = base.parent
    site = base / "documentation" / "site"
    site.parent.mkdir(exist_ok=True)
    with (base / "documentation.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not site.exists():
            command = [sys.executable, "-m", "docs.site", str(site)]
            done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stdout + done.stderr
    return site


@dataclass
class Html(HTMLParser):
    """What a page links to, what it loads, and where it can be linked to.

    Attributes:
        links: targets of links.
        loaded: addresses of scripts, style sheets, pictures and frames.
        ids: anchors.
        text: everything that is read.
    """

    path: Path
    links: list[str] = field(default_factory=list)
    loaded: list[str] = field(default_factory=list)
    ids: set[str] = field(default_factory=set)
    text: str = ""

    def __post_init__(self) -> None:
        """Read the page."""
        super().__init__()
        self._quiet = 0
        self.feed(self.path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take note of an element."""
        given: dict[str, Any] = dict(attrs)
        if given.get("id"):
            self.ids.add(given["id"])
        if tag == "a" and given.get("href"):
            self.links.append(given["href"])
        if tag == "link" and given.get("rel") != "canonical" and given.get("href"):
            self.loaded.append(given["href"])
        for name in ("src", "srcset", "data", "poster"):
            if given.get(name):
                self.loaded.append(given[name])
        if tag in ("script", "style"):
            self._quiet += 1

    def handle_endtag(self, tag: str) -> None:
        """Take note of the end of an element."""
        if tag in ("script", "style"):
            self._quiet -= 1

    def handle_data(self, data: str) -> None:
        """Take note of text."""
        if not self._quiet:
            self.text += data


def html_pages(site: Path) -> Iterator[Html]:
    """Yield every page of the site."""
    yield from (Html(path) for path in sorted(site.rglob("*.html")))
