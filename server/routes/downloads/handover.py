"""A lane for a real controller over HTTP: its package as an archive."""

from __future__ import annotations

import re
from typing import Annotated, Any

from fastapi import APIRouter, Body, Response
from pydantic import Field
from starlette.concurrency import run_in_threadpool

from slidetune.robot.handover.gains_file import CONTROLLER
from slidetune.robot.handover.package import zipped
from slidetune.server.compute.workers import BusyError
from slidetune.server.contract.messages import ErrorAnswer, Strict
from slidetune.server.guard.concurrency_limit import ConcurrencyLimit
from slidetune.server.guard.limits import MAX_HAND_OVERS
from slidetune.server.handover.apart import check_hand_over, hand_over_apart
from slidetune.server.state.app_state import AppState

ZIP = "application/zip"
ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {
        "content": {ZIP: {"schema": {"type": "string", "format": "binary"}}},
        "description": "One folder: README.md, law.c, law.h, law.py, gains.yaml, experiment.yaml, "
        "conditions.md, conditions.json, vectors.csv, a check and a manifest of digests.",
    },
    422: {"model": ErrorAnswer},
    503: {"model": ErrorAnswer},
}
_FULL = f"{MAX_HAND_OVERS} hand-overs are being made already: try again in a moment"


class HandOverRequest(Strict):
    """Which lane of the live experiment to hand over, and as what."""

    lane: str = Field(examples=["RBFNN-NFTSM"])
    controller: str = Field(CONTROLLER, description="Name of the controller in gains.yaml.")
    draws: int = Field(
        0, ge=0, le=200, description="Draws of what is uncertain, where anything is."
    )


def handover_router(app_state: AppState) -> APIRouter:
    """Return the route of the hand-over."""
    router = APIRouter(prefix="/api", tags=["experiment"])
    working = ConcurrencyLimit(MAX_HAND_OVERS, lambda: BusyError(_FULL))

    @router.post("/hand-over", response_class=Response, responses=ANSWERS)
    async def hand_over(wanted: Annotated[HandOverRequest, Body()]) -> Response:
        """Make what a real controller needs to run a lane's gains; see docs/hand-over.md.

        It is made in a process apart, of the live experiment as it is when it is asked for.
        """
        experiment = app_state.document.experiment
        draws = check_hand_over(experiment, wanted.lane, wanted.controller, wanted.draws)
        with working.one():
            files = await run_in_threadpool(
                hand_over_apart, experiment, wanted.lane, wanted.controller, draws
            )
        name = _file_name(wanted.lane)
        headers = {
            "content-disposition": f'attachment; filename="{name}.zip"',
            "cache-control": "no-store",
        }
        return Response(zipped(files, name), media_type=ZIP, headers=headers)

    return router


def _file_name(lane: str) -> str:
    """Return a lane's name as that of a folder, on every system."""
    return re.sub(r"[^A-Za-z0-9_-]+", "-", lane).strip("-") or "lane"
