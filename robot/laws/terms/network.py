"""Radial-basis-function layer of every joint and its adaptation."""

from __future__ import annotations

from math import exp
from typing import Literal

import numpy as np

from slidetune.robot.fields.quantity import JOINTS, Number, PerJoint, Section, field
from slidetune.robot.kernels.compiler import inlined, kernel
from slidetune.robot.kernels.workspace import (
    HIDDEN,
    LEAKAGE,
    LEARNING,
    MEASURED_Q,
    NETWORK,
    NETWORK_SLOPE,
    NODES,
    QD,
    W,
)

Array = np.ndarray

NetworkInput = Literal["error", "angle", "desired"]
INPUTS: tuple[NetworkInput, ...] = ("error", "angle", "desired")

SHARPNESS, PHI, SIGMA, SPAN, INPUT, DECAY = range(6)
NETWORK_ROWS = 6
STEEPEST = 100.0
"""Exponent past which a Gaussian is not worked out from its neighbour (*ours*: 1e-13 off there)."""


class NetworkGains(Section):
    """Ten Gaussians per joint with adaptive weights (Eq. 19-21)."""

    width: PerJoint = field(
        10.0,
        title="Width of the Gaussians",
        symbol="b",
        unit="rad",
        low=0.02,
        high=100.0,
        step=0.01,
        scale="log",
        equation="Eq. 19",
        group="RBF network",
        source="published",
        meaning="At b = 10 every Gaussian is nearly 1 and the network integrates S.",
    )
    learning_rate: PerJoint = field(
        50.0,
        title="Learning rate",
        symbol="φ",
        unit="N·m/rad",
        low=0.0,
        high=2000.0,
        step=1.0,
        equation="Eq. 21",
        group="RBF network",
        source="published",
        meaning="Adaptation gain: rate of the weights per unit of S; 0 switches learning off.",
    )
    leakage: PerJoint = field(
        0.0,
        title="Leakage",
        symbol="σ",
        unit="1/s",
        low=0.0,
        high=50.0,
        step=0.01,
        group="RBF network",
        meaning="Decay rate of the weights, against integral windup; 0 as published.",
    )
    center_span: Number = field(
        1.0,
        title="Span of the centres",
        symbol="c_j",
        unit="rad",
        low=0.05,
        high=10.0,
        step=0.05,
        scale="log",
        equation="Eq. 19",
        group="RBF network",
        source="corrected",
        meaning="The ten centres are evenly spaced over ± this value; published: -1 to 1.",
    )
    network_input: NetworkInput = field(
        "error",
        title="Network input",
        symbol="X",
        equation="Eq. 19",
        group="RBF network",
        source="inferred",
        meaning="Input of the Gaussians: the error e, the angle q or the desired angle q_d.",
    )

    @property
    def spacing(self) -> float:
        """Distance between the centres of two neighbouring Gaussians in [rad]."""
        return 2.0 * self.center_span / (NODES - 1)

    def pack_network(self, joints: int = JOINTS) -> Array:
        """Return the network as numbers. Shape (6, n)."""
        block = np.zeros((NETWORK_ROWS, joints))
        block[SHARPNESS] = 0.5 / np.square(self.width)
        block[DECAY] = np.exp(-2.0 * block[SHARPNESS] * self.spacing**2)
        block[PHI], block[SIGMA], block[SPAN] = self.learning_rate, self.leakage, self.center_span
        block[INPUT] = INPUTS.index(self.network_input)
        return block

    def centers(self) -> Array:
        """Return the centres of the Gaussians in [rad]. Shape (10,)."""
        return np.linspace(-self.center_span, self.center_span, NODES)


@inlined
def gaussians(x, block, j, work):  # type: ignore[no-untyped-def]
    r"""Hidden outputs of one joint (Eq. 19), written to HIDDEN.

    The centres lie evenly, :math:`\delta` apart, so that each output follows from the one before
    by a factor that itself shrinks by a constant one: two exponentials do instead of ten.

    .. math:: \frac{h_{j+1}}{h_j} = e^{(2 d_j \delta - \delta^2) / 2 b^2}, \qquad
        d_j = x - c_j

    Args:
        x: input of the joint's network in [rad].
        block: numbers of ``NetworkGains.pack_network``. Shape (6, 6).
        j: which joint, from 0.
        work: workspace.
    """
    span, sharpness, decay = block[SPAN, 0], block[SHARPNESS, j], block[DECAY, j]
    spacing = 2.0 * span / (NODES - 1)
    distance, farthest = x + span, abs(x) + span
    if sharpness * farthest * farthest > STEEPEST:
        for n in range(NODES):
            work[HIDDEN + n, j] = exp(-sharpness * distance * distance)
            distance -= spacing
        return
    hidden = exp(-sharpness * distance * distance)
    factor = exp(sharpness * spacing * (2.0 * distance - spacing))
    for n in range(NODES):
        work[HIDDEN + n, j] = hidden
        hidden *= factor
        factor *= decay


@inlined
def network(block, state, work):  # type: ignore[no-untyped-def]
    r"""Output of the network and how fast learning would change it (Eq. 19-21).

    .. math:: h_j = \exp\frac{-(x - c_j)^2}{2 b^2}, \quad f_i = \sum_j W_{ji} h_{ji}, \quad
        \dot W_{ji} = \varphi_i h_{ji} S_i - \sigma_i W_{ji}

    Args:
        block: numbers of ``NetworkGains.pack_network``. Shape (6, 6).
        state: first row of the state whose weights count.
        work: workspace; writes HIDDEN, NETWORK [N m], NETWORK_SLOPE = phi * sum h^2, LEARNING,
            LEAKAGE.
    """
    source = block[INPUT, 0]
    for j in range(JOINTS):
        x = work[MEASURED_Q, j]
        if source == 0:
            x = work[QD, j] - x
        elif source == 2:
            x = work[QD, j]
        gaussians(x, block, j, work)
        work[NETWORK, j], work[NETWORK_SLOPE, j] = 0.0, 0.0
        work[LEARNING, j], work[LEAKAGE, j] = block[PHI, j], block[SIGMA, j]
    for n in range(NODES):
        for j in range(JOINTS):
            hidden = work[HIDDEN + n, j]
            work[NETWORK, j] += work[state + W + n, j] * hidden
            work[NETWORK_SLOPE, j] += block[PHI, j] * hidden * hidden


@kernel
def no_network(work):  # type: ignore[no-untyped-def]
    """Clear what ``network`` would have written: the law has none."""
    for j in range(JOINTS):
        work[NETWORK, j] = 0.0
        work[NETWORK_SLOPE, j] = 0.0
        work[LEARNING, j] = 0.0
        work[LEAKAGE, j] = 0.0
