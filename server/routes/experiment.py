"""The live document over HTTP: read, patch, replace, export."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Body, Query, Request, Response
from starlette.exceptions import HTTPException

from robot.errors import FieldError, InvalidExperimentError
from robot.experiment import Experiment
from robot.preset_yaml import experiment_from_yaml, experiment_to_yaml
from server.contract import ErrorAnswer, ExperimentAnswer
from server.studio import Studio, law_infos

YAML = "application/yaml"
MAX_BODY = 256 * 1024
"""Largest body of a request in bytes (*ours*)."""
REFUSED: dict[int | str, dict[str, Any]] = {
    413: {"model": ErrorAnswer},
    422: {"model": ErrorAnswer},
}
_PATCH = {"lanes": {"NFTSM": {"nu": 30}}}


async def read_body(request: Request) -> bytes:
    """Return the body of a request.

    Raises:
        HTTPException: 413 if it is larger than ``MAX_BODY``.
    """
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > MAX_BODY:
            raise HTTPException(413, f"The body may hold {MAX_BODY // 1024} KiB at most.")
    return bytes(body)


def _refuse_constant(name: str) -> float:
    raise ValueError(f"{name} is not a number that JSON knows")


def parse_experiment(body: bytes, content_type: str) -> Experiment:
    """Read an experiment from YAML, or from JSON where the content type says so.

    Raises:
        InvalidExperimentError: naming every refused field.
    """
    if "json" not in content_type:
        return experiment_from_yaml(body)
    try:
        document = json.loads(body, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        raise InvalidExperimentError([FieldError("", f"the body isn't JSON: {error}")]) from error
    if not isinstance(document, dict):
        raise InvalidExperimentError([FieldError("", "the body must be a JSON object")])
    return Experiment.from_document(document)


def yaml_response(experiment: Experiment, name: str) -> Response:
    """Return an experiment as a YAML download."""
    disposition = f'attachment; filename="{name}.yaml"'
    headers = {"content-disposition": disposition}
    return Response(experiment_to_yaml(experiment), media_type=YAML, headers=headers)


def experiment_router(studio: Studio) -> APIRouter:
    """Return the routes of the live document."""
    router = APIRouter(prefix="/api", tags=["experiment"])
    document = studio.document

    def answer() -> dict[str, Any]:
        return {
            "revision": document.revision,
            "preset": document.preset,
            "experiment": document.experiment.document(),
        }

    @router.get("/schema")
    async def schema() -> dict[str, Any]:
        """JSON Schema of an experiment with symbols, units and bounds; the laws in ``x-laws``."""
        return {**Experiment.model_json_schema(), "x-laws": law_infos()}

    @router.get("/experiment", response_model=ExperimentAnswer)
    async def read(format: Annotated[Literal["json", "yaml"], Query()] = "json") -> Any:
        """The live document, as JSON or as a YAML download."""
        if format == "yaml":
            return yaml_response(document.experiment, document.preset or "experiment")
        return answer()

    @router.patch("/experiment", response_model=ExperimentAnswer, responses=REFUSED)
    def patch(patch: Annotated[dict[str, Any], Body(examples=[_PATCH])]) -> dict[str, Any]:
        """Change the live document by a JSON Merge Patch (RFC 7396)."""
        document.patch(patch, author="http")
        return answer()

    @router.put(
        "/experiment",
        response_model=ExperimentAnswer,
        responses=REFUSED,
        openapi_extra={
            "requestBody": {
                "required": True,
                "content": {
                    YAML: {"schema": {"type": "string"}},
                    "application/json": {"schema": {"type": "object"}},
                },
            }
        },
    )
    async def replace(request: Request) -> dict[str, Any]:
        """Replace the live document by JSON or YAML; time begins at 0."""
        body = await read_body(request)
        experiment = parse_experiment(body, request.headers.get("content-type", ""))
        document.replace(experiment, author="http")
        return answer()

    return router
