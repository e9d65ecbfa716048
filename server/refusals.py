"""Turns every error into the one shape that the contract has."""

from __future__ import annotations

import logging
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import ValidationError
from pydantic_core import ErrorDetails
from starlette.exceptions import HTTPException

from robot.errors import (
    InvalidExperimentError,
    PresetConflictError,
    PresetStorageError,
    SlidetuneError,
    UnknownLessonError,
    UnknownPresetError,
)
from server.errors import error_body
from server.workers import BusyError, WorkerLostError

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
    (PresetConflictError, 409, "conflict"),
    (PresetStorageError, 507, "storage"),
    (WorkerLostError, 503, "worker_lost"),
    (BusyError, 503, "busy"),
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
    details: list[ErrorDetails] = list(error.errors())[:20]
    fields = []
    for detail in details:
        path = ".".join(str(part) for part in detail["loc"] if part not in ("body", "query"))
        text = detail["msg"]
        fields.append(
            {
                "path": path,
                "message": f"{path}: {text}" if path else text,
                "value": _plain(detail.get("input")),
                "allowed": "",
                "line": None,
            }
        )
    return error_body("invalid", "; ".join(str(field["message"]) for field in fields), fields)


async def _ours(_: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, SlidetuneError)
    status = next((status for kind, status, _ in _STATUS if isinstance(error, kind)), 400)
    return JSONResponse(refusal_body(error), status)


async def _request(_: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)
    return JSONResponse(message_body(error), 422)


async def _http(_: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)
    code = _CODES.get(error.status_code, "error")
    return JSONResponse(error_body(code, str(error.detail)), error.status_code, error.headers)


async def _unexpected(request: Request, error: Exception) -> JSONResponse:
    log.error("%s %s failed", request.method, request.url.path, exc_info=error)
    message = "The server made a mistake; its log says more. Nothing was changed."
    return JSONResponse(error_body("internal", message), 500)


def install_refusals(app: FastAPI) -> None:
    """Let ``app`` answer every error in the one shape."""
    app.add_exception_handler(SlidetuneError, _ours)
    app.add_exception_handler(RequestValidationError, _request)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(Exception, _unexpected)
