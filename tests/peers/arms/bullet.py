"""The closed loop with PyBullet."""

from __future__ import annotations

import re
import tempfile
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pybullet as bullet

from tests.peers.numpy_loop import held, plain
from tests.peers.problem import Array, MassAndBias, Problem, Run, Variant

GRAVITY = 9.81
"""Downwards, in [m/s^2]: Pinocchio's."""


def _load(problem: Problem) -> int:
    """Load the arm without shapes, which PyBullet can't read, and with the file's inertials."""
    bullet.resetSimulation()
    bullet.setGravity(0.0, 0.0, -GRAVITY)
    bullet.setTimeStep(problem.h)
    text = Path(problem.urdf).read_text(encoding="utf-8")
    bare = re.sub(r"<(visual|collision)\b.*?</\1>", "", text, flags=re.DOTALL)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arm.urdf"
        path.write_text(bare, encoding="utf-8")
        flags = bullet.URDF_USE_INERTIA_FROM_FILE
        arm: int = bullet.loadURDF(str(path), useFixedBase=True, flags=flags)
    return arm


if not bullet.isConnected():
    bullet.connect(bullet.DIRECT)


def mass_and_bias(problem: Problem) -> MassAndBias:
    """Return M and h by calculateMassMatrix and calculateInverseDynamics without acceleration."""
    arm, still = _load(problem), [0.0] * 6

    def evaluate(q: Array, v: Array) -> tuple[Array, Array]:
        angles = q.tolist()
        bias = bullet.calculateInverseDynamics(arm, angles, v.tolist(), still)
        return np.array(bullet.calculateMassMatrix(arm, angles)), np.array(bias)

    return evaluate


def _plain(problem: Problem, steps: int) -> Run:
    return plain(problem, steps, mass_and_bias(problem))


def _held_torque(problem: Problem, steps: int) -> Run:
    """Step by ``stepSimulation`` without the damping that PyBullet adds by itself."""
    arm, joints = _load(problem), list(range(6))
    for joint in joints:
        bullet.resetJointState(arm, joint, 0.0, problem.v0[joint])
        bullet.changeDynamics(
            arm, joint, linearDamping=0, angularDamping=0, jointDamping=0, maxJointVelocity=1e6
        )
    # The motors that hold every joint at first would brake it.
    bullet.setJointMotorControlArray(arm, joints, bullet.VELOCITY_CONTROL, forces=[0.0] * 6)

    def advance(torque: Array) -> tuple[Array, Array]:
        bullet.setJointMotorControlArray(arm, joints, bullet.TORQUE_CONTROL, forces=torque.tolist())
        bullet.stepSimulation()
        states = bullet.getJointStates(arm, joints)
        return np.array([s[0] for s in states]), np.array([s[1] for s in states])

    return held(problem, steps, advance)


VARIANTS = (
    Variant("NumPy on `calculateMassMatrix`, `calculateInverseDynamics`", "plain", _plain),
    Variant("`stepSimulation`, `TORQUE_CONTROL`", "held", _held_torque),
)
VERSION = f"PyBullet {version('pybullet')}"
