"""The live session and whole runs as files of numbers, over HTTP."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Body, Request, Response
from fastapi.responses import FileResponse
from pydantic import Field
from starlette.background import BackgroundTask
from starlette.concurrency import run_in_threadpool

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import simulate
from slidetune.server.compute.run_cost import refuse_if_costly
from slidetune.server.compute.workers import BusyError
from slidetune.server.contract.messages import ErrorAnswer, Strict
from slidetune.server.exports.apart import export_apart
from slidetune.server.exports.formats import MEDIA, Format
from slidetune.server.exports.recorded import Recorded
from slidetune.server.exports.recorded_run import recorded_run
from slidetune.server.exports.recorded_window import LONGEST, recorded_window
from slidetune.server.guard.concurrency_limit import ConcurrencyLimit
from slidetune.server.guard.disconnect import until_gone
from slidetune.server.guard.limits import MAX_EXPORTS
from slidetune.server.state.app_state import AppState

FILE: dict[str, Any] = {"schema": {"type": "string", "format": "binary"}}
ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {"content": {media: FILE for media in MEDIA.values()}, "description": "The file."},
    422: {"model": ErrorAnswer},
    503: {"model": ErrorAnswer},
    507: {"model": ErrorAnswer},
}
RUN_ANSWERS: dict[int | str, dict[str, Any]] = {
    **ANSWERS,
    204: {"description": "The client has disconnected."},
}
_FULL = f"{MAX_EXPORTS} exports are being written already: try again in a moment"


class WindowRequest(Strict):
    """How much of the live session to export, and as what."""

    format: Format = Field(examples=["mcap"])
    seconds: float = Field(
        10.0, gt=0.0, le=LONGEST, allow_inf_nan=False, description="Simulated time [s] at most."
    )


class RunRequest(Strict):
    """Which run to export, and as what."""

    format: Format = Field(examples=["parquet"])
    patch: dict[str, Any] = Field({}, description="Merge patch to the live experiment.")


def exports_router(app_state: AppState) -> APIRouter:
    """Return the routes of exports."""
    router = APIRouter(prefix="/api/exports", tags=["exports"])
    working = ConcurrencyLimit(MAX_EXPORTS, lambda: BusyError(_FULL))

    async def answer(recorded: Recorded, format: Format, name: str) -> Response:
        path = await run_in_threadpool(export_apart, recorded, format)
        return FileResponse(
            path,
            media_type=MEDIA[format],
            filename=f"{name}.{format}",
            headers={"cache-control": "no-store"},
            background=BackgroundTask(path.unlink, missing_ok=True),
        )

    @router.post("/window", response_class=Response, responses=ANSWERS)
    async def window(wanted: Annotated[WindowRequest, Body()]) -> Response:
        """The newest rows of the live session, with every edit in them.

        They go back at most to the last reset, change of lanes or of the arm, and as far as the
        session keeps them: 60,000 rows or so, a minute at 1 kHz. Numbers are of single precision.
        Columns have their units in their names; ``revision`` counts the edits. MCAP has the edits
        and gains as messages, Parquet the edits in its metadata.
        """
        with working.one():
            recorded = await run_in_threadpool(recorded_window, app_state, wanted.seconds)
            return await answer(recorded, wanted.format, "slidetune-window")

    @router.post("/run", response_class=Response, responses=RUN_ANSWERS)
    async def run(request: Request, wanted: Annotated[RunRequest, Body()]) -> Response:
        """A whole run of the live experiment from its beginning, every row, in full precision."""
        experiment = app_state.experiment_of(None, wanted.patch)
        refuse_if_costly(experiment)
        with working.one():
            turn = f"export {request.client.host if request.client else ''}"
            work = app_state.workers.run(_run, experiment, client=turn)
            recorded = await until_gone(request, work)
            if recorded is None:
                return Response(status_code=204)
            return await answer(recorded, wanted.format, "slidetune-run")

    return router


def _run(experiment: Experiment, *, stop: Any) -> Recorded:
    return recorded_run(simulate(experiment, stop=stop, estimate=False))
