"""What every contestant is given and gives back; it needs NumPy alone, wherever a peer runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, Literal, NamedTuple

import numpy as np

Array = np.ndarray
MassAndBias = Callable[[Array, Array], tuple[Array, Array]]
"""``M, h = mass_and_bias(q, v)``: shapes (6, 6) and (6,), in [kg m^2] and [N m]."""

SAMPLE = 20
"""Steps between two rows of a trace: the reference has 50 rows a second."""
BATCH, THREADS = 64, 2
"""Whole runs that are asked for at once, and the threads that share them (*ours*)."""


@dataclass(frozen=True)
class Problem:
    """The paper's loop as numbers: RBFNN-NFTSM on the Zu 5, every joint on a sine.

    Attributes:
        urdf: file of the arm.
        preset: name of the shipped experiment that this is.
        h: control period and step in [s].
        amplitude: of the desired angles in [rad]. Shape (6,).
        omega: angular frequency in [rad/s]. Shape (6,).
        external: constant torque that the joints lose to the world in [N m]. Shape (6,).
        v0: initial velocity in [rad/s]. Shape (6,).
        nu: error gain of the surface (Eq. 5) in [1/s]; ``c``, ``mu`` and ``ratio`` = p/k as there.
        k1: proportional gain (Eq. 13) in [N m s/rad]; ``k2`` [N m] and ``epsilon`` as there.
        width: of the Gaussians (Eq. 19) in [rad].
        learning_rate: of the network (Eq. 21).
        centers: of the Gaussians in [rad]. Shape (10,).
    """

    urdf: str
    preset: str
    h: float
    amplitude: Array
    omega: Array
    external: Array
    v0: Array
    nu: Array
    c: Array
    mu: Array
    ratio: Array
    k1: Array
    k2: Array
    epsilon: Array
    width: Array
    learning_rate: Array
    centers: Array

    @classmethod
    def from_document(cls, document: dict[str, Any]) -> Problem:
        """Read what ``document`` wrote."""
        values = {
            name: np.array(value) if isinstance(value, list) else value
            for name, value in document.items()
        }
        return cls(**values)

    def document(self) -> dict[str, Any]:
        """Return it as plain numbers, lists and text."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return {
            name: value.tolist() if isinstance(value, np.ndarray) else value
            for name, value in values.items()
        }


class Trace(NamedTuple):
    """What a contestant did.

    Attributes:
        q: angles in [rad] at every ``SAMPLE``-th step, the start first. Shape (n, 6).
        diverged: when it left its bounds in [s], or ``None``.
    """

    q: Array
    diverged: float | None = None


Run = Callable[[], Trace]
"""A loop that is ready to start; loading the arm is not timed."""


class Variant(NamedTuple):
    """One way in which a peer's users would run the loop.

    Attributes:
        name: what it is, for the table.
        scheme: ``plain`` and ``extrapolated`` compute what ours compute; ``own`` is the peer's
            own integrator, ``held`` a torque held for a control period, ``open`` torques that were
            computed before, without a controller.
        prepare: loads the arm for a number of control periods.
    """

    name: str
    scheme: Literal["plain", "extrapolated", "own", "held", "open"]
    prepare: Callable[[Problem, int], Run]
