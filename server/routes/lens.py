"""Lenses over HTTP: one lane's whole run, looked at so that it explains itself."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Body, Request, Response
from fastapi.responses import JSONResponse
from pydantic import Field

from slidetune.robot.lenses import look_through, only_known_lane
from slidetune.robot.lenses.threshold import threshold_of
from slidetune.server.compute.run_cost import refuse_if_costly
from slidetune.server.contract.messages import ErrorAnswer, Strict
from slidetune.server.guard.disconnect import until_gone
from slidetune.server.state.app_state import AppState

LensName = Literal["sliding", "network", "chattering", "prediction"]
ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "``revision``, ``lane``, ``horizon``, ``frozen`` and the result of each "
        "lens."
    },
    204: {"description": "The client has disconnected."},
    422: {"model": ErrorAnswer},
    503: {"model": ErrorAnswer},
}
THRESHOLD_ANSWERS: dict[int | str, dict[str, Any]] = {
    **ANSWERS,
    200: {"description": "``revision``, ``lane`` and ``threshold``."},
}


class LaneRequest(Strict):
    """Which lane of which experiment."""

    lane: str = Field(examples=["RBFNN-NFTSM"])
    patch: dict[str, Any] = Field(
        {}, description="Merge patch to the live experiment, such as another switching function."
    )
    experiment: dict[str, Any] | None = Field(
        None,
        description="A complete experiment to use instead of the live one; the patch applies "
        "to it.",
    )


class LensRequest(LaneRequest):
    """Which lane to analyse, and with which lenses."""

    lenses: list[LensName] = Field(
        ["sliding", "network", "chattering", "prediction"],
        min_length=1,
        max_length=4,
        description="Each takes a little extra time.",
    )


def lens_router(app_state: AppState) -> APIRouter:
    """Return the route of the lenses."""
    router = APIRouter(prefix="/api", tags=["lenses"])

    @router.post("/lens", response_class=JSONResponse, responses=ANSWERS)
    async def lens(request: Request, wanted: Annotated[LensRequest, Body()]) -> Response:
        """Run one lane over its horizon beside the live session and look at it.

        ``sliding``: each joint's (e, de) plane with its sliding curve, and V over time.
        ``network``: the Gaussians over the inputs visited, the weights, and f beside the torque
        that an exact model would have needed; of a law with a disturbance observer
        (``observer``) its estimate f beside the true F, to which super-twisting adds M z
        (``adds``); of super-twisting without one M z alone (``observer`` is ``twisting``);
        ``null`` with none of these.
        ``chattering``: the torque's spectrum, total variation, switches and share above 50 Hz.
        ``prediction``: each joint's limit cycle by harmonic balance beside the measured one, its
        Nyquist curve, and the boundary layer that silences it; ``null`` where nothing switches.

        Where sensors are noisy, ``chattering.quiet`` and ``sliding.quiet_turns`` tell the same of a
        run with exact ones.
        """
        revision = app_state.document.revision
        whole = app_state.experiment_of(wanted.experiment, wanted.patch)
        live = whole == app_state.document.experiment
        experiment = only_known_lane(whole, wanted.lane)
        refuse_if_costly(experiment)
        turn = f"lens {request.client.host if request.client else ''}"
        arguments = experiment, wanted.lane, wanted.lenses
        work = app_state.workers.run(look_through, *arguments, client=turn)
        seen = await until_gone(request, work)
        if seen is None:
            return Response(status_code=204)
        if live:
            app_state.results.keep_looks(revision, whole, wanted.lane, seen)
        # Strict: what is no number has become null on the way, and anything else would raise.
        return JSONResponse({"revision": revision, "lane": wanted.lane, **seen})

    @router.post("/threshold", response_class=JSONResponse, responses=THRESHOLD_ANSWERS)
    async def threshold(request: Request, wanted: Annotated[LaneRequest, Body()]) -> Response:
        """Return the boundary layer from which on a lane is silent, without a run.

        ``threshold``: ``common`` for all joints and, where the lane has a layer for each,
        ``joints``, in [rad/s], as the lens ``prediction`` has them; ``null`` where nothing
        switches, where the law has no layer, and where only a run tells its gain.
        """
        revision = app_state.document.revision
        experiment = app_state.experiment_of(wanted.experiment, wanted.patch)
        turn = f"threshold {request.client.host if request.client else ''}"
        work = app_state.workers.run(threshold_of, experiment, wanted.lane, client=turn)
        found = await until_gone(request, work)
        if found is None:
            return Response(status_code=204)
        return JSONResponse({"revision": revision, "lane": wanted.lane, **found})

    return router
