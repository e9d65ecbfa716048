"""Switching functions and reaching laws: value and slope.

e = q_d - q, so that a positive sliding variable asks for a positive torque.
"""

from __future__ import annotations

from math import copysign, tanh
from typing import Any, Literal, get_args

import numpy as np
from pydantic import field_validator, model_validator
from pydantic_core import PydanticCustomError

from slidetune.robot.fields.quantity import JOINTS, Number, PerJoint, Section, field, refusal
from slidetune.robot.kernels.compiler import inlined, kernel
from slidetune.robot.kernels.workspace import CURVE, CURVE_ROWS, GAIN, PERIOD, REACH, S

Array = np.ndarray

Switching = Literal["tanh", "saturation", "sign", "implicit"]
ModelFreeSwitching = Literal["tanh", "saturation", "sign"]
Reaching = Literal["exponential", "constant", "power"]

SWITCHINGS: tuple[Switching, ...] = get_args(Switching)
REACHINGS: tuple[Reaching, ...] = ("exponential", "constant", "power")

HELD = 1e-3
"""|S| that counts as held at zero by sign in [rad/s] (*ours*). Continuous mode holds it to 5e-6 at
steps of 1 ms, and to 1.3e-4 at the longest, 5 ms."""

TANH, SATURATION, SIGN, IMPLICIT = 0, 1, 2, 3
EXPONENTIAL, CONSTANT, POWER, TWISTING = 0, 1, 2, 3

K1, K2, EPSILON, ALPHA = range(4)
# In column 0: two codes, and whether this is a reaching law at all.
SWITCHING_CODE, REACHING_CODE, IS_REACHING = range(4, CURVE_ROWS)


class ReachingGains(Section):
    """Reaching law of a lane (Eq. 10-13)."""

    k1: PerJoint = field(
        150.0,
        title="Proportional reaching gain",
        symbol="k₁",
        unit="N·m·s/rad",
        low=0.0,
        high=1000.0,
        step=1.0,
        equation="Eq. 13",
        group="Reaching",
        needs={"reaching": ("exponential", "power")},
        source="published",
        meaning="Torque per unit of the sliding variable: it drives S to zero in proportion to S.",
    )
    k2: PerJoint = field(
        150.0,
        title="Switching gain",
        symbol="k₂",
        unit="N·m",
        low=0.0,
        high=1000.0,
        step=1.0,
        equation="Eq. 13",
        group="Reaching",
        needs={"reaching": ("exponential", "constant")},
        source="published",
        meaning="Maximum torque of the switching term: the disturbance that it can reject.",
    )
    epsilon: PerJoint = field(
        1.0,
        title="Boundary layer",
        symbol="ε",
        unit="rad/s",
        low=1e-4,
        high=10.0,
        step=0.01,
        scale="log",
        equation="Eq. 13",
        group="Reaching",
        needs={"switching": ("tanh", "saturation")},
        source="published",
        meaning="|S| at which saturation reaches 1 and tanh 0.76; the others do not use it.",
    )
    switching: Switching = field(
        "tanh",
        title="Switching function",
        symbol="sw",
        equation="Eq. 13",
        group="Reaching",
        source="published",
        meaning="tanh(S/ε) as published, saturation clip(S/ε, -1, 1), sign(S), which chatters in "
        "sampled mode and holds S at zero in continuous mode, or implicit: sign(S) at the end of "
        "the period, by the model; a layer of exactly T·k₂, which needs no ε and no delay.",
    )
    reaching: Reaching = field(
        "exponential",
        title="Reaching law",
        equation="Eq. 10-13",
        group="Reaching",
        source="published",
        meaning="Exponential k₁S + k₂sw(S) (Eq. 11; with tanh Eq. 13), constant k₂sw(S) (Eq. 10) "
        "or power k₁|S|^α sw(S) (Eq. 12).",
    )
    alpha: Number = field(
        0.5,
        title="Power of the reaching law",
        symbol="α",
        low=0.05,
        high=0.95,
        step=0.05,
        equation="Eq. 12",
        group="Reaching",
        needs={"reaching": ("power",)},
        meaning="Exponent of the power reaching law; the other two do not use it.",
    )

    @property
    def layer(self) -> PerJoint:
        """Within which S counts as reached in [rad/s], where it isn't for the period to say."""
        return HELD if self.switching in ("sign", "implicit") else self.epsilon

    @model_validator(mode="after")
    def _implicit_has_a_switching_term(self) -> ReachingGains:
        if self.switching == "implicit" and self.reaching == "power":
            text = (
                "switching must be tanh, saturation or sign where reaching is power, got implicit: "
                "k₁|S|^α has no term k₂ whose sign could be taken at the end of the period; choose "
                "reaching exponential or constant for it"
            )
            raise refusal("switching", self.switching, text)
        return self

    def pack_reaching(self, joints: int = JOINTS) -> Array:
        """Return the reaching law as numbers. Shape (7, n)."""
        block = np.zeros((CURVE_ROWS, joints))
        block[K1], block[K2], block[EPSILON], block[ALPHA] = (
            self.k1,
            self.k2,
            self.epsilon,
            self.alpha,
        )
        block[SWITCHING_CODE, 0] = SWITCHINGS.index(self.switching)
        block[REACHING_CODE, 0] = REACHINGS.index(self.reaching)
        block[IS_REACHING, 0] = 1.0
        return block


class ModelFreeReachingGains(ReachingGains):
    """The same for a law that does not know M, by which alone the end of a period is known."""

    switching: ModelFreeSwitching = field(
        "tanh",
        title="Switching function",
        symbol="sw",
        equation="Eq. 13",
        group="Reaching",
        source="published",
        meaning="tanh(S/ε) as published, saturation clip(S/ε, -1, 1), or sign(S), which chatters "
        "in sampled mode and holds S at zero in continuous mode.",
    )

    @field_validator("switching", mode="before")
    @classmethod
    def _needs_no_model(cls, value: Any) -> Any:
        if value == "implicit":
            raise PydanticCustomError(
                "model_free",
                "must be one of {expected}, got implicit: that takes sign(S) at the end of the "
                "period, which only a law with a model of the arm can predict",
                {"expected": "tanh, saturation, sign"},
            )
        return value


@kernel
def switch(code, s, epsilon):  # type: ignore[no-untyped-def]
    r"""Switching function and its slope.

    .. math:: \tanh(S/\epsilon), \quad \operatorname{clip}(S/\epsilon, -1, 1), \quad
        \operatorname{sign}(S)

    Args:
        code: TANH, SATURATION or SIGN; IMPLICIT is SIGN, see ``implicit_switching``.
        s: sliding variable of one joint in [rad/s].
        epsilon: boundary layer in [rad/s].

    Returns:
        Value [-] and slope in [s/rad]; the slope of sign is 0.
    """
    if code == TANH:
        value = tanh(s / epsilon)
        return value, (1.0 - value * value) / epsilon
    if code == SATURATION:
        if abs(s) < epsilon:
            return s / epsilon, 1.0 / epsilon
        return copysign(1.0, s), 0.0
    return (0.0 if s == 0.0 else copysign(1.0, s)), 0.0


@kernel
def reaching(block, j, s):  # type: ignore[no-untyped-def]
    r"""Reaching law of one joint (Liu et al. 2025, Eq. 10-13) and its slope.

    .. math:: k_1 S + k_2\,\mathrm{sw}(S), \quad k_2\,\mathrm{sw}(S), \quad
        k_1 |S|^\alpha\,\mathrm{sw}(S)

    Args:
        block: numbers of ``ReachingGains.pack_reaching``. Shape (5, 6).
        j: which joint, from 0.
        s: its sliding variable in [rad/s].

    Returns:
        Value [N m] and slope [N m s/rad].
    """
    law, k1, k2 = block[REACHING_CODE, 0], block[K1, j], block[K2, j]
    value, slope = switch(block[SWITCHING_CODE, 0], s, block[EPSILON, j])
    if law == EXPONENTIAL:
        return k1 * s + k2 * value, k1 + k2 * slope
    if law == CONSTANT:
        return k2 * value, k2 * slope
    if law == TWISTING:
        root = k1 * max(abs(s), 1e-12) ** 0.5
        return (root + k2) * value, 0.5 * root / max(abs(s), 1e-12)
    size, alpha = max(abs(s), 1e-12), block[ALPHA, j]
    power = k1 * size**alpha
    return power * value, power * (slope + alpha * abs(value) / size)


@inlined
def reach(block, work):  # type: ignore[no-untyped-def]
    """Reaching law of every joint: value into REACH, slope into GAIN, the law itself into CURVE.

    IMPLICIT stays to be written where there is a control period; without one it is SIGN.

    Args:
        block: numbers of ``ReachingGains.pack_reaching``. Shape (5, 6).
        work: workspace; reads S.
    """
    # Once after the lane was bound: its gains stay as they are until it is bound anew.
    if work[CURVE + IS_REACHING, 0] == 0.0:
        for row in range(CURVE_ROWS):
            for j in range(JOINTS):
                work[CURVE + row, j] = block[row, j]
        if block[SWITCHING_CODE, 0] == IMPLICIT and work[PERIOD, 0] == 0.0:
            work[CURVE + SWITCHING_CODE, 0] = SIGN
    for j in range(JOINTS):
        work[REACH, j], work[GAIN, j] = reaching(block, j, work[S, j])
