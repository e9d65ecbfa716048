"""The pages at /docs and /docs/live, without any foreign server.

Swagger UI comes with an installed package; the live WebSocket's page is ours.
"""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import FileResponse
from starlette.exceptions import HTTPException

from slidetune.server.contract.asyncapi import asyncapi_document
from slidetune.server.hosting.static_paths import WEB

_FILES = ("swagger-ui-bundle.js", "swagger-ui.css")


def _folder() -> Path:
    spec = find_spec("fastapi_offline")
    assert spec is not None
    assert spec.origin is not None
    return Path(spec.origin).parent / "static"


def docs_router() -> APIRouter:
    """Return the routes of the documentation page."""
    router = APIRouter(include_in_schema=False)
    folder = _folder()

    @router.get("/docs")
    async def page() -> FileResponse:
        return FileResponse(WEB / "docs" / "docs.html")

    @router.get("/docs/live")
    async def live_page() -> FileResponse:
        return FileResponse(WEB / "docs" / "live_docs.html")

    @router.get("/asyncapi.json")
    async def live_document(request: Request) -> dict[str, Any]:
        return asyncapi_document(request.headers.get("host", ""), request.url.scheme == "https")

    @router.get("/docs/{name}")
    async def bundle(name: str) -> FileResponse:
        if name not in _FILES:
            raise HTTPException(404, f"there is no file {name} here")
        return FileResponse(folder / name)

    return router
