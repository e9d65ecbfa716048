"""The closed loop with MuJoCo's own Python binding."""

from __future__ import annotations

import mujoco
import numpy as np

from tests.peers.controller import Controller
from tests.peers.numpy_loop import State, follow, held, plain, start
from tests.peers.problem import Array, MassAndBias, Problem, Run, Variant


def _arm(problem: Problem) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Load the arm without contacts and joint limits: the loop has none."""
    model = mujoco.MjModel.from_xml_path(problem.urdf)
    model.opt.timestep = problem.h
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    data = mujoco.MjData(model)
    data.qvel[:] = problem.v0
    return model, data


def mass_and_bias(problem: Problem) -> MassAndBias:
    """Return M and h by the position and velocity stages of ``mj_forward``."""
    model, data = _arm(problem)
    M = np.empty((model.nv, model.nv))

    def evaluate(q: Array, v: Array) -> tuple[Array, Array]:
        data.qpos[:], data.qvel[:] = q, v
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_fullM(model, data, M)
        return M, data.qfrc_bias

    return evaluate


def _plain(problem: Problem, steps: int) -> Run:
    return plain(problem, steps, mass_and_bias(problem))


def _slope_as_damping(problem: Problem, steps: int) -> Run:
    """Let ``mj_step`` take the linearly implicit step: the loop's slope is joint damping.

    MuJoCo's integrators are implicit in joint damping, not in a torque from outside. With the
    slope set as damping, Euler solves the very system of the plain scheme, in C.
    """
    model, data = _arm(problem)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
    controller, h = Controller(problem), problem.h

    def step(t: float, state: State) -> State:
        q, v, W = state
        answer = controller(t, q, v, W)
        damping, torque = controller.linearized(h, answer)
        model.dof_damping[:] = damping
        data.qfrc_applied[:] = torque + damping * v
        mujoco.mj_step(model, data)
        after = data.qvel.copy()
        return data.qpos, after, controller.learned(h, answer, (after - v) / h, W)

    return lambda: follow(problem, steps, start(problem), step)


def _held_torque(problem: Problem, steps: int) -> Run:
    """Step by ``mj_step`` with ``implicitfast``, which MuJoCo recommends for stiff models."""
    model, data = _arm(problem)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST

    def advance(torque: Array) -> tuple[Array, Array]:
        data.qfrc_applied[:] = torque
        mujoco.mj_step(model, data)
        return data.qpos, data.qvel

    return held(problem, steps, advance)


VARIANTS = (
    Variant("NumPy on `mj_fullM`, `qfrc_bias`", "plain", _plain),
    Variant("`mj_step`, Euler; the loop's slope as `dof_damping`", "plain", _slope_as_damping),
    Variant("`mj_step`, implicitfast; torque as `qfrc_applied`", "held", _held_torque),
)
VERSION = f"MuJoCo {mujoco.__version__}"
