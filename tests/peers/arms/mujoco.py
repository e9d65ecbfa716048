"""The closed loop with MuJoCo's own Python binding."""

from __future__ import annotations

import mujoco
import numpy as np
from mujoco.rollout import Rollout

from tests.peers.controller import Controller
from tests.peers.numpy_loop import State, follow, held, plain, plain_step, start
from tests.peers.problem import (
    BATCH,
    SAMPLE,
    THREADS,
    Array,
    MassAndBias,
    Problem,
    Run,
    Trace,
    Variant,
)


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


def _applied(problem: Problem, steps: int) -> Array:
    """Return the torques by which the arm takes the way of the plain scheme. Shape (steps, 6)."""
    evaluate, torques = mass_and_bias(problem), np.empty((steps, 6))
    step, state = plain_step(problem, evaluate), start(problem)
    for n in range(steps):
        q, v, _ = state
        state = step(n * problem.h, state)
        M, bias = evaluate(q, v)
        torques[n] = M @ ((state[1] - v) / problem.h) + bias
    return torques


def _rollout(problem: Problem, steps: int) -> Run:
    """Replay what the closed loop applied: ``rollout`` takes torques, it knows no controller."""
    model, data = _arm(problem)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    whole = mujoco.mjtState.mjSTATE_FULLPHYSICS
    first = np.empty((BATCH, mujoco.mj_stateSize(model, whole)))
    mujoco.mj_getState(model, data, first[0], whole)
    first[:] = first[0]
    torques = np.tile(_applied(problem, steps), (BATCH, 1, 1))
    pool, places = Rollout(nthread=THREADS), [mujoco.MjData(model) for _ in range(THREADS)]
    applied = int(mujoco.mjtState.mjSTATE_QFRC_APPLIED)

    def run() -> Trace:
        states, _ = pool.rollout(model, places, first, torques, control_spec=applied)
        # A state is time, angles, velocities; its row n is that after step n.
        angles = states[0, SAMPLE - 1 :: SAMPLE, 1 : 1 + model.nq]
        return Trace(np.vstack([first[0, 1 : 1 + model.nq], angles]))

    return run


VARIANTS = (
    Variant("NumPy on `mj_fullM`, `qfrc_bias`", "plain", _plain),
    Variant("`mj_step`, Euler; the loop's slope as `dof_damping`", "plain", _slope_as_damping),
    Variant("`mj_step`, implicitfast; torque as `qfrc_applied`", "held", _held_torque),
)
BATCHES = (Variant("`rollout`, implicitfast; replays the torques of the loop", "open", _rollout),)
VERSION = f"MuJoCo {mujoco.__version__}"
