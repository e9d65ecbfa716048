"""The closed loop with the Robotics Toolbox for Python."""

from __future__ import annotations

from math import pi

import numpy as np
from roboticstoolbox import DHRobot, ERobot, RevoluteDH
from roboticstoolbox import __version__ as toolbox_version
from roboticstoolbox.models.URDF.URDFRobot import URDF_read

from tests.peers.numpy_loop import plain
from tests.peers.problem import Array, MassAndBias, Problem, Run, Variant

DH = (
    (0.12015, 0.0, pi / 2),
    (0.0, 0.43, 0.0),
    (0.0, 0.3685, 0.0),
    (-0.114, 0.0, pi / 2),
    (0.1135, 0.0, -pi / 2),
    (0.107, 0.0, 0.0),
)
"""d [m], a [m] and alpha [rad] of the arm, joint by joint (*vendor*)."""


def _described(problem: Problem) -> ERobot:
    links, name, *_ = URDF_read(problem.urdf)
    return ERobot(links, name=name)


def _described_dynamics(problem: Problem) -> MassAndBias:
    robot, still = _described(problem), np.zeros(6)
    return lambda q, v: (robot.inertia(q), robot.rne(q, v, still))


def _denavit_hartenberg(problem: Problem) -> DHRobot:
    """Return the same arm by Denavit-Hartenberg parameters, whose rne() is written in C."""
    source = _described(problem)
    bodies = [link for link in source.links if link.isjoint]
    bare = DHRobot([RevoluteDH(d=d, a=a, alpha=alpha) for d, a, alpha in DH])
    place, links = np.eye(4), []
    for joint, body in enumerate(bodies):
        place = place @ bare.links[joint].A(0.0).A
        described = source.fkine(np.zeros(6), end=body).A
        turn = np.linalg.inv(place) @ described
        R, p = turn[:3, :3], turn[:3, 3]
        d, a, alpha = DH[joint]
        links.append(
            RevoluteDH(d=d, a=a, alpha=alpha, m=body.m, r=R @ body.r + p, I=R @ body.I @ R.T)
        )
    return DHRobot(links)


def mass_and_bias(problem: Problem) -> MassAndBias:
    """Return M and h by one call of rne() in C: no acceleration, then six unit ones."""
    robot = _denavit_hartenberg(problem)
    velocities, unit = np.zeros((8, 6)), np.vstack([np.zeros((2, 6)), np.eye(6)])

    def evaluate(q: Array, v: Array) -> tuple[Array, Array]:
        velocities[0] = v
        torques = robot.rne(np.tile(q, (8, 1)), velocities, unit)
        return torques[2:] - torques[1], torques[0]

    return evaluate


def _plain(problem: Problem, steps: int) -> Run:
    return plain(problem, steps, mass_and_bias(problem))


def _plain_described(problem: Problem, steps: int) -> Run:
    return plain(problem, steps, _described_dynamics(problem))


VARIANTS = (
    Variant("NumPy on `rne` of a `DHRobot`, in C", "plain", _plain),
    Variant("NumPy on `inertia`, `rne` of the URDF, in Python", "plain", _plain_described),
)
VERSION = f"Robotics Toolbox {toolbox_version}"
