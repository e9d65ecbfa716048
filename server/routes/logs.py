"""Logs of a real arm over HTTP: brought, shown beside the lanes, followed, fitted, removed."""

from __future__ import annotations

import json
from typing import Annotated, Any

from fastapi import APIRouter, Body, Request, Response
from pydantic import ValidationError
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import UploadFile

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.server.compute.preview import encode_responses
from slidetune.server.contract.logs import (
    IdentifyRequest,
    LogChange,
    LogIdentification,
    LogList,
    LogReport,
    LogSummary,
    LogTrajectory,
    LogWanted,
    OverlayRequest,
    TrajectoryRequest,
)
from slidetune.server.contract.messages import ErrorAnswer
from slidetune.server.contract.openapi import multipart
from slidetune.server.contract.wrong_request import refused_fields
from slidetune.server.guard.disconnect import until_gone
from slidetune.server.logs.overlay import overlay_of
from slidetune.server.logs.work_apart import identify_apart, read_apart, trajectory_apart
from slidetune.server.routes.preview import BINARY
from slidetune.server.state.app_state import AppState

_REFUSED: dict[int | str, dict[str, Any]] = {
    404: {"model": ErrorAnswer},
    422: {"model": ErrorAnswer},
    503: {"model": ErrorAnswer},
}
_CURVES: dict[int | str, dict[str, Any]] = {
    **_REFUSED,
    200: {
        "content": {BINARY: {}},
        "description": "As ``POST /api/preview`` answers, with the log as its one lane; the "
        "surface is NaN. The JSON holds ``shift``, ``rms`` (null where the shift was given), "
        "``others``, ``against``, ``begin``, ``end`` and ``remarks`` as well.",
    },
    204: {"description": "None yet, or the client has disconnected."},
}
_FORM = multipart(
    {
        "file": {
            "type": "string",
            "format": "binary",
            "description": "CSV, or MCAP with sensor_msgs/JointState.",
        },
        "wanted": {
            "type": "string",
            "description": "JSON: `mapping` (column by `time`, joint, `joint.torque` …), "
            "`source`, `angles` (`rad` or `deg`), `time` (`s`, `ms`, `us` or `ns`); whatever "
            "headers say already may be left out.",
        },
    },
    ["file"],
)


def logs_router(app_state: AppState) -> APIRouter:
    """Return the routes of the logs."""
    router = APIRouter(prefix="/api/logs", tags=["logs"])
    store = app_state.logs

    @router.get("", response_model=LogList)
    async def all_logs() -> dict[str, Any]:
        """All logs; they are forgotten when the server ends."""
        return {"logs": store.documents()}

    @router.post("", response_model=LogReport, responses=_REFUSED, openapi_extra=_FORM)
    async def bring(request: Request) -> dict[str, Any]:
        """Read a log of the live experiment's arm from a file.

        Where the answer has no ``log`` it says why, and which columns there are: send the file
        again with a mapping.
        """
        store.refuse_if_full()
        if "multipart/form-data" not in request.headers.get("content-type", ""):
            raise _refused("file", "send the file as multipart/form-data")
        arm = app_state.arm
        async with request.form(max_files=1, max_fields=1) as form:
            file, text = form.get("file"), form.get("wanted", "{}")
            if not isinstance(file, UploadFile):
                raise _refused("file", "must be a CSV or MCAP file")
            wanted = _wanted(str(text))
            number = store.next_number()
            with store.working.one():
                report = await run_in_threadpool(
                    read_apart,
                    file.filename or "",
                    file.file,
                    arm,
                    wanted.model_dump(),
                    store.archive(number),
                )
        log = store.add(number, arm, report["log"]) if "log" in report else None
        return {"reason": None, **report, "log": log}

    @router.patch("/{number}", response_model=LogSummary, responses=_REFUSED)
    async def change(number: int, wanted: Annotated[LogChange, Body()]) -> Any:
        """Show a log beside the lanes, or hide it."""
        if wanted.shown is None:
            return store.get(number)
        return store.change(number, shown=wanted.shown)

    @router.delete("/{number}", status_code=204, responses=_REFUSED)
    async def remove(number: int) -> Response:
        """Forget a log."""
        store.remove(number)
        return Response(status_code=204)

    @router.post("/{number}/curves", response_class=Response, responses=_CURVES)
    async def compare(
        request: Request, number: int, wanted: Annotated[OverlayRequest, Body()]
    ) -> Response:
        """Compare a log with the live experiment: its curves and figures over the horizon."""
        log = store.of_arm(number, app_state.arm)
        shift = log.shift
        if wanted.shift is not None:
            shift = None if wanted.shift == "auto" else wanted.shift
            store.change(number, shift=shift)
        revision, packed = app_state.document.revision, app_state.document.packed
        turn = f"log {request.client.host if request.client else ''}"
        work = app_state.workers.run(overlay_of, store.archive(number), packed, shift, client=turn)
        found = await until_gone(request, work)
        if found is None:
            return Response(status_code=204)
        simulation = packed.experiment.simulation
        head = {
            "number": number,
            "revision": revision,
            "estimated": False,
            "horizon": simulation.horizon,
            "hold": 0.0,
            **found.head(),
        }
        message = encode_responses(head, {log.name: found.response})
        store.keep_curves(number, message)
        return Response(message, media_type=BINARY)

    @router.get("/{number}/curves", response_class=Response, responses=_CURVES)
    async def curves(number: int) -> Response:
        """The curves of a log that the owner last asked for."""
        kept = store.curves(number)
        if kept is None:
            return Response(status_code=204)
        return Response(kept, media_type=BINARY, headers={"cache-control": "no-store"})

    @router.post("/{number}/trajectory", response_model=LogTrajectory, responses=_REFUSED)
    async def trajectory(
        number: int, wanted: Annotated[TrajectoryRequest, Body()]
    ) -> dict[str, Any]:
        """Make a log a desired motion: a spline with its residual, as a patch."""
        log = store.of_arm(number, app_state.arm)
        with store.working.one():
            return await run_in_threadpool(
                trajectory_apart, store.archive(number), log.arm, wanted.spacing
            )

    @router.post("/{number}/identify", response_model=LogIdentification, responses=_REFUSED)
    async def identified(number: int, wanted: Annotated[IdentifyRequest, Body()]) -> dict[str, Any]:
        """Fit friction, payload, rotor inertia and constant torques, as a patch with intervals."""
        log = store.of_arm(number, app_state.arm)
        experiment = app_state.document.experiment
        with store.working.one():
            return await run_in_threadpool(
                identify_apart,
                store.archive(number),
                log.arm,
                experiment.robot.model_dump(mode="json"),
                wanted.parts,
                wanted.constants,
                experiment.disturbance.constant,
            )

    return router


def _refused(path: str, text: str) -> InvalidExperimentError:
    return InvalidExperimentError([FieldError(path, text)])


def _wanted(text: str) -> LogWanted:
    """Return what a form's field says.

    Raises:
        InvalidExperimentError: naming every refused value.
    """
    try:
        said = json.loads(text)
    except ValueError as error:
        raise _refused("wanted", f"isn't valid JSON: {error}") from error
    try:
        return LogWanted.model_validate(said)
    except ValidationError as error:
        raise InvalidExperimentError(
            [
                FieldError(f"wanted.{one['path']}", str(one["message"]), one["value"])
                for one in refused_fields(error.errors())
            ]
        ) from error
