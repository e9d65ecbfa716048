"""What the OpenAPI document says of every route: how it may refuse."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from fastapi import FastAPI

from slidetune.server.contract.messages import ErrorAnswer

YAML = "application/yaml"

REFUSALS: dict[int | str, dict[str, Any]] = {
    400: {"model": ErrorAnswer, "description": "The body is not readable."},
    401: {"model": ErrorAnswer, "description": "This server requires a token."},
    403: {
        "model": ErrorAnswer,
        "description": "The request comes from another site, or from a viewer, who may only watch.",
    },
    413: {"model": ErrorAnswer, "description": "The body is too large."},
    422: {"model": ErrorAnswer, "description": "Invalid values; nothing was changed."},
}
"""How every route may refuse; what else one may answer stands with it."""
OR_YAML: dict[int | str, dict[str, Any]] = {
    200: {"content": {YAML: {"schema": {"type": "object"}}}}
}
"""Answers in JSON, or in YAML where that is asked for."""


def multipart(fields: Mapping[str, Mapping[str, Any]], required: Sequence[str]) -> dict[str, Any]:
    """Return how OpenAPI says that a route takes a form with files.

    Args:
        fields: JSON Schema of each field.
        required: those that have to be there.
    """
    schema = {"type": "object", "properties": dict(fields), "required": list(required)}
    content = {"multipart/form-data": {"schema": schema}}
    return {"requestBody": {"required": True, "content": content}}


def methods_at(app: FastAPI, path: str) -> list[str]:
    """Return every method that the OpenAPI document offers at a path."""
    for template, operations in app.openapi()["paths"].items():
        if re.fullmatch(re.sub(r"\{\w+\}", "[^/]+", template), path):
            return [method.upper() for method in operations]
    return []
