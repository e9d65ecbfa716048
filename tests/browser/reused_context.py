"""A browser context that tests use one after another, put back to its beginning between them.

A page that is loaded once more takes a third of the time of the first one: Chromium keeps its
files, and its compiled code as long as the page lives.
"""

from __future__ import annotations

from typing import Any
from urllib.parse import urlsplit

from playwright.sync_api import Browser, BrowserContext, Page

from tests.browser.empty_scene import empty_scene

EMPTY = "about:blank"


class ReusedContext:
    """One context of a browser with one page without the scene, as good as fresh for each test.

    What can't be taken back (an init script, a routed WebSocket) needs a context of its own;
    listeners stay, and hear the next test too.
    """

    def __init__(self, browser: Browser, options: dict[str, Any]) -> None:
        """Open nothing yet; the options are those of ``Browser.new_context``."""
        self._browser = browser
        self._options = options
        self._context: BrowserContext | None = None

    def open(self) -> BrowserContext:
        """Return the context: it has one page, which is empty."""
        if self._context is None:
            self._context = self._browser.new_context(**self._options)
            empty_scene(self._context.new_page())
        return self._context

    def clean(self) -> None:
        """Leave every page but one, and forget what the pages stored, routed and were set to."""
        assert self._context is not None
        page, *others = self._context.pages
        for other in others:
            other.close()
        origin = urlsplit(page.url)._replace(path="", query="", fragment="").geturl()
        self._context.unroute_all()
        page.unroute_all()
        page.goto(EMPTY)
        self._forget(page, origin)
        page.set_viewport_size(self._options["viewport"])
        page.emulate_media(media="null", color_scheme="null", reduced_motion="null")
        page.mouse.move(0, 0)

    def close(self) -> None:
        """Close the context; the next one is a fresh one."""
        if self._context is not None:
            self._context.close()
        self._context = None

    def _forget(self, page: Page, origin: str) -> None:
        assert self._context is not None
        self._context.clear_cookies()
        storage = self._context.new_cdp_session(page)
        storage.send("Storage.clearDataForOrigin", {"origin": origin, "storageTypes": "all"})
        storage.detach()
