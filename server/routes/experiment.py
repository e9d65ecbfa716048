"""The live document over HTTP: read, patch, replace, export."""

from __future__ import annotations

import asyncio
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Body, Query, Request, Response

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from slidetune.robot.experiment.presets import link_to, read_link
from slidetune.server.contract.messages import (
    ErrorAnswer,
    ExperimentAnswer,
    LinkAnswer,
    LinkRequest,
)
from slidetune.server.contract.openapi import OR_YAML, YAML
from slidetune.server.contract.schema import SchemaAnswer
from slidetune.server.guard.plain_json import NotJsonError, read_json
from slidetune.server.state.app_state import AppState
from slidetune.server.state.published import published_schema

REFUSED: dict[int | str, dict[str, Any]] = {
    413: {"model": ErrorAnswer},
    422: {"model": ErrorAnswer},
}
PUBLISHED: dict[int | str, dict[str, Any]] = {200: {"model": SchemaAnswer}}
_PATCH = {"lanes": {"NFTSM": {"nu": 30}}}


def parse_experiment(body: bytes, content_type: str) -> Experiment:
    """Read an experiment from YAML, or from JSON where the content type says so.

    Raises:
        InvalidExperimentError: naming every refused field.
    """
    if "json" not in content_type:
        return experiment_from_yaml(body)
    try:
        document = read_json(body)
    except NotJsonError as error:
        raise InvalidExperimentError([FieldError("", f"the body {error}")]) from error
    if not isinstance(document, dict):
        raise InvalidExperimentError([FieldError("", "the body must be a JSON object")])
    return Experiment.from_document(document)


def yaml_response(experiment: Experiment, name: str) -> Response:
    """Return an experiment as a YAML download."""
    disposition = f'attachment; filename="{name}.yaml"'
    headers = {"content-disposition": disposition}
    return Response(experiment_to_yaml(experiment), media_type=YAML, headers=headers)


def answer(
    revision: int, preset: str, experiment: Experiment, waiting_steps: int = 0
) -> dict[str, Any]:
    """Return an ``ExperimentAnswer``."""
    return {
        "revision": revision,
        "preset": preset,
        "experiment": experiment.document(),
        "waiting_steps": waiting_steps,
    }


def experiment_router(app_state: AppState) -> APIRouter:
    """Return the routes of the live document."""
    router = APIRouter(prefix="/api", tags=["experiment"])
    document = app_state.document

    def present(waiting_steps: int = 0) -> dict[str, Any]:
        return answer(document.revision, document.preset, document.experiment, waiting_steps)

    @router.get("/schema", response_model=None, responses=PUBLISHED)
    async def schema() -> dict[str, Any]:
        """JSON Schema of an experiment with symbols, units and bounds.

        It is for the arm of the live document, which stands in ``x-arm``: lists by joint are as
        long as that has joints. The laws stand in ``x-laws``, the figures of a lane in
        ``x-figures``, and what else is bounded in ``x-bounds``.
        """
        return published_schema(app_state.arm)

    @router.get("/experiment", response_model=ExperimentAnswer, responses=OR_YAML)
    def read(format: Annotated[Literal["json", "yaml"], Query()] = "json") -> Any:
        """The live document, as JSON or as a YAML download."""
        if format == "yaml":
            return yaml_response(document.experiment, document.preset or "experiment")
        return present()

    @router.patch("/experiment", response_model=ExperimentAnswer, responses=REFUSED)
    def patch(patch: Annotated[dict[str, Any], Body(examples=[_PATCH])]) -> dict[str, Any]:
        """Change the live document by a JSON Merge Patch (RFC 7396)."""
        document.patch(patch, author="http")
        return present(app_state.session.waiting_steps)

    @router.put(
        "/experiment",
        response_model=ExperimentAnswer,
        responses=REFUSED,
        openapi_extra={
            "requestBody": {
                "required": True,
                "content": {
                    YAML: {"schema": {"type": "object"}},
                    "application/json": {"schema": {"type": "object"}},
                },
            }
        },
    )
    async def replace(request: Request) -> dict[str, Any]:
        """Replace the live document by JSON or YAML; time starts at 0."""
        body = await request.body()
        content_type = request.headers.get("content-type", "")

        def begin() -> None:
            document.replace(parse_experiment(body, content_type), author="http")

        await asyncio.to_thread(begin)
        return present()

    @router.get("/link", response_model=LinkAnswer, responses={422: {"model": ErrorAnswer}})
    def link() -> dict[str, Any]:
        """A link to the live document: a shipped preset and what differs from it."""
        return {"link": link_to(document.experiment)}

    @router.post(
        "/link", response_model=ExperimentAnswer, responses={404: {"model": ErrorAnswer}, **REFUSED}
    )
    def open_link(wanted: LinkRequest) -> dict[str, Any]:
        """Start the experiment of a link in the live session, at time 0."""
        linked = read_link(wanted.link, wanted.despite)
        document.replace(linked.experiment, linked.preset, "http", linked.baseline)
        return present()

    return router
