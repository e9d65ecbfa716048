"""What surrounds a law's torque in every mode."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.arm.arm import build_model
from slidetune.robot.arm.dynamics import dynamics
from slidetune.robot.arm.section import Robot
from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.environment.layout import LIMIT, pack_environment
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.stages import command, observe, plant_step, write_record
from slidetune.robot.kernels.workspace import (
    APPLIED,
    HIDDEN,
    LEAKAGE,
    LEARNING,
    MEASURED_Q,
    MEASURED_V,
    NETWORK,
    NODES,
    PUSH,
    QD,
    R_TAU,
    RECORD,
    TAU,
    VD,
    WORK_ROWS,
    Q,
    S,
    V,
    W,
)
from slidetune.robot.loop.lane import Lane
from slidetune.robot.motion.trajectory import HoldTrajectory, pack_trajectory
from tests.robot.kernel_tables import arm_of, table_of

Array = np.ndarray


def fall(step: float, viscous: float = 0.0, torque: float = 0.0) -> tuple[Array, Array]:
    """Let the arm go; return its energy [J] at every step and the last workspace."""
    model = build_model(Robot())
    data = model.createData()
    environment = pack_environment(Disturbance(), viscous, 0.0, None)
    work = np.zeros((WORK_ROWS, JOINTS))
    work[Q], work[APPLIED] = (0.1, 0.9, -0.4, 0.3, 0.8, 0.2), torque
    arm = dynamics(model, work[Q], work[V])
    table = table_of(work, arm=arm, environment=environment, step=step)
    energy = []
    for number in range(round(0.2 / step)):
        q, v = work[Q].copy(), work[V].copy()
        energy.append(pin.computeMechanicalEnergy(model, data, q, v))
        arm.refill()
        assert plant_step(number * step, table) == 0
    return np.array(energy), work


def test_free_fall_keeps_its_energy_to_first_order_of_the_step() -> None:
    drifts = [np.abs(fall(step)[0] - fall(step)[0][0]).max() for step in (2e-3, 1e-3, 5e-4)]
    kinetic = pin.computeKineticEnergy(
        build_model(Robot()), build_model(Robot()).createData(), *fall(5e-4)[1][[Q, V]].copy()
    )
    assert kinetic > 10.0
    assert drifts[2] < 0.05 * kinetic
    assert drifts[0] / drifts[1] == pytest.approx(2.0, rel=0.25)
    assert drifts[1] / drifts[2] == pytest.approx(2.0, rel=0.25)


def test_viscous_friction_takes_energy_away() -> None:
    energy, _ = fall(5e-4, viscous=20.0)
    assert energy[-1] < energy[0] - 1.0
    assert (np.diff(energy)[5:] < 1e-6).all()


def test_plant_step_leaves_the_weights() -> None:
    work = np.zeros((WORK_ROWS, JOINTS))
    work[W : W + NODES] = 7.0
    table = table_of(work, arm=arm_of(np.eye(JOINTS), np.ones(JOINTS)), step=1e-3)
    assert plant_step(0.0, table) == 0
    assert (work[W : W + NODES] == 7.0).all()
    np.testing.assert_allclose(work[V], -1e-3)
    np.testing.assert_allclose(work[Q], -1e-6)


def test_network_learns_once_a_control_period() -> None:
    random = np.random.default_rng(1)
    work, record = np.zeros((WORK_ROWS, JOINTS)), np.zeros((2, len(RECORD), JOINTS))
    hidden, weights = random.normal(size=(2, NODES, JOINTS))
    work[HIDDEN : HIDDEN + NODES], work[W : W + NODES] = hidden, weights
    work[S], work[LEARNING], work[LEAKAGE] = random.normal(size=JOINTS), 3.0, 2.0
    assert command(1, table_of(work, record=record, period=0.004)) == 0
    expected = weights + 0.004 * (3.0 * hidden * work[S] - 2.0 * weights)
    np.testing.assert_allclose(work[W : W + NODES], expected, rtol=1e-12)


def test_a_command_is_limited_before_it_is_held_and_recorded() -> None:
    work, record = np.zeros((WORK_ROWS, JOINTS)), np.zeros((1, len(RECORD), JOINTS))
    limits = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    environment = pack_environment(Disturbance(), 0.0, 0.0, limits)
    np.testing.assert_array_equal(environment[LIMIT], limits)
    work[TAU] = (-9, 9, 2, -2, 9, -9)
    assert command(0, table_of(work, environment=environment, record=record, period=0.001)) == 0
    expected = (-1, 2, 2, -2, 5, -6)
    np.testing.assert_array_equal(work[TAU], expected)
    np.testing.assert_array_equal(record[0, R_TAU], expected)


@pytest.mark.parametrize("value", [np.nan, np.inf, -1e13])
def test_a_torque_that_is_no_number_names_its_joint(value: float) -> None:
    work = np.zeros((WORK_ROWS, JOINTS))
    work[TAU, 3] = value
    assert command(0, table_of(work, period=0.001)) == 4


def test_a_record_holds_the_columns_that_it_names() -> None:
    packed = pack(Experiment.from_document({"simulation": {"mode": "sampled"}}))
    lane = Lane("RBFNN-NFTSM", packed, np.zeros((40, len(RECORD), JOINTS)))
    for number in range(30):
        lane.step(number * 1e-3, number, number)
    q, v, weights = (lane.work[rows].copy() for rows in (Q, V, slice(W, W + NODES)))
    lane.step(0.03, 30, 30)
    found = dict(zip(RECORD, lane.record[30], strict=True))
    np.testing.assert_array_equal(found["q"], q)
    np.testing.assert_array_equal(found["v"], v)
    np.testing.assert_allclose(found["weights"], np.linalg.norm(weights, axis=0), rtol=1e-12)
    assert (found["weights"] > 0.0).all()
    for name, row in (("tau", TAU), ("S", S), ("f", NETWORK), ("q_d", QD), ("v_d", VD)):
        np.testing.assert_array_equal(found[name], lane.work[row], err_msg=name)


def test_a_record_is_of_the_current_state_and_of_its_own_row() -> None:
    work = np.random.default_rng(3).normal(size=(WORK_ROWS, JOINTS))
    record = np.zeros((3, len(RECORD), JOINTS))
    environment = pack_environment(Disturbance(), 0.0, 0.0, 1.0)
    work[TAU] = (-9.0, 9.0, 0.5, -0.5, 1.0, 2.0)
    write_record(1, 1, environment, work, record)
    weights = np.linalg.norm(work[W : W + NODES], axis=0)
    expected = (work[Q], work[V], np.clip(work[TAU], -1.0, 1.0), work[S], work[NETWORK], weights)
    found = record[1]
    np.testing.assert_allclose(found, (*expected, work[QD], work[VD]), rtol=1e-14)
    assert not record[[0, 2]].any()


@pytest.mark.parametrize("step", [1e-4, 5e-3])
def test_a_step_of_the_arm_is_linearly_implicit_in_its_friction(step: float) -> None:
    random = np.random.default_rng(6)
    root = random.normal(size=(JOINTS, JOINTS))
    M, bias = root @ root.T + np.eye(JOINTS), random.normal(size=JOINTS)
    work = random.normal(size=(WORK_ROWS, JOINTS))
    viscous = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    environment = pack_environment(Disturbance(constant=0.7), viscous, 0.0, None)
    q, v, push, applied = (work[row].copy() for row in (Q, V, PUSH, APPLIED))
    assert (
        plant_step(0.0, table_of(work, arm=arm_of(M, bias), environment=environment, step=step))
        == 0
    )
    lost = bias + 0.7 + np.multiply(viscous, v) - push
    faster = v + step * np.linalg.solve(M + step * np.diag(viscous), applied - lost)
    np.testing.assert_allclose(work[V], faster, rtol=1e-9)
    np.testing.assert_allclose(work[Q], q + step * faster, rtol=1e-9)


def test_a_controller_sees_the_state_as_it_is_without_noise() -> None:
    work = np.random.default_rng(2).normal(size=(WORK_ROWS, JOINTS))
    pose = HoldTrajectory(position=(0.1, 0.2, 0.3, 0.4, 0.5, 0.6))
    observe(3.0, 7, table_of(work, trajectory=pack_trajectory(pose)))
    np.testing.assert_array_equal(work[MEASURED_Q], work[Q])
    np.testing.assert_array_equal(work[MEASURED_V], work[V])
    np.testing.assert_allclose(work[QD], pose.position)
