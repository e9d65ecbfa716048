"""The torque under which the sliding variable stands still, for laws that know the arm."""

from __future__ import annotations

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import AD, DRIFT, MEASURED_V, RIGHT, S_E, S_V, TAU, VD


@kernel
def equivalent_control(inertia, bias, work):  # type: ignore[no-untyped-def]
    r"""Equivalent control (Liu et al. 2025, Eq. 9, corrected), written to TAU [N m].

    .. math:: \tau_{eq} = M(\ddot q_d + \Gamma^{-1}(\nu\dot e + d)) + C\dot q + G, \qquad
        \Gamma = \partial S/\partial\dot e, \quad \nu = \partial S/\partial e

    with the rate d at which S changes apart from the motion, 0 in the paper. The paper prints the
    inverse of Gamma before M, under which S is not stationary.

    Args:
        inertia: M of the nominal arm. Shape (6, 6).
        bias: C v + G of the nominal arm. Shape (6,).
        work: workspace with the slopes of the surface.
    """
    for i in range(JOINTS):
        de = work[VD, i] - work[MEASURED_V, i]
        work[RIGHT, i] = work[AD, i] + (work[S_E, i] * de + work[DRIFT, i]) / work[S_V, i]
    for i in range(JOINTS):
        torque = bias[i]
        for j in range(JOINTS):
            torque += inertia[i, j] * work[RIGHT, j]
        work[TAU, i] = torque
