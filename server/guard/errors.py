"""The one shape that every error of the HTTP and WebSocket contract has."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite

LONGEST_MESSAGE = 8000
"""Most characters of a whole message (*ours*); twenty refused fields are told at once."""
LONGEST_TEXT = 2000
"""Most characters of any other text in an error (*ours*)."""


def error_body(
    code: str, message: str, fields: Sequence[Mapping[str, object]] = ()
) -> dict[str, object]:
    """Return ``{"error": {"code", "message", "fields"}}``.

    Args:
        code: a short, stable name that a program can act on, such as ``token_required``.
        message: what is wrong and the way out, for the person at the screen.
        fields: one mapping for each refused value (path, message, value, allowed).

    Returns:
        The body, ready for JSON: its texts are bounded and UTF-8 can carry them, whatever they
        repeat of what was sent.
    """
    told = [{key: _sendable(value, LONGEST_TEXT) for key, value in one.items()} for one in fields]
    return {"error": {"code": code, "message": _sendable(message, LONGEST_MESSAGE), "fields": told}}


def _sendable(value: object, longest: int) -> object:
    if isinstance(value, float) and not isfinite(value):
        return str(value)
    if not isinstance(value, str):
        return value
    text = value if len(value) <= longest else value[:longest] + "…"
    return text.encode("utf-8", "backslashreplace").decode()
