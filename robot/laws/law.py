"""What the rest of the project knows of a control law."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from slidetune.robot.fields.quantity import Section

Array = np.ndarray


class PackedGains(Protocol):
    """A lane that can hand its gains to its kernels."""

    def pack(self) -> Array:
        """Return all gains as numbers. Shape (n, 6)."""
        ...


@dataclass(frozen=True)
class Law:
    """One control law.

    Every law writes out its ``step`` and ``sample``, a line each: numba keeps on disk what stands
    at the top of a module, and nothing that a function returned.

    Attributes:
        name: value of ``law`` in a lane.
        title: name on the screen.
        summary: the law in one line, with its equation.
        lane: the gains, a ``Section`` with a ``pack()``.
        step: compiled stage of continuous mode: ``(t, row, table) -> 0 or 1 + joint``, with a
            table of the lane's arrays (``kernel_table``).
        sample: compiled control period of sampled mode: ``(t, number, row, table) -> 0 or
            1 + joint``; the step of its table is the control period.
        model_based: whether it needs the nominal arm.
        network: whether it has a network.
    """

    name: str
    title: str
    summary: str
    lane: type[Section]
    step: Callable[..., int]
    sample: Callable[..., int]
    model_based: bool
    network: bool
