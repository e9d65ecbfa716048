"""The one shape that every error of the HTTP and WebSocket contract has."""

from __future__ import annotations

from collections.abc import Mapping, Sequence


def error_body(
    code: str, message: str, fields: Sequence[Mapping[str, object]] = ()
) -> dict[str, object]:
    """Return ``{"error": {"code", "message", "fields"}}``.

    Args:
        code: a short, stable name that a program can act on, such as ``token_required``.
        message: what is wrong and the way out, for the person at the screen.
        fields: one mapping for each refused value (path, message, value, allowed).

    Returns:
        The body, ready for JSON.
    """
    return {"error": {"code": code, "message": message, "fields": [dict(f) for f in fields]}}
