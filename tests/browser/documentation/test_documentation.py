"""The built site in a browser: over HTTP and from a disk, with every other address cut off."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, Route, expect

from tests.docs.built import built_once


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: Any) -> None:
        """Print nothing."""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the built site."""
    return built_once(tmp_path_factory)


@pytest.fixture(scope="module")
def over_http(site: Path) -> Iterator[str]:
    """Serve the site from a port of this machine."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=str(site)))
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    server.server_close()
    thread.join(30.0)


@pytest.fixture(params=["http", "disk"])
def address(request: pytest.FixtureRequest, site: Path) -> str:
    """Where the site is."""
    if request.param == "disk":
        return site.as_uri()
    found: str = request.getfixturevalue("over_http")
    return found


@pytest.mark.fresh
def test_it_is_read_and_searched_without_a_network(page: Page, address: str) -> None:
    asked: list[str] = []

    def cut(route: Route) -> None:
        asked.append(route.request.url)
        route.abort()

    page.context.route(lambda url: not url.startswith(address), cut)
    page.goto(f"{address}/index.html")
    expect(page.get_by_role("heading", name="Slidetune", level=1)).to_be_visible()
    picture = page.locator("article img").first
    expect(picture).to_have_js_property("complete", True)
    assert picture.evaluate("picture => picture.naturalWidth") > 1000

    page.goto(f"{address}/reference/python.html")
    expect(page.get_by_role("heading", name="load_preset").first).to_be_visible()
    page.get_by_role("button", name="Search").first.click()
    page.keyboard.type("leakage")
    found = page.get_by_role("option").filter(has_text="Gains of the laws")
    expect(found.first).to_be_visible()
    found.first.click()
    expect(page.get_by_role("heading", name="Gains of the laws", level=1)).to_be_visible()
    assert asked == []
