"""What a part of a trial found."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Verdict:
    """What a part of a trial found.

    Attributes:
        body: Markdown for the documentation.
        broken: promises that were broken, in words; none may be.
        missed: targets that were missed, in words: they depend on the machine too.
    """

    body: str
    broken: tuple[str, ...] = ()
    missed: tuple[str, ...] = ()
