"""What pydantic refuses, in our words where its own speak of its inside."""

from __future__ import annotations

from collections.abc import Mapping

from pydantic_core import ErrorDetails

TEXTS = {
    "bool_parsing": "must be true or false",
    "bool_type": "must be true or false",
    "string_type": "must be text",
    "string_unicode": "must not contain unpaired surrogates",
    "string_too_long": "must have at most {max_length} characters",
    "string_too_short": "must have at least {min_length} characters",
    "too_short": "must have at least {min_length}",
    "too_long": "must have at most {max_length}",
    "literal_error": "must be one of {expected}",
    "finite_number": "must be a finite number",
}


def words(error: ErrorDetails, more: Mapping[str, str]) -> str:
    """Say what is wrong with a value.

    Args:
        error: one of pydantic's errors.
        more: texts by type of error that count beside and before ``TEXTS``; names in braces stand
            for what the error says of itself.
    """
    text = {**TEXTS, **more}.get(error["type"])
    if text is None:
        return error["msg"].removeprefix("Value error, ")
    return text.format(**error.get("ctx", {}))
