"""Turns pydantic's refusals into ours: the field, the value, what is allowed, the way out."""

from __future__ import annotations

from difflib import get_close_matches
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from robot.errors import FieldError
from robot.quantity import allowed_text

_LONGEST = 120


def _variants(annotation: Any) -> list[type[BaseModel]]:
    """Return the models that an annotation may hold."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    found = []
    for argument in getattr(annotation, "__args__", ()):
        found += _variants(argument)
    return found


def _tagged(models: list[type[BaseModel]], tag: object) -> list[type[BaseModel]]:
    def tags(model: type[BaseModel]) -> set[object]:
        fields = model.model_fields
        return {fields[key].default for key in ("law", "kind") if key in fields}

    return [model for model in models if tag in tags(model)]


def _walk(model: type[BaseModel], location: tuple[int | str, ...]) -> tuple[list[str], Any, Any]:
    """Return the path without union tags, the model that holds its end, and its field."""
    path: list[str] = []
    holder: type[BaseModel] | None = model
    models: list[type[BaseModel]] = []
    info = None
    for part in location:
        tagged = _tagged(models, part) if len(models) > 1 else []
        if tagged:
            holder, models = tagged[0], []
            continue
        path.append(str(part))
        if holder is not None and part in holder.model_fields:
            info = holder.model_fields[str(part)]
            models = _variants(info.annotation)
            holder = models[0] if len(models) == 1 else None
        elif len(models) <= 1:
            info = None
    return path, holder, info


def _short(value: object) -> object:
    if value is None or isinstance(value, bool | int | float):
        text = repr(value)
        return value if len(text) <= _LONGEST and value == value else text[:_LONGEST]
    text = value if isinstance(value, str) else repr(value)
    return text if len(text) <= _LONGEST else text[:_LONGEST] + "…"


def _unknown(key: str, holder: type[BaseModel] | None) -> str:
    known = sorted(holder.model_fields) if holder is not None else []
    close = get_close_matches(key, known, n=1)
    hint = f"; did you mean {close[0]}?" if close else ""
    return f"unknown field{hint} Known: {', '.join(known)}" if known else "unknown field"


def _refusal(error: ErrorDetails, model: type[BaseModel]) -> FieldError:
    path, _, info = _walk(model, tuple(part for part in error["loc"] if part != "[key]"))
    text = error["msg"].removeprefix("Value error, ")
    context = error.get("ctx", {})
    if error["type"] == "combination":
        return FieldError(".".join([*path, context["path"]]), text, _short(context["value"]))
    if error["type"] == "extra_forbidden":
        text = _unknown(path[-1], _walk(model, error["loc"][:-1])[1])
    elif error["type"] in ("union_tag_invalid", "union_tag_not_found"):
        text = f"needs one of {context.get('expected_tags', 'the known kinds')}"
        path.append(str(context.get("discriminator", "")).strip("'"))
    elif path and not path[-1].isdigit():
        text = f"{path[-1]} {text[0].lower()}{text[1:]}"
    extra = info.json_schema_extra if info is not None else None
    allowed = allowed_text(extra) if isinstance(extra, dict) else ""
    return FieldError(".".join(path), text, _short(error.get("input")), allowed)


def field_errors(error: ValidationError, model: type[BaseModel]) -> list[FieldError]:
    """Return one ``FieldError`` for each value that ``model`` refused."""
    details = error.errors(include_url=False)[:20]
    return [_refusal(detail, model) for detail in details]
