"""How large a message to the live session may be, and for how many of them it counts."""

from __future__ import annotations

from typing import Any

from slidetune.robot.fields.plain_values import excess
from slidetune.server.guard.limits import MAX_LIVE_MESSAGE, MessageTooLargeError
from slidetune.server.guard.plain_json import NotJsonError, read_json

SHORT = 4096
"""Characters that cost as much as a message does at least, and that are read even to refuse it
(*ours*)."""


def message_cost(text: str) -> int:
    """Return how many messages a message counts for: reading a long one takes longer."""
    return 1 + min(len(text), MAX_LIVE_MESSAGE) // SHORT


def short_id(text: str) -> Any:
    """Return the ``id`` of a message that isn't acted on, if reading it costs next to nothing."""
    if len(text) > SHORT:
        return None
    try:
        data = read_json(text)
    except NotJsonError:
        return None
    return data.get("id") if isinstance(data, dict) else None


def refuse_if_long(text: str) -> None:
    """Refuse a message that nobody should read.

    Raises:
        MessageTooLargeError: naming the limit.
    """
    if len(text) > MAX_LIVE_MESSAGE:
        raise MessageTooLargeError(f"a message may have at most {MAX_LIVE_MESSAGE // 1024} KiB")


def refuse_if_many(data: Any) -> None:
    """Refuse a message that nobody should look at key by key.

    Raises:
        MessageTooLargeError: naming the limit.
    """
    if too_many := excess(data):
        raise MessageTooLargeError(f"the message {too_many}")
