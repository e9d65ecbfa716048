"""When an answer to a wrong input counts as clear, and the faults found when it doesn't."""

from __future__ import annotations

import re
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

SLOW = 1.0
"""An input that takes longer than this in [s] is reported; it decides nothing (*ours*)."""
LONGEST_MESSAGE = 16_384
"""Most characters of a whole refusal, twenty fields at most (*ours*)."""
LONGEST_FIELD = 3_000
"""Most characters of one refused field: a path of twelve keys, a value, the ways out (*ours*)."""

_ROOT = Path(__file__).resolve().parents[3]
_INTERNALS = re.compile(
    r"Traceback|<class |<[a-z_.]+ object|object at 0x|pydantic|Input should|Input tag|NoneType"
    r"|\bNone\b|\bTrue\b|\bFalse\b|sys\.set_|recursion depth|codec can't|Expecting |Invalid \\"
    r"|validation error|function-|tagged-union|string conversion|Unterminated|JSON decode"
)
_OF_THE_WHOLE = re.compile(
    r"KiB|UTF-8|text is damaged|is empty|an experiment|JSON|mapping of keys|directives|patch"
    r"|message|request|body|nothing at|not offered at|preset |lesson "
)


@dataclass
class Fault:
    """One kind of fault: how often, and the smallest input that shows it."""

    cause: str
    detail: str
    example: str
    count: int = 1

    def merge(self, other: Fault) -> None:
        """Count another one of the same kind."""
        self.count += other.count
        if len(other.example) < len(self.example):
            self.example, self.detail = other.example, other.detail


@dataclass
class Tally:
    """What became of some inputs.

    Attributes:
        accepted: how many were taken.
        refused: how many were clearly refused.
        slow: how many took longer than ``SLOW``.
        slowest: longest time of one in [s].
        slowest_input: which one that was.
        memory: growth of the process's greatest memory in [MB].
        faults: kinds of faults by their cause.
    """

    accepted: int = 0
    refused: int = 0
    slow: int = 0
    slowest: float = 0.0
    slowest_input: str = ""
    memory: float = 0.0
    faults: dict[str, Fault] = field(default_factory=dict)

    @property
    def inputs(self) -> int:
        """How many inputs were judged."""
        return self.accepted + self.refused + sum(fault.count for fault in self.faults.values())

    def note(self, accepted: bool, complaint: tuple[str, str] | None, example: object) -> None:
        """Count one input; ``complaint`` is the cause and the detail of a fault, or ``None``."""
        if complaint is not None:
            self.add(Fault(*complaint, shown(example)))
        elif accepted:
            self.accepted += 1
        else:
            self.refused += 1

    def time(self, seconds: float, example: object = "") -> None:
        """Note how long one input took."""
        self.slow += seconds > SLOW
        if seconds > self.slowest:
            self.slowest, self.slowest_input = seconds, shown(example)

    def add(self, fault: Fault) -> None:
        """Count a fault."""
        if fault.cause in self.faults:
            self.faults[fault.cause].merge(fault)
        else:
            self.faults[fault.cause] = fault

    def merge(self, other: Tally) -> None:
        """Add what another process counted."""
        self.accepted += other.accepted
        self.refused += other.refused
        self.slow += other.slow
        if other.slowest > self.slowest:
            self.slowest, self.slowest_input = other.slowest, other.slowest_input
        self.memory = max(self.memory, other.memory)
        for fault in other.faults.values():
            self.add(fault)


def shown(example: object) -> str:
    """Return an input as text that can be printed, not too long."""
    try:
        text = example if isinstance(example, str) else repr(example)
    except (ValueError, RecursionError):
        text = f"a {type(example).__name__} too deep or too long to be written"
    text = text.encode("utf-8", "backslashreplace").decode()
    return text if len(text) <= 1000 else f"{text[:900]}… ({len(text)} characters)"


def words(value: object) -> str:
    """Return every text in a value, key or item, so that an echo of it is known as one."""
    found, left = [], [value]
    while left:
        item = left.pop()
        if isinstance(item, Mapping):
            left += [*item, *item.values()]
        elif isinstance(item, list | tuple):
            left += item
        elif isinstance(item, str):
            found.append(item)
    return "\n".join(found)


def crash(error: BaseException) -> tuple[str, str]:
    """Return cause and detail of an exception that should not have come out."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in frames if Path(frame.filename).is_relative_to(_ROOT / "robot")]
    where = ours[-1] if ours else frames[-1]
    place = f"{Path(where.filename).name}:{where.name}"
    return f"{type(error).__name__} in {place}", shown(str(error))[:300]


def unclear(message: str, fields: Sequence[Mapping[str, Any]], given: str) -> str | None:
    """Return why a refusal is not clear, or ``None``.

    Args:
        message: its whole text.
        fields: path, message and line of every refused value.
        given: the input as text: words in it may come back.
    """
    if not message.strip():
        return "empty message"
    if len(message) > LONGEST_MESSAGE:
        return "message too long"
    for one in fields:
        if len(f"{one['path']}{one['message']}{one.get('value')}") > LONGEST_FIELD:
            return "field too long"
        if not (one["path"] or one.get("line") or _OF_THE_WHOLE.search(one["message"])):
            return "names neither field nor place"
    if not fields and not _OF_THE_WHOLE.search(message):
        return "names nothing"
    for match in _INTERNALS.finditer(message):
        if match.group() not in given:
            return f"speaks of the inside: {match.group()}"
    return None


def unclear_answer(body: Any, given: str) -> str | None:
    """Return why a body of HTTP or an ``error`` message of the WebSocket is not clear."""
    if not isinstance(body, Mapping) or not isinstance(body.get("error"), Mapping):
        return "not the one shape of an error"
    error = body["error"]
    if set(error) != {"code", "message", "fields"} or not error["code"]:
        return "not the one shape of an error"
    if any(set(one) != {"path", "message", "value", "allowed", "line"} for one in error["fields"]):
        return "not the one shape of a field"
    return unclear(error["message"], error["fields"], given)
