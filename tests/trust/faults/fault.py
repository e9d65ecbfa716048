"""What a fault is, what came of it, and which promises it broke."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Outcome:
    """What came of a fault.

    Attributes:
        often: how often it was provoked, and how.
        measured: what happened, in figures.
        broken: promises that were not kept, in words.
    """

    often: str
    measured: str
    broken: tuple[str, ...] = ()


@dataclass(frozen=True)
class Fault:
    """One thing that goes wrong.

    Attributes:
        name: what ``--only`` takes.
        title: what goes wrong.
        promised: what must hold nevertheless.
        provoke: makes it go wrong; its argument says whether a short look will do.
    """

    name: str
    title: str
    promised: str
    provoke: Callable[[bool], Outcome]


@dataclass
class Promises:
    """Keeps account of what was found broken.

    Attributes:
        broken: one sentence for each broken promise, each said once.
    """

    broken: list[str] = field(default_factory=list)

    def hold(self, kept: object, otherwise: str) -> bool:
        """Note ``otherwise`` unless ``kept`` is true; return whether it is."""
        if not kept and otherwise not in self.broken:
            self.broken.append(otherwise)
        return bool(kept)

    def outcome(self, often: str, measured: str) -> Outcome:
        """Return what came of the fault."""
        return Outcome(often, measured, tuple(self.broken))
