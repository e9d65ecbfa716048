"""A page without the 3D scene: an empty document stands in its frame."""

from __future__ import annotations

from base64 import b64encode
from typing import Any

from playwright.sync_api import Page

_EMPTY = b64encode(b"<!doctype html><title>no scene</title>").decode()
_ANSWER = {
    "responseCode": 200,
    "responseHeaders": [{"name": "content-type", "value": "text/html"}],
    "body": _EMPTY,
}


def empty_scene(page: Page) -> None:
    """Answer for the scene as long as the page lives, whatever it opens.

    Not with `Page.route`: that has Chromium load every other file of the page anew as well.
    """
    session = page.context.new_cdp_session(page)

    def answer(paused: dict[str, Any]) -> None:
        session.send("Fetch.fulfillRequest", {"requestId": paused["requestId"], **_ANSWER})

    session.on("Fetch.requestPaused", answer)
    scene = {"urlPattern": "*/scene/*", "resourceType": "Document"}
    session.send("Fetch.enable", {"patterns": [scene]})
