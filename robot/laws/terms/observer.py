r"""Disturbance observer: what the arm loses to the world, from how it moved under the torque.

The generalised momentum observer (De Luca and Mattone 2005),

.. math:: r = K_o \left[p - p_0 - \int (\tau + C^T\dot q - G + r)\,dt\right], \qquad
    \dot r = K_o\,(M\ddot q + C\dot q + G - \tau - r)

since :math:`\dot p = M\ddot q + \dot M\dot q` and :math:`\dot M = C + C^T`: with an exact model r
goes to -F with the time constant 1/K_o. Time-delay estimation (Youcef-Toumi and Ito 1990; Hsia and
Gao 1990) is its limit of an endless K_o: what the period before was short of. Fed forward, an error
of the model acts like a gain: that one is stable where :math:`\|I - M^{-1}\bar M\| < 1`.
"""

from __future__ import annotations

from math import exp
from typing import Literal

import numpy as np

from slidetune.robot.fields.quantity import JOINTS, PerJoint, Section, field
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import (
    COMMAND,
    MEASURED_V,
    NETWORK,
    OBSERVED,
    PERIOD,
    RIGHT,
    TAU,
    W,
)

Array = np.ndarray

Observer = Literal["none", "momentum", "time_delay"]
OBSERVERS: tuple[Observer, ...] = ("none", "momentum", "time_delay")
NONE, MOMENTUM, TIME_DELAY = 0, 1, 2

RATE, KIND = 0, 1
OBSERVER_ROWS = 2
"""Rows of its gains."""

# Rows of its memory, below the law's own: r [N m]; of the control period before, velocity [rad/s],
# C v + G less the torque [N m], and its length [s], 0 where there was none.
LOSS, LAST_V, UNDRIVEN, SPAN = range(4)
OBSERVER_MEMORY = 4


class ObserverGains(Section):
    """Disturbance observer of a law with a model."""

    observer: Observer = field(
        "none",
        title="Disturbance observer",
        group="Observer",
        meaning="Adds an estimate of F to the torque, so that k₂ need not reject it: momentum, "
        "which follows F at the rate K_o, or time_delay, what the period before was short of.",
    )
    observer_rate: PerJoint = field(
        50.0,
        title="Observer rate",
        symbol="K_o",
        unit="1/s",
        low=0.1,
        high=2000.0,
        step=1.0,
        scale="log",
        group="Observer",
        needs={"observer": ("momentum",)},
        meaning="The estimate follows F with the time constant 1/K_o; a higher one amplifies "
        "noise of the measured velocity.",
    )

    def pack_observer(self, joints: int = JOINTS) -> Array:
        """Return rate and kind as numbers. Shape (2, n)."""
        block = np.empty((OBSERVER_ROWS, joints))
        block[RATE], block[KIND] = self.observer_rate, OBSERVERS.index(self.observer)
        return block


@kernel
def observe_loss(block, state, own, inertia, work):  # type: ignore[no-untyped-def]
    r"""Subtract the estimate r of -F from TAU and add -r, that of F, to NETWORK [N m].

    Sampled, over the period T before this one, with :math:`a = 1 - e^{-K_o T}`:

    .. math:: r = (1 - a)\,r_{k-1}
        + a\,[M\,(\dot q - \dot q_{k-1}) / T + (C\dot q + G - \tau)_{k-1}]

    Args:
        block: numbers of ``ObserverGains.pack_observer``. Shape (2, 6).
        state: first row of the state whose memory counts.
        own: how many rows of that are the law's own.
        inertia: M of the nominal arm. Shape (6, 6).
        work: workspace with the measured velocity and the law's torque.
    """
    memory, period = state + W + own, work[PERIOD, 0]
    for i in range(JOINTS):
        loss, span = work[memory + LOSS, i], work[memory + SPAN, i]
        if period > 0.0 and span > 0.0:
            change = 0.0
            for j in range(JOINTS):
                change += inertia[i, j] * (work[MEASURED_V, j] - work[memory + LAST_V, j])
            share = 1.0 if block[KIND, 0] == TIME_DELAY else 1.0 - exp(-block[RATE, i] * span)
            loss += share * (change / span + work[memory + UNDRIVEN, i] - loss)
        work[OBSERVED, i] = loss
        work[NETWORK, i] -= loss
        work[TAU, i] -= loss


@kernel
def advance_observer(h, block, into, own, inertia, bias, work):  # type: ignore[no-untyped-def]
    r"""Move its memory on by a step of continuous mode or a control period.

    In continuous mode an implicit Euler step with the acceleration a and the torque at its end:

    .. math:: r_1 = \frac{r + h K_o\,(M a + C\dot q + G - \tau_1)}{1 + h K_o}

    Args:
        h: step or control period in [s].
        block: numbers of ``ObserverGains.pack_observer``. Shape (2, 6).
        into: first row of the state after it; the current one in sampled mode.
        own: how many rows of its memory are the law's own.
        inertia: M of the nominal arm. Shape (6, 6).
        bias: C v + G of the nominal arm. Shape (6,).
        work: workspace with the solved step and the limited torque: COMMAND, or sampled TAU.
    """
    memory, sampled = into + W + own, work[PERIOD, 0] > 0.0
    for i in range(JOINTS):
        loss, v, undriven = work[OBSERVED, i], 0.0, 0.0
        if sampled:
            v, undriven = work[MEASURED_V, i], bias[i] - work[TAU, i]
        else:
            missing = bias[i] - work[COMMAND, i]
            for j in range(JOINTS):
                missing += inertia[i, j] * work[RIGHT, j]
            stiff = h * block[RATE, i]
            loss = (loss + stiff * missing) / (1.0 + stiff)
            loss = missing if block[KIND, 0] == TIME_DELAY else loss
        work[memory + LOSS, i], work[memory + LAST_V, i] = loss, v
        work[memory + UNDRIVEN, i], work[memory + SPAN, i] = undriven, h if sampled else 0.0
