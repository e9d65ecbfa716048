"""What the rest of the project knows of a control law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from slidetune.robot.fields.quantity import Section
from slidetune.robot.integrator.law_call import Control

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
    """

    name: str
    title: str
    summary: str
    lane: type[Section]
    control: Control
    model_based: bool
    network: bool
