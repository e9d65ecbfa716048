"""The planar two-link arm of the textbooks, as an arm of six joints of which four stay alone.

Both links hang in gravity, which acts along -y at q = 0; the other joints are a unit of inertia
each. Numbers of OpenSMC's arm.
"""

from __future__ import annotations

from math import cos, sin

import numpy as np

from slidetune.robot.fields.quantity import JOINTS
from tests.peers.opensmc.tasks import Array

LINK = 1.0
"""Length of a link in [m] (*published*: OpenSMC's robot-arm benchmark)."""
CENTRE = 0.5
"""Distance of a link's centre of mass from its joint in [m] (*published*: default there)."""
MASS = 1.0
"""Of a link in [kg] (*published*: that benchmark)."""
TURNING = 0.083
"""Moment of inertia of a link about its centre of mass in [kg m^2] (*published*: as CENTRE)."""
GRAVITY = 9.81
"""In [m/s^2] (*published*: as CENTRE)."""


def inertia(q: Array) -> Array:
    r"""Return M [kg m^2] (Spong, Hutchinson and Vidyasagar 2006, Section 7.4). Shape (6, 6).

    .. math:: M_{22} = m l_c^2 + I, \quad M_{12} = M_{22} + m l l_c \cos q_2, \quad
        M_{11} = m (l_c^2 + l^2) + I + M_{22} + 2 m l l_c \cos q_2

    Args:
        q: joint angles in [rad]. Shape (6,).
    """
    M = np.eye(JOINTS)
    coupling = MASS * LINK * CENTRE * cos(q[1])
    M[1, 1] = MASS * CENTRE**2 + TURNING
    M[0, 1] = M[1, 0] = M[1, 1] + coupling
    M[0, 0] = MASS * (CENTRE**2 + LINK**2) + TURNING + M[1, 1] + 2.0 * coupling
    return M


def bias(q: Array, v: Array) -> Array:
    r"""Return h = C v + G [N m], from the same source. Shape (6,).

    .. math:: h_1 = -m l l_c \sin q_2 (2 v_1 v_2 + v_2^2) + (m l_c + m l) g \cos q_1 + h_g, \quad
        h_2 = m l l_c \sin q_2\, v_1^2 + h_g, \quad h_g = m l_c g \cos(q_1 + q_2)

    Args:
        q: joint angles in [rad]. Shape (6,).
        v: joint velocities in [rad/s]. Shape (6,).
    """
    h = np.zeros(JOINTS)
    swing = MASS * LINK * CENTRE * sin(q[1])
    outer = MASS * CENTRE * GRAVITY * cos(q[0] + q[1])
    h[0] = -swing * (2.0 * v[0] * v[1] + v[1] ** 2) + outer
    h[0] += MASS * (CENTRE + LINK) * GRAVITY * cos(q[0])
    h[1] = swing * v[0] ** 2 + outer
    return h


def rate(state: Array, torque: Array) -> Array:
    """Return how fast (q, v) changes under a torque [N m]. Shape (2, 6)."""
    q, v = state
    return np.array([v, np.linalg.solve(inertia(q), torque - bias(q, v))])


def held_step(state: Array, torque: Array, h: float) -> Array:
    """Return (q, v) after a step of h [s] of the classic Runge-Kutta method. Shape (2, 6)."""
    first = rate(state, torque)
    second = rate(state + 0.5 * h * first, torque)
    third = rate(state + 0.5 * h * second, torque)
    last = rate(state + h * third, torque)
    after: Array = state + h / 6.0 * (first + 2.0 * (second + third) + last)
    return after
