"""Turns every error into the one shape that the contract has."""

from __future__ import annotations

import logging
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import ValidationError
from starlette.exceptions import HTTPException

from slidetune.robot.errors import (
    ArmStorageError,
    InvalidExperimentError,
    PresetConflictError,
    PresetStorageError,
    SlidetuneError,
    UnknownArmError,
    UnknownLessonError,
    UnknownPresetError,
)
from slidetune.robot.handover.self_check import HandOverError
from slidetune.server.compute.workers import BusyError
from slidetune.server.contract.openapi import methods_at
from slidetune.server.contract.wrong_request import refused_fields
from slidetune.server.exports.refused import ExportError, NoRowsError
from slidetune.server.guard.errors import error_body
from slidetune.server.guard.limits import (
    MessageTooLargeError,
    SessionBusyError,
    TooManyKeptStudiesError,
    TooManyLogsError,
    TooManyPatchesError,
    TooManyPresetsError,
    TooManyStudiesError,
)
from slidetune.server.logs.store import UnknownLogError
from slidetune.server.logs.work_apart import LogStorageError, RefusedLogError
from slidetune.server.studies.store import StudyStorageError, UnknownStudyError

log = logging.getLogger("slidetune.http")

_CODES = {
    400: "bad_request",
    404: "not_found",
    405: "method_not_allowed",
    409: "conflict",
    413: "too_large",
    415: "unsupported_media_type",
    422: "invalid",
}
_STATUS: tuple[tuple[type[SlidetuneError], int, str], ...] = (
    (InvalidExperimentError, 422, "invalid"),
    (UnknownPresetError, 404, "unknown_preset"),
    (UnknownLessonError, 404, "unknown_lesson"),
    (UnknownArmError, 404, "unknown_arm"),
    (PresetConflictError, 409, "conflict"),
    (PresetStorageError, 507, "storage"),
    (ArmStorageError, 507, "storage"),
    (BusyError, 503, "busy"),
    (SessionBusyError, 503, "busy"),
    (MessageTooLargeError, 413, "too_large"),
    (TooManyPatchesError, 429, "too_many_patches"),
    (TooManyStudiesError, 429, "too_many_studies"),
    (TooManyPresetsError, 507, "too_many_presets"),
    (TooManyKeptStudiesError, 507, "too_many_kept_studies"),
    (TooManyLogsError, 507, "too_many_logs"),
    (UnknownLogError, 404, "unknown_log"),
    (RefusedLogError, 422, "refused_log"),
    (LogStorageError, 507, "storage"),
    (HandOverError, 422, "hand_over"),
    (NoRowsError, 422, "no_rows"),
    (ExportError, 507, "storage"),
    (UnknownStudyError, 404, "unknown_study"),
    (StudyStorageError, 507, "storage"),
)
_LONGEST = 200


def _plain(value: object) -> object:
    """Return a value that JSON can hold; what it can't becomes its shortened text."""
    if value is None or isinstance(value, bool | str):
        return value[:_LONGEST] if isinstance(value, str) else value
    if isinstance(value, int | float) and abs(value) < 1e300:
        return value
    return repr(value)[:_LONGEST]


def refusal_body(error: SlidetuneError) -> dict[str, Any]:
    """Return the body that tells one of our own errors."""
    code = next((code for kind, _, code in _STATUS if isinstance(error, kind)), "refused")
    refused = getattr(error, "fields", ())
    fields = [
        {
            "path": field.path,
            "message": field.message,
            "value": _plain(field.value),
            "allowed": field.allowed,
            "line": field.line,
        }
        for field in refused
    ]
    return error_body(code, str(error), fields)


def message_body(error: ValidationError | RequestValidationError) -> dict[str, Any]:
    """Return the body that tells what is wrong with a message or a request."""
    fields = refused_fields(error.errors())
    return error_body("invalid", "; ".join(str(field["message"]) for field in fields), fields)


async def _ours(_: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, SlidetuneError)
    status = next((status for kind, status, _ in _STATUS if isinstance(error, kind)), 400)
    return JSONResponse(refusal_body(error), status)


async def _request(_: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)
    return JSONResponse(message_body(error), 422)


async def _http(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)
    code = _CODES.get(error.status_code, "error")
    path = request.url.path
    said = {
        "Not Found": f"there is nothing at {path}",
        "There was an error parsing the body": "the body isn't readable JSON in UTF-8",
        "Method Not Allowed": f"{request.method} is not allowed at {path}",
    }
    message = said.get(str(error.detail), str(error.detail))
    answer = JSONResponse(error_body(code, message), error.status_code, error.headers)
    # Starlette names the methods of the first route at this path alone.
    if error.status_code == 405 and (methods := methods_at(request.app, request.url.path)):
        answer.headers["allow"] = ", ".join(methods)
    return answer


async def _unexpected(request: Request, error: Exception) -> JSONResponse:
    log.error("%s %s failed", request.method, request.url.path, exc_info=error)
    message = (
        "Internal server error; the server's log has the details. The request may have been "
        "carried out in part: check before you repeat it."
    )
    return JSONResponse(error_body("internal", message), 500)


def install_refusals(app: FastAPI) -> None:
    """Let ``app`` answer every error in the one shape."""
    app.add_exception_handler(SlidetuneError, _ours)
    app.add_exception_handler(RequestValidationError, _request)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(Exception, _unexpected)
