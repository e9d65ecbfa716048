"""Which laws are the same in OpenSMC and here, and with which gains; data alone, for both Pythons.

OpenSMC's laws act on one axis each and know no arm. Where one is an acceleration, its arm's own M,
C and G make a torque of it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

from tests.peers.opensmc.tasks import STEP

Gains = dict[str, Any]
Part = tuple[str, Gains]
"""Name of one of OpenSMC's classes, and what it is made with."""


@dataclass(frozen=True)
class Pair:
    """One law, there and here.

    Attributes:
        ours: gains of a lane.
        theirs: a controller for each joint.
        surface: its sliding surface, where it is given one.
        reaching: its reaching law, where it is given one.
        made: how a torque is made of what the two controllers return: it is one (``torque``), an
            acceleration (``model``) or, in its parts, an equivalent acceleration and a torque
            (``parts``).
        ahead: whether it has to be told the desired acceleration apart.
        tasks: keys of ``TASKS``.
    """

    ours: Gains
    theirs: Part
    surface: Part | None = None
    reaching: Part | None = None
    made: Literal["torque", "model", "parts"] = "model"
    ahead: bool = False
    tasks: tuple[str, ...] = field(default=("reach", "follow"))


_SLOPE, _GAIN, _LAYER, _RATE = 15.0, 20.0, 0.1, 10.0
"""Slope [1/s], switching gain and layer [rad/s] (*published*: OpenSMC's robot-arm benchmark), and
rate of an exponential reaching law (*published*: the default there)."""
_POWER = 0.8
"""Of the power reaching law (*ours*): 0.5 is so steep at S = 0 that rounding decides there."""
_SMC: Gains = {"law": "smc", "lambda_": _SLOPE}
_PLAIN: Gains = {"law": "nftsm", "nu": _SLOPE, "c": 1.0, "mu": 0.0, "inertia_shaped": True}
_SATURATION: Gains = {"switching": "saturation", "epsilon": _LAYER}
_CLASSICAL: Part = ("ClassicalSMC", {"c": _SLOPE})

PAIRS: dict[str, Pair] = {
    "RBFNN-SMC without learning: constant, saturation": Pair(
        {
            **{"law": "rbfnn_smc", "lambda_": _SLOPE, "learning_rate": 0.0},
            **{"reaching": "constant", "k2": _GAIN, **_SATURATION},
        },
        ("ClassicalSMC", {}),
        surface=("LinearSurface", {"c": _SLOPE}),
        reaching=("Saturation", {"k": _GAIN, "phi": _LAYER}),
        made="torque",
    ),
    "SMC: constant, sign": Pair(
        {**_SMC, "reaching": "constant", "k2": _GAIN, "switching": "sign"},
        _CLASSICAL,
        reaching=("ConstantRate", {"k": _GAIN}),
        made="parts",
    ),
    "SMC: constant, saturation": Pair(
        {**_SMC, "reaching": "constant", "k2": _GAIN, **_SATURATION},
        _CLASSICAL,
        reaching=("Saturation", {"k": _GAIN, "phi": _LAYER}),
        made="parts",
    ),
    "SMC: exponential, sign": Pair(
        {**_SMC, "k1": _RATE, "k2": _GAIN, "switching": "sign"},
        ("ClassicalSMC", {"c": _SLOPE, "k": _RATE, "eta": _GAIN}),
        made="parts",
    ),
    "SMC: power, sign": Pair(
        {**_SMC, "reaching": "power", "k1": _GAIN, "alpha": _POWER, "switching": "sign"},
        _CLASSICAL,
        reaching=("PowerRate", {"k": _GAIN, "alpha": _POWER}),
        made="parts",
    ),
    "NFTSM behind M, μ = 0: exponential, sign": Pair(
        {**_PLAIN, "k1": _RATE, "k2": _GAIN, "switching": "sign"},
        _CLASSICAL,
        reaching=("ExponentialRate", {"k": _GAIN, "q": _RATE}),
    ),
    "NFTSM behind M, μ = 0: exponential, saturation": Pair(
        {**_PLAIN, "k1": _RATE, "k2": _GAIN, **_SATURATION},
        (
            "ITSMC",
            {"c1": _SLOPE, "c2": 0.0, "K": _GAIN, "lambda_s": _RATE, "phi": _LAYER, "dt": STEP},
        ),
    ),
    "super-twisting": Pair(
        {"law": "super_twisting", "lambda_": _SLOPE, "k1": 15.0, "k2": 110.0},
        _CLASSICAL,
        reaching=("SuperTwisting", {"k1": 15.0, "k2": 110.0, "dt": STEP}),
    ),
    # Its S is 0 at the beginning only where the motion begins on the surface.
    "integral SMC: exponential, saturation": Pair(
        {
            **{"law": "integral_smc", "kp": 100.0, "kd": 20.0, "k1": _RATE, "k2": _GAIN},
            **_SATURATION,
        },
        (
            "ITSMC",
            {
                **{"c1": 20.0, "c2": 100.0, "p": 1, "q": 1, "dt": STEP},
                **{"K": _GAIN, "lambda_s": _RATE, "phi": _LAYER},
            },
        ),
        tasks=("follow",),
    ),
    "computed torque PD": Pair(
        {"law": "computed_torque", "kp": 100.0, "kd": 20.0},
        ("PID", {"Kp": 100.0, "Kd": 20.0, "Ki": 0.0, "dt": STEP}),
        ahead=True,
    ),
}
"""By what each is here."""
