"""Turns pydantic's refusals into ours: the field, the value, what is allowed, the way out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from slidetune.robot.errors import FieldError
from slidetune.robot.fields.field_path import field_path
from slidetune.robot.fields.pydantic_words import words
from slidetune.robot.fields.quantity import allowed_text
from slidetune.robot.fields.written_value import plain_value, written

_KEY = "[key]"
OWN_LAW = "A law of your own is known where its file is named at the start: --law FILE.py"
"""What may be missing where a law isn't known."""

_TEXTS = {
    "model_type": "must be a mapping",
    "model_attributes_type": "must be a mapping",
    "dict_type": "must be a mapping",
    "invalid_key": "must have text as keys",
}


class Variants:
    """A type that stands for one of several models, which may change while the program runs."""

    @classmethod
    def variants(cls) -> tuple[type[BaseModel], ...]:
        """Return the models that there are now."""
        raise NotImplementedError


def _variants(annotation: Any) -> list[type[BaseModel]]:
    """Return the models that an annotation may hold."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    if isinstance(annotation, type) and issubclass(annotation, Variants):
        return list(annotation.variants())
    found = []
    for argument in getattr(annotation, "__args__", ()):
        found += _variants(argument)
    return found


def _tags(models: list[type[BaseModel]]) -> dict[object, type[BaseModel]]:
    """Return the variants of a union by the value of ``law`` or ``kind`` that chooses them."""
    return {
        model.model_fields[key].default: model
        for model in models
        for key in ("law", "kind")
        if key in model.model_fields
    }


@dataclass
class _Place:
    """Where an error's location leads."""

    path: list[str]
    holder: type[BaseModel] | None
    models: list[type[BaseModel]]
    info: FieldInfo | None = None


def _walk(model: type[BaseModel], location: tuple[int | str, ...]) -> _Place:
    """Follow a location: the path without union tags, the model that holds its end, its field."""
    place = _Place([], model, [model])
    # A lane may bear the name of a law.
    is_name = False
    for part in location:
        tagged = None if is_name or len(place.models) < 2 else _tags(place.models).get(part)
        if tagged is not None:
            place.holder, place.models = tagged, []
            continue
        place.path.append(str(part))
        if is_name:
            is_name = False
        elif place.holder is not None and part in place.holder.model_fields:
            place.info = place.holder.model_fields[str(part)]
            place.models = _variants(place.info.annotation)
            place.holder = place.models[0] if len(place.models) == 1 else None
            is_name = get_origin(place.info.annotation) is dict
        elif len(place.models) <= 1:
            place.info = None
    return place


def _hint(name: object, known: list[str]) -> str:
    close = get_close_matches(str(name), known, n=1)
    return f"; did you mean {close[0]}?" if close else ""


def _unknown(key: str, holder: type[BaseModel] | None) -> str:
    known = sorted(holder.model_fields) if holder is not None else []
    hint = _hint(key, known) or "."
    return f"unknown field{hint} Known: {', '.join(known)}" if known else "unknown field"


def _wrong_tag(error: ErrorDetails, place: _Place) -> FieldError:
    key = str(error["ctx"]["discriminator"]).strip("'")
    given = error["input"].get(key) if isinstance(error["input"], Mapping) else None
    known = [str(tag) for tag in _tags(place.models)]
    text = f"{key} must be one of {', '.join(known)}, got {written(given)}{_hint(given, known)}"
    if key == "law" and isinstance(given, str):
        text += f". {OWN_LAW}"
    return FieldError(_dotted([*place.path, key]), text, plain_value(given), ", ".join(known))


def _dotted(parts: list[str]) -> str:
    return field_path(written(part) for part in parts)


def _text(error: ErrorDetails) -> str:
    """Say what is wrong with a value, in our words where pydantic's are its own."""
    text = words(error, _TEXTS)
    return text if ", got " in text else f"{text}, got {written(error.get('input'))}"


def _refusal(error: ErrorDetails, model: type[BaseModel]) -> FieldError:
    place = _walk(model, tuple(part for part in error["loc"] if part != _KEY))
    path, context, value = place.path, error.get("ctx", {}), plain_value(error.get("input"))
    if error["type"] == "combination":
        where = ".".join(part for part in (_dotted(path), context["path"]) if part)
        text = context["text"] if where else f"an experiment {context['text']}"
        return FieldError(where, text, plain_value(context["value"]))
    if error["type"] in ("union_tag_invalid", "union_tag_not_found"):
        return _wrong_tag(error, place)
    if error["type"] == "missing":
        return FieldError(_dotted(path), f"{written(path[-1])} is missing")
    if error["type"] == "extra_forbidden":
        text = _unknown(path[-1], _walk(model, error["loc"][:-1]).holder)
        return FieldError(_dotted(path), text, value)
    subject = written(path[-1]) if path else "an experiment"
    # The rule for a name begins with whose name it is.
    text = _text(error) if _KEY in error["loc"] else f"{subject} {_text(error)}"
    extra = place.info.json_schema_extra if place.info is not None else None
    allowed = allowed_text(extra) if isinstance(extra, dict) else ""
    return FieldError(_dotted(path), text, value, allowed or str(context.get("expected", "")))


def field_errors(error: ValidationError, model: type[BaseModel]) -> list[FieldError]:
    """Return one ``FieldError`` for each value that ``model`` refused."""
    details = error.errors(include_url=False)[:20]
    return [_refusal(detail, model) for detail in details]
