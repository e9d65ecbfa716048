"""A reaching law behind the inertia: its gains are accelerations, equal on every arm and joint."""

from __future__ import annotations

from slidetune.robot.fields.quantity import JOINTS, PerJoint, field
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import BENDS, REACH, SHAPE, SHAPED, TAU
from slidetune.robot.laws.terms.switching import ReachingGains


class ShapedReachingGains(ReachingGains):
    """Reaching law of a lane, behind M: with an exact model and F = 0, dS/dt = -k₁S - k₂sw(S)."""

    k1: PerJoint = field(
        10.0,
        title="Proportional reaching gain",
        symbol="k₁",
        unit="1/s",
        low=0.0,
        high=1000.0,
        step=1.0,
        group="Reaching",
        needs={"reaching": ("exponential", "power")},
        meaning="Rate at which S falls to zero in proportion to S, by the model.",
    )
    k2: PerJoint = field(
        30.0,
        title="Switching gain",
        symbol="k₂",
        unit="rad/s²",
        low=0.0,
        high=1000.0,
        step=1.0,
        group="Reaching",
        needs={"reaching": ("exponential", "constant")},
        meaning="Acceleration of the switching term: the M⁻¹F that it can reject.",
    )
    epsilon: PerJoint = field(
        0.1,
        title="Boundary layer",
        symbol="ε",
        unit="rad/s",
        low=1e-4,
        high=10.0,
        step=0.01,
        scale="log",
        group="Reaching",
        needs={"switching": ("tanh", "saturation")},
        meaning="|S| at which saturation reaches 1 and tanh 0.76; the others do not use it.",
    )

    @property
    def inertia_shaped(self) -> bool:
        """Its gains are accelerations, always."""
        return True


@kernel
def shape_by_inertia(inertia, work):  # type: ignore[no-untyped-def]
    """Add REACH [rad/s^2] behind the inertia to TAU [N m], for a surface with dS/d(de) = 1.

    Args:
        inertia: M of the nominal arm. Shape (6, 6).
        work: workspace; writes SHAPE.
    """
    work[SHAPED, 0], work[BENDS, 0] = 1.0, 0.0
    for i in range(JOINTS):
        for j in range(JOINTS):
            work[SHAPE + i, j] = inertia[i, j]
            work[TAU, i] += inertia[i, j] * work[REACH, j]
