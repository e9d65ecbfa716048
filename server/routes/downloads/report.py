"""A report of the live experiment over HTTP: one HTML file."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Body, Request, Response
from pydantic import Field

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import simulate
from slidetune.server.compute.run_cost import refuse_if_costly
from slidetune.server.compute.workers import BusyError
from slidetune.server.contract.messages import ErrorAnswer, Strict
from slidetune.server.guard.concurrency_limit import ConcurrencyLimit
from slidetune.server.guard.disconnect import until_gone
from slidetune.server.guard.limits import MAX_REPORTS
from slidetune.server.report.run_report import report
from slidetune.server.run_report.apart import record_apart
from slidetune.server.run_report.page import run_report
from slidetune.server.state.app_state import AppState

HTML = "text/html"
ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {
        "content": {HTML: {"schema": {"type": "string"}}},
        "description": "One file that needs no network; see docs/report.md.",
    },
    204: {"description": "The client has disconnected."},
    422: {"model": ErrorAnswer},
    503: {"model": ErrorAnswer},
}
_FULL = f"{MAX_REPORTS} reports are being made already: try again in a moment"


class ReportRequest(Strict):
    """What the report's figures cover."""

    since: float = Field(
        0.0, ge=0.0, allow_inf_nan=False, description="Ignore everything before this time [s]."
    )


def report_router(app_state: AppState) -> APIRouter:
    """Return the route of the report."""
    router = APIRouter(prefix="/api", tags=["experiment"])
    working = ConcurrencyLimit(MAX_REPORTS, lambda: BusyError(_FULL))

    @router.post("/report", response_class=Response, responses=ANSWERS)
    async def make_report(request: Request, wanted: Annotated[ReportRequest, Body()]) -> Response:
        """Run the live experiment over its horizon and report on it; see docs/report.md.

        It is of the live experiment as it is when it is asked for, made beside the session: by the
        threads that make whole runs, and what records the replay in a process apart.
        """
        experiment = app_state.document.experiment
        horizon = experiment.simulation.horizon
        if not wanted.since < horizon:
            text = f"must be less than the horizon of {horizon:g} s, got {wanted.since:g}"
            raise InvalidExperimentError([FieldError("since", f"since {text}", wanted.since)])
        refuse_if_costly(experiment)
        turn = f"report {request.client.host if request.client else ''}"
        with working.one():
            work = app_state.workers.run(_made, experiment, wanted.since, client=turn)
            made = await until_gone(request, work)
        if made is None:
            return Response(status_code=204)
        headers = {
            "content-disposition": 'attachment; filename="report.html"',
            "cache-control": "no-store",
        }
        return Response(made, media_type=HTML, headers=headers)

    return router


def _made(experiment: Experiment, since: float, stop: Any) -> bytes:
    run = simulate(experiment, stop=stop)
    return run_report(run, report(run, since), record_apart).html.encode()
