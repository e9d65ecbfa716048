"""The past over HTTP: edits and the way back, recorded moments, branches."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Body
from pydantic import Field
from starlette.exceptions import HTTPException

from slidetune.robot.experiment.document import LaneName
from slidetune.server.contract.messages import ErrorAnswer, ExperimentAnswer, Strict
from slidetune.server.routes.experiment import answer
from slidetune.server.state.app_state import AppState

REFUSED: dict[int | str, dict[str, Any]] = {
    404: {"model": ErrorAnswer},
    422: {"model": ErrorAnswer},
}


class Fork(Strict):
    """Where to branch off, and into what."""

    time: float = Field(ge=0.0, allow_inf_nan=False, description="Time to go back to [s].")
    origin: str = Field(description="The lane whose past the new one continues.")
    name: LaneName = Field(description="Name of the new lane.")
    gains: dict[str, Any] = Field({}, description="Merge patch to the gains of its origin.")


class Look(Strict):
    """Which past moment the 3D scene shows."""

    time: float | None = Field(ge=0.0, allow_inf_nan=False, description="``null``: the present.")


def history_router(app_state: AppState) -> APIRouter:
    """Return the routes of the past."""
    router = APIRouter(prefix="/api", tags=["history"])

    @router.get("/history")
    async def edits() -> dict[str, Any]:
        """Every edit of this session: who, when, which field, from, to."""
        return {"edits": app_state.history.entries()}

    @router.post("/history/{number}/restore", response_model=ExperimentAnswer, responses=REFUSED)
    def restore(number: int) -> dict[str, Any]:
        """Go back to the experiment as it was after an edit; time and states continue."""
        experiment = app_state.history.after(number)
        if experiment is None:
            raise HTTPException(404, f"edit {number} is no longer in the history")
        change = app_state.document.restore(experiment, author="history")
        return answer(change.revision, app_state.document.preset, change.experiment)

    @router.get("/session/past")
    async def past() -> dict[str, Any]:
        """The moments that can be shown: the last minute of simulated time."""
        span = app_state.session.recorder.span()
        return {"from": span[0] if span else None, "to": span[1] if span else None}

    @router.post("/session/look", status_code=202, responses=REFUSED)
    async def look(wanted: Annotated[Look, Body()]) -> dict[str, Any]:
        """Show a past moment in the 3D scene; the session pauses while it is shown."""
        if wanted.time is None:
            app_state.view.show_past(None)
            return {"time": None}
        app_state.session.pause()
        moment = app_state.session.recorder.at(wanted.time)
        app_state.view.show_past(moment)
        return {"time": None if moment is None else moment.time}

    @router.post("/session/fork", response_model=ExperimentAnswer, responses=REFUSED)
    def fork(wanted: Annotated[Fork, Body()]) -> dict[str, Any]:
        """Go back to a moment of the last minute and continue from there with one more lane."""
        app_state.view.show_past(None)
        change = app_state.document.fork(
            wanted.time, wanted.origin, wanted.name, wanted.gains, author="http"
        )
        return answer(change.revision, app_state.document.preset, change.experiment)

    return router
