"""Opens the dashboard in a browser without showing its token to the other people of a machine."""

from __future__ import annotations

import html
import os
import tempfile
import threading
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_PAGE = """<!doctype html><html lang="en"><meta charset="utf-8">
<meta name="referrer" content="no-referrer">
<meta http-equiv="refresh" content="0;url={address}"><title>Slidetune</title>
<p><a href="{address}">Open the dashboard</a></p></html>
"""


@contextmanager
def private_way(address: str) -> Iterator[str]:
    """Yield what a browser is to open: a file of this user's that leads to an address with a token.

    Everybody on a machine can read the command lines of all programs, the browser's too; nobody
    else can read this file. It is gone at the end of the block.

    Args:
        address: where to lead; one without a query is yielded as it is.
    """
    if "?" not in address:
        yield address
        return
    number, name = tempfile.mkstemp(prefix="slidetune-", suffix=".html")  # mode 0600
    path = Path(name)
    try:
        with os.fdopen(number, "w", encoding="utf-8") as file:
            file.write(_PAGE.format(address=html.escape(address)))
        yield path.as_uri()
    finally:
        path.unlink(missing_ok=True)


def open_browser(place: str) -> None:
    """Open a place in a browser, without waiting for it."""
    threading.Thread(target=webbrowser.open, args=(place,), daemon=True).start()
