"""The owner's last results over HTTP: read by all, computed for nobody."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Response

from slidetune.server.contract.messages import ErrorAnswer
from slidetune.server.routes.lens import LensName
from slidetune.server.routes.preview import BINARY
from slidetune.server.state.app_state import AppState

JSON = "application/json"
NONE_YET = {"description": "None has been requested yet."}
RESPONSE: dict[int | str, dict[str, Any]] = {
    200: {"content": {BINARY: {}}, "description": "As ``POST /api/preview`` answered it."},
    204: NONE_YET,
}
LOOK: dict[int | str, dict[str, Any]] = {
    200: {
        "content": {JSON: {}},
        "description": "As ``POST /api/lens`` answered it, with the whole ``experiment``.",
    },
    204: NONE_YET,
    422: {"model": ErrorAnswer},
}


def results_router(app_state: AppState) -> APIRouter:
    """Return the routes of the last results."""
    router = APIRouter(prefix="/api/results", tags=["results"])

    @router.get("/response", response_class=Response, responses=RESPONSE)
    async def response() -> Response:
        """The last exact response requested for the live experiment.

        Its ``revision`` says whether the experiment has changed since. ``results`` of
        ``GET /api/session`` counts them.
        """
        return _answer(app_state.results.response, BINARY)

    @router.get("/lens", response_class=Response, responses=LOOK)
    async def look(
        lane: Annotated[str, Query(examples=["RBFNN-NFTSM"])], lens: Annotated[LensName, Query()]
    ) -> Response:
        """The last result of a lens for a lane of the live experiment."""
        return _answer(app_state.results.look(lane, lens), JSON)

    return router


def _answer(kept: bytes | None, media_type: str) -> Response:
    if kept is None:
        return Response(status_code=204)
    return Response(kept, media_type=media_type, headers={"cache-control": "no-store"})
