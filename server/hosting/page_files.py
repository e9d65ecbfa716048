"""The page and its files: each version has addresses of its own, so that browsers keep them.

A page is more than two hundred files. Asked for again one by one they took more than half of what
a visit costs the server, whose process steps the session as well (0.28 s of processor against
0.12 s, *ours*, measured), and many round trips of a browser far away.
"""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

from fastapi import FastAPI
from fastapi.responses import FileResponse, HTMLResponse
from starlette.staticfiles import StaticFiles

from slidetune.server.hosting.static_paths import PLOTLY, WEB

REVALIDATED = "no-cache"
"""What a browser asks for again, so that an update is seen at once."""
KEPT = "private, max-age=31536000, immutable"
"""What never changes at its address; a year is the longest (*published*: RFC 2616, 14.21)."""
_ADDRESS = "/static/"


class _Files(StaticFiles):
    """A folder whose files a browser keeps in one way."""

    def __init__(self, directory: Path, cache: str) -> None:
        super().__init__(directory=directory)
        self._cache = cache

    def file_response(self, *args: Any, **kwargs: Any) -> Any:
        response = super().file_response(*args, **kwargs)
        response.headers["cache-control"] = self._cache
        return response


def serve_page(app: FastAPI, web: Path = WEB) -> None:
    """Add the page at ``/``, and its files at ``/static/`` and below the address of this version.

    The page names the latter. Whoever names a file without a version has it revalidated.

    Args:
        app: the application.
        web: folder of the page, as it is now; a change in it needs another start.
    """
    kept = f"{_ADDRESS}{_version(web)}/"
    page = (web / "index.html").read_text(encoding="utf-8").replace(_ADDRESS, kept)

    @app.get("/", include_in_schema=False)
    async def index() -> HTMLResponse:
        return HTMLResponse(page, headers={"cache-control": REVALIDATED})

    for folder, cache in ((kept, KEPT), (_ADDRESS, REVALIDATED)):
        _serve_plotly(app, folder, cache)
        app.mount(folder.rstrip("/"), _Files(web, cache))


def _serve_plotly(app: FastAPI, folder: str, cache: str) -> None:
    @app.get(f"{folder}plotly.min.js", include_in_schema=False)
    async def plotly_bundle() -> FileResponse:
        return FileResponse(PLOTLY, headers={"cache-control": cache})


def _version(web: Path) -> str:
    """Return a digest of everything that is served."""
    digest = hashlib.sha256(PLOTLY.read_bytes())
    for path in sorted(path for path in web.rglob("*") if path.is_file()):
        digest.update(f"{path.relative_to(web)}\0".encode() + path.read_bytes())
    return digest.hexdigest()[:16]
