"""Whole responses over HTTP: every lane, from t = 0 over the horizon."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Body, Request, Response
from pydantic import Field

from slidetune.server.compute.preview import encode_responses
from slidetune.server.contract.messages import ErrorAnswer, Strict
from slidetune.server.guard.disconnect import until_gone
from slidetune.server.state.app_state import AppState

BINARY = "application/octet-stream"
SUPERSEDED: dict[int | str, dict[str, Any]] = {
    200: {
        "content": {BINARY: {}},
        "description": "See ``encode_responses``. Each lane's ``accuracy`` holds "
        "``error_estimate`` [rad], null where none was asked for; ``unconverged``, steps whose "
        "equation was not solved to its tolerance; ``capped``, rows whose step was not subdivided "
        "as far as its error requires; ``at_least``, whether the true error may be many times the "
        "estimate, as the remark says; ``remark``, what is wrong and what would help; "
        "``patch``, which sets it, or null.",
    },
    204: {"description": "Superseded by a newer request of the same client."},
    422: {"model": ErrorAnswer},
    503: {"model": ErrorAnswer},
}


class PreviewRequest(Strict):
    """Which response to compute."""

    patch: dict[str, Any] = Field(
        {},
        description="Merge patch to the live experiment.",
        examples=[{"lanes": {"NFTSM": {"nu": 30}}}],
    )
    experiment: dict[str, Any] | None = Field(
        None, description="A complete experiment to use instead of the live one."
    )
    estimate: bool = Field(
        True,
        description="Whether the error of each run is estimated, which takes half as long again; "
        "a drag does without.",
    )
    client: str = Field(
        "", max_length=80, description="A newer request of the same client cancels the older one."
    )
    show: bool | None = Field(
        None,
        description="Draw the flanges' paths in the 3D scene, or remove them; null leaves them as "
        "they are.",
    )


def preview_router(app_state: AppState) -> APIRouter:
    """Return the route of whole responses."""
    router = APIRouter(prefix="/api", tags=["preview"])

    @router.post("/preview", response_class=Response, responses=SUPERSEDED)
    async def preview(request: Request, wanted: Annotated[PreviewRequest, Body()]) -> Response:
        """Run every lane over its horizon beside the live session; metrics and thinned columns.

        The answer is binary: ``uint32`` length of a JSON text, the text, then columns of
        ``float32`` as the text describes them.
        """
        revision = app_state.document.revision
        experiment = app_state.experiment_of(wanted.experiment, wanted.patch)
        keep = wanted.estimate and experiment == app_state.document.experiment
        turn = request.client.host if request.client else ""
        work = app_state.previews.respond(experiment, wanted.estimate, wanted.client, turn)
        responses = await until_gone(request, work)
        if responses is None:
            return Response(status_code=204)
        if wanted.show is not None:
            shown = responses if wanted.show else {}
            app_state.view.show_responses({name: r.path for name, r in shown.items()})
        horizon = experiment.simulation.horizon
        hold = experiment.simulation.hold
        head = {
            "revision": revision,
            "estimated": wanted.estimate,
            "horizon": horizon,
            "hold": hold,
        }
        message = encode_responses(head, responses)
        if keep:
            app_state.results.keep_response(revision, message)
        return Response(message, media_type=BINARY)

    return router
