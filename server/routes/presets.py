"""Presets over HTTP: list, read, save, delete, load."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import info_of, preset_store
from slidetune.server.contract.messages import (
    ErrorAnswer,
    ExperimentAnswer,
    PresetAnswer,
    PresetList,
)
from slidetune.server.contract.openapi import OR_YAML, YAML
from slidetune.server.routes.experiment import answer, parse_experiment, yaml_response
from slidetune.server.state.app_state import AppState
from slidetune.server.state.preset_quota import save_within_quota

_UNKNOWN: dict[int | str, dict[str, Any]] = {404: {"model": ErrorAnswer}}
_CONFLICT: dict[int | str, dict[str, Any]] = {
    **_UNKNOWN,
    409: {"model": ErrorAnswer},
    422: {"model": ErrorAnswer},
}


def _answer(name: str, experiment: Experiment, shipped: bool) -> dict[str, Any]:
    info = info_of(name, experiment, shipped)
    return {**asdict(info), "experiment": experiment.document()}


def presets_router(app_state: AppState) -> APIRouter:
    """Return the routes of the presets."""
    router = APIRouter(prefix="/api/presets", tags=["presets"])

    @router.get("", response_model=PresetList)
    def all_presets() -> dict[str, Any]:
        """All presets: those that ship first."""
        return {"presets": [asdict(info) for info in preset_store().infos()]}

    @router.get("/{name}", response_model=PresetAnswer, responses={**_UNKNOWN, **OR_YAML})
    def one_preset(
        name: str, request: Request, format: Annotated[Literal["json", "yaml"], Query()] = "json"
    ) -> Any:
        """One preset, as JSON or as a YAML download."""
        store = preset_store()
        experiment = store.load(name)
        if format == "yaml" or YAML in request.headers.get("accept", ""):
            return yaml_response(experiment, name)
        return _answer(name, experiment, store.is_shipped(name))

    @router.put(
        "/{name}",
        response_model=PresetAnswer,
        responses=_CONFLICT,
        openapi_extra={
            "requestBody": {
                "content": {
                    YAML: {"schema": {"type": "object"}},
                    "application/json": {"schema": {"type": "object"}},
                }
            }
        },
    )
    async def save(
        name: str, request: Request, overwrite: Annotated[bool, Query()] = False
    ) -> dict[str, Any]:
        """Save an experiment as a preset of the user's; an empty body saves the live one."""
        body = await request.body()
        content_type = request.headers.get("content-type", "")
        if body.strip():
            saved = await run_in_threadpool(parse_experiment, body, content_type)
            await run_in_threadpool(save_within_quota, preset_store(), name, saved, overwrite)
        else:
            beginning, saved = app_state.document.present()
            await run_in_threadpool(save_within_quota, preset_store(), name, saved, overwrite)
            app_state.document.saved_as(name, saved, beginning)
        return _answer(name, saved, shipped=False)

    @router.delete("/{name}", status_code=204, responses=_CONFLICT)
    def delete(name: str) -> Response:
        """Delete one of the user's presets."""
        preset_store().delete(name)
        return Response(status_code=204)

    @router.post("/{name}/load", response_model=ExperimentAnswer, responses=_UNKNOWN)
    def load(name: str) -> dict[str, Any]:
        """Start a preset in the live session, at time 0."""
        change = app_state.document.replace(preset_store().load(name), preset=name, author="http")
        return answer(change.revision, name, change.experiment)

    return router
