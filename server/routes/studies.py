"""Studies over HTTP: many runs, told line by line as they come."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import APIRouter, Body
from fastapi.responses import StreamingResponse
from pydantic import Field

from robot.study.knob import COUNT
from robot.study.plan import Trial, sensitivity, strip, switching_comparison
from robot.study.variant import figures
from server.contract import ErrorAnswer, Strict
from server.studio import Studio
from server.workers import WorkerLostError

NDJSON = "application/x-ndjson"
LINES: dict[int | str, dict[str, Any]] = {
    200: {"content": {NDJSON: {}}, "description": "One JSON object a line, as the runs end."},
    422: {"model": ErrorAnswer},
}


class StudyRequest(Strict):
    """Which lane of the live experiment."""

    lane: str = Field(examples=["RBFNN-NFTSM"])


class StripRequest(StudyRequest):
    """Which knob to try along its whole track."""

    field: str = Field(examples=["c"])
    count: int = Field(COUNT, ge=2, le=60)


class SensitivityRequest(StudyRequest):
    """How far to turn every knob."""

    change: float = Field(0.1, gt=0.0, le=0.9, description="Share by which each is changed.")


def studies_router(studio: Studio) -> APIRouter:
    """Return the routes of the studies."""
    router = APIRouter(prefix="/api/studies", tags=["studies"])

    def told(lane: str, trials: list[Trial]) -> StreamingResponse:
        experiment, revision = studio.document.experiment, studio.document.revision

        async def lines() -> AsyncIterator[str]:
            # One at a time: a preview that comes meanwhile waits for one run, not for all.
            for number, trial in enumerate(trials):
                try:
                    result = await studio.workers.run(figures, experiment, lane, trial.patch)
                except WorkerLostError as error:
                    result = {"state": "refused", "reason": str(error)}
                row = {
                    "number": number,
                    "count": len(trials),
                    "revision": revision,
                    **trial.document(),
                    **result,
                }
                yield json.dumps(row, allow_nan=False, ensure_ascii=False) + "\n"

        return StreamingResponse(lines(), media_type=NDJSON)

    @router.post("/strip", response_class=StreamingResponse, responses=LINES)
    async def one_knob(wanted: Annotated[StripRequest, Body()]) -> StreamingResponse:
        """Try one gain along its slider's track, the others fixed."""
        trials = strip(studio.document.experiment, wanted.lane, wanted.field, wanted.count)
        return told(wanted.lane, trials)

    @router.post("/sensitivity", response_class=StreamingResponse, responses=LINES)
    async def all_knobs(wanted: Annotated[SensitivityRequest, Body()]) -> StreamingResponse:
        """Turn every gain of a lane a little both ways: which knob next?"""
        trials = sensitivity(studio.document.experiment, wanted.lane, wanted.change)
        return told(wanted.lane, trials)

    @router.post("/switching", response_class=StreamingResponse, responses=LINES)
    async def smoothing(wanted: Annotated[StudyRequest, Body()]) -> StreamingResponse:
        """Accuracy against chattering: tanh over ε, then sign, saturation and tanh as they are."""
        trials = switching_comparison(studio.document.experiment, wanted.lane)
        return told(wanted.lane, trials)

    return router
