"""One thing that is wrong, was assumed or should be looked at in a description."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Literal

from slidetune.robot.fields.written_value import written

Kind = Literal["refused", "assumed", "noted"]
KINDS: tuple[Kind, ...] = ("refused", "assumed", "noted")
_MOST_NAMES = 12
"""Most names that a text lists (*ours*)."""


@dataclass(frozen=True)
class Finding:
    """What the doctor says about one element.

    Attributes:
        kind: refused (it can't go on), assumed (it went on with something), noted (look at this).
        where: the element, such as ``joint elbow`` or ``link forearm``.
        line: line of the element in the file, counted from 1.
        text: what is wrong: element, value, what is allowed, unit.
        remedy: a way out.
    """

    kind: Kind
    where: str
    line: int | None
    text: str
    remedy: str


class Findings:
    """All that was found so far."""

    def __init__(self) -> None:
        """Begin with none."""
        self._found: list[Finding] = []

    def refuse(self, where: str, line: int | None, text: str, remedy: str) -> None:
        """Add what keeps the arm from being loaded."""
        self._add("refused", where, line, text, remedy)

    def assume(self, where: str, line: int | None, text: str, remedy: str) -> None:
        """Add what was put in the place of something that is missing or wrong."""
        self._add("assumed", where, line, text, remedy)

    def note(self, where: str, line: int | None, text: str, remedy: str) -> None:
        """Add what a person should look at."""
        self._add("noted", where, line, text, remedy)

    def _add(self, kind: Kind, where: str, line: int | None, text: str, remedy: str) -> None:
        self._found.append(Finding(kind, where, line, text, remedy))

    @property
    def refused(self) -> bool:
        """Whether anything is refused."""
        return any(finding.kind == "refused" for finding in self._found)

    def ordered(self) -> tuple[Finding, ...]:
        """Return each once: the refused ones first, each kind in the file's order."""
        found = dict.fromkeys(self._found)
        return tuple(sorted(found, key=lambda f: (KINDS.index(f.kind), f.line or 0)))


def joint_named(name: str) -> str:
    """Return how a finding names a joint."""
    return f"joint {written(name)}"


def link_named(name: str) -> str:
    """Return how a finding names a link."""
    return f"link {written(name)}"


def names(known: Iterable[str]) -> str:
    """Return names as a list in a text, and how many more there are."""
    all_names = [written(name) for name in known]
    shown = ", ".join(all_names[:_MOST_NAMES])
    more = len(all_names) - _MOST_NAMES
    return f"{shown} and {more} more" if more > 0 else shown


def closest_first(name: str, known: Iterable[str]) -> list[str]:
    """Return the known names, those that look like ``name`` first."""
    all_names = list(dict.fromkeys(known))
    close = get_close_matches(name, all_names, n=5, cutoff=0.4)
    return [*close, *(other for other in all_names if other not in close)]


def figure(value: float) -> str:
    """Return a number as a text shows it."""
    return f"{value:.6g}"


def figures(values: Iterable[float]) -> str:
    """Return numbers as a text shows them."""
    return " ".join(figure(value) for value in values)
