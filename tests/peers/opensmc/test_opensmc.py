"""Our side of the comparison with OpenSMC: the arm is the textbooks', the laws are the loop's."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp

from slidetune.robot.kernels.workspace import AD, QD, VD, WORK_ROWS
from slidetune.robot.motion.trajectory import pack_trajectory, reference
from tests.peers.environments import is_ready
from tests.peers.opensmc import ours
from tests.peers.opensmc.__main__ import AGREEMENT, OPENSMC, Difference, differences, their_runs
from tests.peers.opensmc.pairs import PAIRS
from tests.peers.opensmc.tasks import STEP, TASKS, Array, push
from tests.peers.opensmc.two_link import CENTRE, GRAVITY, LINK, MASS, TURNING, bias, inertia, rate

SECONDS = 0.05


def two_links() -> pin.Model:
    """The same arm by Pinocchio, in the plane x, y."""
    model = pin.Model()
    model.gravity.linear = np.array([0.0, -GRAVITY, 0.0])
    parent = 0
    for number in range(2):
        place = pin.SE3(np.eye(3), np.array([LINK * number, 0.0, 0.0]))
        parent = model.addJoint(parent, pin.JointModelRZ(), place, f"joint{number + 1}")
        body = pin.Inertia(MASS, np.array([CENTRE, 0.0, 0.0]), np.diag([0.0, 0.0, TURNING]))
        model.appendBodyToJoint(parent, body, pin.SE3.Identity())
    return model


@pytest.mark.parametrize("seed", range(5))
def test_the_two_link_arm_is_that_of_pinocchio_and_the_other_joints_are_alone(seed: int) -> None:
    dice, model = np.random.default_rng(seed), two_links()
    q, v = dice.uniform(-3.0, 3.0, (2, 6))
    data = model.createData()
    M = np.eye(6)
    M[:2, :2] = np.triu(pin.crba(model, data, q[:2])) + np.triu(data.M, 1).T
    h = np.zeros(6)
    h[:2] = pin.nonLinearEffects(model, data, q[:2], v[:2])
    np.testing.assert_allclose(inertia(q), M, atol=1e-13)
    np.testing.assert_allclose(bias(q, v), h, atol=1e-12)


@pytest.mark.parametrize("key", TASKS)
def test_the_desired_motion_is_the_same_on_both_sides(key: str) -> None:
    packed, work = pack_trajectory(ours.TRAJECTORIES[key]), np.zeros((WORK_ROWS, 6))
    for t in np.linspace(0.0, 5.0, 50):
        reference(t, packed, work)
        np.testing.assert_allclose(work[[QD, VD, AD], :2], TASKS[key].desired(t), atol=1e-14)
        assert not work[[QD, VD, AD], 2:].any()


@pytest.mark.parametrize("name", ["SMC: constant, saturation", "super-twisting"])
def test_the_arm_moves_as_scipy_says_under_the_same_torques(name: str) -> None:
    found = ours.run(PAIRS[name].ours, "follow", SECONDS)
    state = found[0, :4].copy()
    for number, row in enumerate(found):
        np.testing.assert_allclose(row[:4], state, atol=1e-11)
        torque = np.zeros(6)
        torque[:2] = row[4:] + push(number * STEP)

        def change(_t: float, y: Array, torque: Array = torque) -> Array:
            both = np.zeros((2, 6))
            both[:, :2] = y.reshape(2, 2)
            return rate(both, torque)[:, :2].ravel()

        solution = solve_ivp(change, (0.0, STEP), state, "DOP853", rtol=1e-12, atol=1e-14)
        state = solution.y[:, -1]


def test_a_computed_torque_is_that_of_its_equation() -> None:
    gains = PAIRS["computed torque PD"].ours
    found, task = ours.run(gains, "follow", SECONDS), TASKS["follow"]
    for number, row in enumerate(found):
        q, v = np.zeros((2, 6))
        q[:2], v[:2] = row[:2], row[2:4]
        q_d, v_d, a_d = task.desired(number * STEP)
        a = a_d + gains["kd"] * (v_d - row[2:4]) + gains["kp"] * (q_d - row[:2])
        asked = (inertia(q)[:2, :2] @ a) + bias(q, v)[:2]
        np.testing.assert_allclose(row[4:], asked, atol=1e-11)


def test_every_pair_has_gains_that_a_lane_takes_and_runs() -> None:
    for pair in PAIRS.values():
        for key in pair.tasks:
            found = ours.run(pair.ours, key, 0.01)
            assert np.isfinite(found).all()
            assert np.abs(found[:, 4:]).max() > 0.1


@pytest.mark.parametrize(("angle", "torque"), [(2e-6, 0.0), (0.0, 2e-6), (np.nan, 0.0)])
def test_what_differs_by_more_than_agreed_is_not_the_same_law(angle: float, torque: float) -> None:
    assert Difference("", AGREEMENT, AGREEMENT).agrees
    assert not Difference("", angle, torque).agrees


def test_laws_that_opensmc_has_are_the_same_there() -> None:
    if not is_ready(OPENSMC):
        pytest.skip("OpenSMC is not installed: make opensmc")
    _, theirs = their_runs(SECONDS)
    found = list(differences(theirs, SECONDS))
    assert [one.name for one in found] == list(PAIRS)
    assert [one.name for one in found if not one.agrees] == []
