"""Says in our words what is wrong with a request or a message, where pydantic says it in its own.

What is wrong with an experiment is told by ``robot.fields.refusal``; this is about all else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic_core import ErrorDetails

from slidetune.robot.fields.field_path import field_path
from slidetune.robot.fields.pydantic_words import TEXTS, words
from slidetune.robot.fields.written_value import plain_value, written

MOST_FIELDS = 20
"""Most refused values that are told at once (*ours*)."""
_PLACES = ("body", "query", "path", "header", "cookie")
_KINDS = ("int", "str", "float", "bool", "constrained-int", "constrained-str")
_TEXTS = {
    "missing": "is missing",
    "extra_forbidden": "is unknown here",
    "greater_than": "must be greater than {gt}",
    "greater_than_equal": "must be at least {ge}",
    "less_than": "must be less than {lt}",
    "less_than_equal": "must be at most {le}",
    "union_tag_invalid": "must be one of {expected_tags}",
}
_WANTED = {
    "int": "a whole number",
    "float": "a number",
    "bool": "true or false",
    "string": "a text",
    "dict": "an object",
    "model": "an object",
    "list": "a list",
    "tuple": "a list",
}


def refused_fields(details: Sequence[ErrorDetails]) -> list[dict[str, object]]:
    """Return one field of an error for each refused value, twenty at most.

    Args:
        details: what pydantic says, of a message by its ``type`` or of a request by its part.
    """
    # A value that could be of several kinds is refused once for each of them.
    told: dict[str, list[ErrorDetails]] = {}
    for detail in details:
        told.setdefault(_path(detail), []).append(detail)
    return [_field(found, path) for path, found in list(told.items())[:MOST_FIELDS]]


def _path(detail: ErrorDetails) -> str:
    parts = [str(part) for part in detail["loc"]]
    if detail["type"] == "json_invalid":
        return ""
    if parts and (parts[0] in _PLACES or _is_tag(detail)):
        parts = parts[1:]
    if detail["type"].startswith("union_tag"):
        parts.append(_tag_name(detail))
    return field_path(written(part) for part in parts if part not in _KINDS)


def _is_tag(detail: ErrorDetails) -> bool:
    """Whether a location begins with the type of the message, which is no part of its path."""
    return len(detail["loc"]) > 1 or detail["type"] in ("model_type", "model_attributes_type")


def _tag_name(detail: ErrorDetails) -> str:
    return str(detail.get("ctx", {}).get("discriminator", "type")).strip("'")


def _field(details: list[ErrorDetails], path: str) -> dict[str, object]:
    # What says most is that it is of the right kind and still wrong.
    better = [one for one in details if not one["type"].endswith("_type")]
    detail = (better or details)[0]
    given: Any = detail.get("input")
    if detail["type"].startswith("union_tag"):
        given = given.get(_tag_name(detail)) if isinstance(given, Mapping) else None
    whole = detail["type"] in ("missing", "json_invalid")
    got = "" if whole else f", got {written(given)}"
    joint = ": " if detail["type"] == "value_error" else " "  # a rule of ours has its own subject
    text = f"{path or 'the request'}{joint}{_text(detail) if better else _needed(details)}{got}"
    value = None if whole else plain_value(given)
    return {"path": path, "message": text, "value": value, "allowed": "", "line": None}


def _text(detail: ErrorDetails) -> str:
    kind = detail["type"]
    if kind == "json_invalid":
        return f"isn't valid JSON: something is wrong or missing at character {detail['loc'][-1]}"
    if kind == "union_tag_not_found":
        return "is required: it says which message this is"
    if kind in TEXTS or kind in _TEXTS or kind == "value_error":
        return words(detail, _TEXTS)
    return _needed([detail])


def _needed(details: list[ErrorDetails]) -> str:
    wanted = [_WANTED.get(detail["type"].partition("_")[0], "") for detail in details]
    return f"must be {' or '.join(wanted)}" if all(wanted) else details[0]["msg"]
