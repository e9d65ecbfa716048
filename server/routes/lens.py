"""Lenses over HTTP: one lane's whole run, looked at so that it explains itself."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Body, Request, Response
from fastapi.responses import JSONResponse
from pydantic import Field

from slidetune.robot.lenses import look_through, only_known_lane
from slidetune.server.compute.run_cost import refuse_if_costly
from slidetune.server.contract.messages import ErrorAnswer, Strict
from slidetune.server.routes.disconnect import until_gone
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


class LensRequest(Strict):
    """Which lane to analyse, and with which lenses."""

    lane: str = Field(examples=["RBFNN-NFTSM"])
    patch: dict[str, Any] = Field(
        {}, description="Merge patch to the live experiment, such as another switching function."
    )
    experiment: dict[str, Any] | None = Field(
        None,
        description="A complete experiment to use instead of the live one; the patch applies "
        "to it.",
    )
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

    return router
