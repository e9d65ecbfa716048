"""Studies over HTTP: many runs, told line by line as they come."""

from __future__ import annotations

import asyncio
import itertools
import json
import os
from collections import deque
from collections.abc import AsyncIterator, Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Body
from fastapi.responses import StreamingResponse
from pydantic import Field

from slidetune.robot.fields.quantity import MOST_JOINTS
from slidetune.robot.knobs.knob import COUNT
from slidetune.robot.knobs.plan import Trial, sensitivity, strip, switching_comparison
from slidetune.robot.knobs.variant import figures
from slidetune.robot.loop.figures import STUDIED
from slidetune.server.compute.run_cost import refuse_if_costly
from slidetune.server.compute.workers import BusyError
from slidetune.server.contract.messages import ErrorAnswer, Strict
from slidetune.server.guard.concurrency_limit import ConcurrencyLimit
from slidetune.server.guard.limited_stream import LimitedStream
from slidetune.server.guard.limits import MAX_STUDIES, TooManyStudiesError
from slidetune.server.state.app_state import AppState

NDJSON = "application/x-ndjson"
AT_ONCE = max(2, min(8, (os.cpu_count() or 2) - 1))
"""Runs of a study that are under way at once (*ours*)."""
LINES: dict[int | str, dict[str, Any]] = {
    200: {"content": {NDJSON: {}}, "description": "One JSON object per line, as the runs end."},
    422: {"model": ErrorAnswer},
    429: {"model": ErrorAnswer},
}
_FULL = f"{MAX_STUDIES} studies are running already: try again when one of them has ended"


class StudyRequest(Strict):
    """Which lane of the live experiment."""

    lane: str = Field(examples=["RBFNN-NFTSM"])


class StripRequest(StudyRequest):
    """Which gain to vary along its slider's whole track."""

    field: str = Field(examples=["c"])
    count: int = Field(COUNT, ge=2, le=60)
    joint: int | None = Field(
        None,
        ge=1,
        le=MOST_JOINTS,
        description="Vary this joint's value alone; null: all joints, in proportion.",
    )


class SensitivityRequest(StudyRequest):
    """How far to vary every gain."""

    change: float = Field(
        0.1, gt=0.0, le=0.9, description="Fraction by which each gain is changed."
    )


def _line(trial: Trial, result: Mapping[str, Any], number: int, count: int, revision: int) -> str:
    row = {"number": number, "count": count, "revision": revision, **trial.document(), **result}
    return json.dumps(row, allow_nan=False, ensure_ascii=False) + "\n"


def studies_router(app_state: AppState) -> APIRouter:
    """Return the routes of the studies."""
    router = APIRouter(prefix="/api/studies", tags=["studies"])
    running = ConcurrencyLimit(MAX_STUDIES, lambda: TooManyStudiesError(_FULL))
    numbers = itertools.count()

    def told(lane: str, trials: list[Trial]) -> StreamingResponse:
        experiment, revision = app_state.document.experiment, app_state.document.revision
        refuse_if_costly(experiment)
        turn = f"study {next(numbers)}"

        async def figures_of(trial: Trial) -> dict[str, Any]:
            try:
                arguments = experiment, lane, trial.patch
                return await app_state.workers.run(figures, *arguments, client=turn)
            except BusyError as error:
                return {**dict.fromkeys(STUDIED), "state": "refused", "reason": str(error)}

        async def lines() -> AsyncIterator[str]:
            # One a core: a preview that comes meanwhile waits for one run, not for all.
            waiting = (asyncio.ensure_future(figures_of(trial)) for trial in trials)
            under_way = deque(itertools.islice(waiting, AT_ONCE))
            try:
                for number, trial in enumerate(trials):
                    result = await under_way.popleft()
                    under_way.extend(itertools.islice(waiting, 1))
                    told = number, len(trials), revision
                    yield _line(trial, result, *told)
            finally:
                for task in under_way:
                    task.cancel()

        return LimitedStream(running, lines(), NDJSON)

    @router.post("/strip", response_class=StreamingResponse, responses=LINES)
    async def one_knob(wanted: Annotated[StripRequest, Body()]) -> StreamingResponse:
        """Try one gain, of all joints or of one, along its slider's track, the others fixed."""
        experiment = app_state.document.experiment
        trials = strip(experiment, wanted.lane, wanted.field, wanted.count, wanted.joint)
        return told(wanted.lane, trials)

    @router.post("/sensitivity", response_class=StreamingResponse, responses=LINES)
    async def all_knobs(wanted: Annotated[SensitivityRequest, Body()]) -> StreamingResponse:
        """Vary every gain of a lane a little both ways: which gain to change next?"""
        trials = sensitivity(app_state.document.experiment, wanted.lane, wanted.change)
        return told(wanted.lane, trials)

    @router.post("/switching", response_class=StreamingResponse, responses=LINES)
    async def smoothing(wanted: Annotated[StudyRequest, Body()]) -> StreamingResponse:
        """Accuracy against chattering: tanh over ε, then sign, saturation and tanh as they are."""
        trials = switching_comparison(app_state.document.experiment, wanted.lane)
        return told(wanted.lane, trials)

    return router
