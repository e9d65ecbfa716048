"""What the rest of the project knows of a control law."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol, TypedDict

import numpy as np

from slidetune.robot.fields.quantity import JOINTS, Section
from slidetune.robot.integrator.law_call import Advance, Control
from slidetune.robot.laws.terms.observer import OBSERVER_MEMORY

Array = np.ndarray


class PackedGains(Protocol):
    """A lane that can hand its gains to its kernels."""

    def pack(self, joints: int = JOINTS) -> Array:
        """Return all gains as numbers, one column a joint. Shape (rows, joints)."""
        ...


class LawKernels(TypedDict):
    """Arguments of ``kernel_table`` that a law gives."""

    control: Control
    advance: Advance | None
    network: bool


@dataclass(frozen=True)
class Law:
    """One control law.

    Attributes:
        name: value of ``law`` in a lane.
        title: name on the screen.
        summary: the law in one line, with its equation.
        lane: the gains, a ``Section`` with a ``pack()``.
        control: ``(state, gains, nominal_M, nominal_nle, work)`` writes the torque to TAU [N m],
            for the desired and the measured motion in the workspace; ``state`` is the first row of
            the state whose weights count. A ``kernel``; a plain function is called back, slowly.
        model_based: whether it needs the nominal arm.
        network: whether it has a network.
        memory: how many rows of the state, W and those after it, hold what it integrates where it
            has no network. They are 0 at the beginning and where a lane changes to it.
        advance: ``(h, state, into, gains, nominal_M, nominal_nle, work)`` moves them on, from the
            state with the first row ``state`` to the one with ``into``, which already holds them
            unchanged, and may be the same. In continuous mode it is called after each implicit
            step of length h [s], and may read what that left in the workspace: S at its end is
            S_FREE - S_FALL a, a in RIGHT. In sampled mode (``FLAGS``, ``PERIOD``) it is called once
            a control period h, when TAU has been limited. Like ``control`` a ``kernel``; a plain
            function is called back. Of a law with an observer it moves that one's rows on, too.
        states: which rows of its memory a small deviation moves by as much: those that a margin
            has to know. What is slow, such as a gain that adapts, stays what it is there.
        version: digest of the file that it was read from; empty for a law that ships with the
            program.
    """

    name: str
    title: str
    summary: str
    lane: type[Section]
    control: Control
    model_based: bool
    network: bool
    memory: int = 0
    advance: Advance | None = None
    states: tuple[int, ...] = ()
    version: str = ""

    def used_by(self, lane: Section) -> Law:
        """Return the law as a lane uses it: with an observer's memory, or without one at all."""
        if getattr(lane, "observer", "none") != "none":
            return replace(self, memory=self.memory + OBSERVER_MEMORY)
        return self if self.memory else replace(self, advance=None)

    @property
    def kernels(self) -> LawKernels:
        """What a lane's table needs of the law."""
        return {"control": self.control, "advance": self.advance, "network": self.network}
