"""What the rest of the project knows of a control law."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from slidetune.robot.fields.quantity import Section
from slidetune.robot.integrator.law_call import Advance, Control

Array = np.ndarray


class PackedGains(Protocol):
    """A lane that can hand its gains to its kernels."""

    def pack(self) -> Array:
        """Return all gains as numbers. Shape (n, 6)."""
        ...


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
        memory: how many rows of the state from W on, where others have weights, are its memory.
        advance: ``(h, state, into, gains, nominal_M, nominal_nle, work)`` moves that on over a
            step h [s] of continuous mode (after it, from the state whose first row is ``state``
            to ``into``) or a control period (both are the current state), and the memory of an
            observer; ``work`` holds what the step solved.
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

    def used_by(self, lane: Section) -> Law:
        """Return the law as a lane uses it: without a memory to move on where it has none."""
        observes = getattr(lane, "observer", "none") != "none"
        return self if self.memory or observes else replace(self, advance=None)
