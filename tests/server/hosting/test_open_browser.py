"""The token stands in no command line."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
import time
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import urlparse
from urllib.request import url2pathname

import pytest

from slidetune.server.hosting.open_browser import private_way

ADDRESS = "http://127.0.0.1:8000/?token=se-cret&x=<1>"


class Refresh(HTMLParser):
    """Finds where a page leads."""

    where = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if given.get("http-equiv") == "refresh":
            self.where = str(given["content"]).partition("url=")[2]


def test_a_browser_is_given_a_private_file_that_leads_to_the_address() -> None:
    with private_way(ADDRESS) as place:
        assert "se-cret" not in place
        path = Path(url2pathname(urlparse(place).path))
        about = path.stat()
        assert stat.S_IMODE(about.st_mode) == 0o600
        assert about.st_uid == os.getuid()
        page = Refresh()
        page.feed(path.read_text(encoding="utf-8"))
        assert page.where == ADDRESS
    assert not path.exists()


def test_an_address_without_a_token_is_opened_as_it_is() -> None:
    with private_way("http://127.0.0.1:8000/") as place:
        assert place == "http://127.0.0.1:8000/"


@pytest.mark.skipif(os.name != "posix", reason="a browser that is a script")
def test_the_server_opens_a_browser_that_is_told_no_token(tmp_path: Path) -> None:
    told, script = tmp_path / "told", tmp_path / "browser"
    script.write_text(f'#!/bin/sh\nprintf %s "$1" > "{told}.new" && mv "{told}.new" "{told}"\n')
    script.chmod(0o700)
    command = [sys.executable, "-m", "slidetune", "serve", "--token", "--port", "0"]
    environment = {**os.environ, "BROWSER": f"{script} %s"}
    with subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True) as server:
        try:
            end = time.monotonic() + 120.0
            while not told.exists():
                assert time.monotonic() < end, "no browser was opened"
                assert server.poll() is None
                time.sleep(0.05)
            place = told.read_text()
            assert "token" not in place
            page = Path(url2pathname(urlparse(place).path))
            assert "?token=" in page.read_text()
        finally:
            server.terminate()
            assert server.stderr is not None
            server.stderr.read()
    assert not page.exists()
