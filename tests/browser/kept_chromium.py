"""The Chromiums of a process of tests, started when first asked for and kept from file to file."""

from __future__ import annotations

import os
from contextlib import ExitStack
from typing import Any

from playwright.sync_api import Browser, Playwright, sync_playwright

from tests.browser.chromium import FLAGS, FLAT_FLAGS, VARIABLE, find
from tests.browser.reused_context import ReusedContext


class KeptChromium:
    """A Chromium without WebGL whose page is used again, and one that has it.

    Playwright's event loop runs for as long as they are kept; whoever runs one of their own in the
    same thread closes this first.
    """

    def __init__(self) -> None:
        """Start nothing yet."""
        self._open = ExitStack()
        self._playwright: Playwright | None = None
        self._browsers: dict[tuple[str, ...], Browser] = {}
        self._reused: tuple[dict[str, Any], ReusedContext] | None = None

    def webgl(self) -> Browser:
        """Return the one that draws the 3D scene."""
        return self._browser(FLAGS)

    def reused(self, window: dict[str, Any]) -> ReusedContext:
        """Return the context that tests use one after another.

        Args:
            window: options of ``Browser.new_context``; others than before make it a fresh one.
        """
        if self._reused is None or self._reused[0] != window:
            self._leave()
            self._reused = window, ReusedContext(self._browser(FLAT_FLAGS), window)
        return self._reused[1]

    def close(self) -> None:
        """End all of them, and Playwright; what is asked for next starts anew."""
        self._leave()
        self._open.close()
        self._browsers.clear()
        self._playwright = None

    def _browser(self, flags: tuple[str, ...]) -> Browser:
        if self._playwright is None:
            self._playwright = self._open.enter_context(sync_playwright())
        if flags not in self._browsers:
            program = os.environ.get(VARIABLE) or find()
            launched = self._playwright.chromium.launch(executable_path=program, args=list(flags))
            self._browsers[flags] = self._open.enter_context(launched)
        return self._browsers[flags]

    def _leave(self) -> None:
        if self._reused is not None:
            self._reused[1].close()
        self._reused = None
