"""The linearly implicit step: its algebra, its order, its torque limits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.environment.layout import pack_environment
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.cutting import cutting_of
from slidetune.robot.integrator.implicit_solve import SOLVED
from slidetune.robot.integrator.implicit_step import (
    MAX_ANGLE,
    MAX_VELOCITY,
    accept,
    implicit_step,
    within_bounds,
)
from slidetune.robot.kernels.elimination import solve, solve_symmetric
from slidetune.robot.kernels.workspace import (
    AD,
    CURRENT,
    CURVE,
    CURVE_ROWS,
    DELIVERED,
    DRIFT,
    F_SLOPE,
    FULL,
    GAIN,
    HALF,
    HIDDEN,
    LEAKAGE,
    LEARNING,
    MATRIX,
    NETWORK,
    NETWORK_SLOPE,
    NODES,
    PERIOD,
    R_Q,
    RECORD,
    RIGHT,
    S_E,
    S_V,
    SHAPE,
    SHAPED,
    STATE_ROWS,
    TAU,
    VD,
    WORK_ROWS,
    F,
    Q,
    S,
    V,
    W,
)
from slidetune.robot.loop.lane import Lane

Array = np.ndarray
LAWS: dict[str, dict[str, Any]] = {
    "RBFNN-NFTSM": {"law": "rbfnn_nftsm"},
    "soft": {"law": "rbfnn_nftsm", "k1": 20.0, "k2": 20.0, "leakage": 1.0},
    "RBFNN-SMC": {"law": "rbfnn_smc"},
    "NFTSM": {"law": "nftsm"},
    "shaped": {"law": "nftsm", "inertia_shaped": True},
    "SMC": {"law": "smc"},
    "computed torque": {"law": "computed_torque"},
}


def limited(limits: Any = None) -> Array:
    """An environment without friction and with torque limits."""
    return pack_environment(Disturbance(), 0.0, 0.0, limits)


FREE = limited()


def inertia(random: np.random.Generator) -> Array:
    root = random.normal(size=(JOINTS, JOINTS))
    return root @ root.T + 0.01 * np.eye(JOINTS)


def evaluation(seed: int, shaped: bool = False) -> tuple[Array, Array, Array]:
    """Return a workspace as a law might leave it, an inertia, and a bias torque."""
    random = np.random.default_rng(seed)
    work = random.normal(size=(WORK_ROWS, JOINTS))
    for row in (S_V, S_E, GAIN, LEARNING, LEAKAGE):
        work[row] = random.uniform(0.1, 20.0, JOINTS)
    hidden = work[HIDDEN : HIDDEN + NODES]
    weights = work[CURRENT + W : CURRENT + W + NODES]
    work[NETWORK] = (hidden * weights).sum(axis=0)
    work[NETWORK_SLOPE] = work[LEARNING] * (hidden**2).sum(axis=0)
    M = inertia(random)
    # Only value and slope of the reaching law are known: it is a line.
    work[CURVE : CURVE + CURVE_ROWS] = 0.0
    work[SHAPED : PERIOD + 1] = 0.0
    work[SHAPED, 0] = float(shaped)
    work[SHAPE : SHAPE + JOINTS] = inertia(random) if shaped else np.nan
    return work, M, random.normal(size=JOINTS)


def published_step(work: Array, M: Array, bias: Array, h: float) -> Array:
    """Solve the documented equation of one step, written with matrices."""
    shaped = work[SHAPED, 0] != 0.0
    share = work[SHAPE : SHAPE + JOINTS] if shaped else np.eye(JOINTS)
    D, K = share * (work[GAIN] * work[S_V]), share * (work[GAIN] * work[S_E])
    B, H = np.diag(work[F_SLOPE]), work[NETWORK_SLOPE]
    s_v, s_e, lag = work[S_V], work[S_E], work[VD] - work[V]
    left = M + h * (D + B) + h**2 * (K + np.diag(H * s_v)) + h**3 * np.diag(H * s_e)
    ahead = s_v * work[AD] + s_e * lag + work[DRIFT]
    right = work[TAU] - bias - work[F] + h * share @ (work[GAIN] * ahead)
    right += h * H * (work[S] + h * ahead)
    right -= h * work[LEAKAGE] * work[NETWORK]
    return np.linalg.solve(left, right)


@pytest.mark.parametrize("seed", range(10))
def test_elimination_solves(seed: int) -> None:
    random = np.random.default_rng(seed)
    work = np.zeros((WORK_ROWS, JOINTS))
    matrix, right = inertia(random) + np.diag(random.uniform(0, 9, 6)), random.normal(size=JOINTS)
    for eliminate in (solve, solve_symmetric):
        work[MATRIX : MATRIX + JOINTS], work[RIGHT] = matrix, right
        eliminate(work)
        expected = np.linalg.solve(matrix, right)
        np.testing.assert_allclose(work[RIGHT], expected, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("shaped", [False, True])
@pytest.mark.parametrize("h", [1e-4, 1e-3, 5e-3])
def test_step_is_the_documented_equation(h: float, shaped: bool) -> None:
    for seed in range(20):
        work, M, bias = evaluation(seed, shaped)
        before, a = work.copy(), published_step(work, M, bias, h)
        implicit_step(h, CURRENT, FULL, M, bias, FREE, work)
        v = before[V] + h * a
        moved = before[S_V] * (before[AD] - a) + before[S_E] * (before[VD] - v)
        s = before[S] + h * (moved + before[DRIFT])
        weights = before[W : W + NODES]
        learned = before[LEARNING] * before[HIDDEN : HIDDEN + NODES] * s
        learned -= before[LEAKAGE] * weights
        np.testing.assert_allclose(work[FULL + V], v, rtol=1e-7, atol=1e-9)
        np.testing.assert_allclose(work[FULL + Q], before[Q] + h * v, rtol=1e-7, atol=1e-9)
        np.testing.assert_allclose(
            work[FULL + W : FULL + W + NODES], weights + h * learned, rtol=1e-6, atol=1e-8
        )
        np.testing.assert_array_equal(work[:STATE_ROWS], before[:STATE_ROWS])


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.parametrize("shaped", [False, True])
def test_torque_limits_hold_at_the_end_of_the_step(seed: int, shaped: bool) -> None:
    h, limits = 1e-3, np.array([5.0, 1.0, 3.0, 0.5, 0.2, 0.1])
    work, M, bias = evaluation(seed, shaped)
    work[TAU] *= 20.0
    work[F_SLOPE] = 0.0
    before = work.copy()
    left = implicit_step(h, CURRENT, FULL, M, bias, limited(tuple(limits)), work)
    if shaped and left > SOLVED:
        return  # said, and left to a shorter step
    assert left <= SOLVED
    a = (work[FULL + V] - before[V]) / h
    torque = M @ a + bias + before[F]
    asked = before[TAU] - h * before[LEAKAGE] * before[NETWORK]
    moved = before[S_V] * (before[AD] - a) + before[S_E] * (before[VD] - work[FULL + V])
    s_next = before[S] + h * (moved + before[DRIFT])
    share = before[SHAPE : SHAPE + JOINTS] if shaped else np.eye(JOINTS)
    asked += share @ (before[GAIN] * (s_next - before[S]))
    asked += h * before[NETWORK_SLOPE] * s_next
    room = SOLVED * np.diag(M) / h + 1e-7
    assert (np.abs(torque - np.clip(asked, -limits, limits)) <= room).all()
    assert np.isclose(np.abs(torque), limits).any() or (np.abs(asked) <= limits).all()


def test_torque_limits_hold_though_each_joint_drives_the_next_one_to_its_own() -> None:
    h, limits = 1e-3, 0.2 ** np.arange(JOINTS)
    work = np.zeros((WORK_ROWS, JOINTS))
    # Held stiffly, a joint is hardly moved by its neighbour: at its limit it gives way.
    work[TAU, 0], work[GAIN], work[S_V] = 1000.0, 1e6, 1.0
    M = np.eye(JOINTS) + 0.45 * (np.eye(JOINTS, k=1) + np.eye(JOINTS, k=-1))
    assert (
        implicit_step(h, CURRENT, FULL, M, np.zeros(JOINTS), limited(tuple(limits)), work) <= SOLVED
    )
    torque = M @ (work[FULL + V] / h)
    np.testing.assert_allclose(np.abs(torque[1:]), limits[1:], rtol=1e-6)
    assert abs(torque[0]) <= 1.0 + 1e-9


def test_wide_limits_change_nothing() -> None:
    work, M, bias = evaluation(3)
    other = work.copy()
    implicit_step(1e-3, CURRENT, FULL, M, bias, FREE, work)
    implicit_step(1e-3, CURRENT, FULL, M, bias, limited(1e9), other)
    np.testing.assert_array_equal(work[FULL:HALF], other[FULL:HALF])


def error_of(lane: dict[str, Any], scheme: str, step: float) -> float:
    """Return the greatest difference of the angles from a run at a twentieth of the step."""

    def angles(scheme: str, step: float) -> Array:
        simulation = {"step": step, "scheme": scheme}
        document = {"lanes": {"A": lane}, "simulation": simulation}
        packed = pack(Experiment.from_document(document))
        rows = round(0.4 / step) + 1
        # The scheme alone: no step is cut.
        alone = Lane("A", packed, np.zeros((rows, len(RECORD), JOINTS)), cutting_of(halvings=0))
        for row in range(rows):
            assert alone.step(row * step, row, row) == 0
        return alone.record[:: round(0.02 / step), R_Q]

    return float(np.abs(angles(scheme, step) - angles("extrapolated", 1e-4)).max())


@pytest.mark.parametrize("name", LAWS)
def test_plain_scheme_is_of_first_order(name: str) -> None:
    ratio = error_of(LAWS[name], "plain", 0.002) / error_of(LAWS[name], "plain", 0.001)
    assert 1.7 < ratio < 2.3


@pytest.mark.parametrize("name", LAWS)
def test_extrapolated_scheme_is_of_second_order(name: str) -> None:
    coarse, fine = (error_of(LAWS[name], "extrapolated", step) for step in (0.002, 0.001))
    assert 3.3 < coarse / fine < 4.7


def test_without_a_lag_the_torques_of_drives_are_left_alone() -> None:
    work = np.zeros((WORK_ROWS, JOINTS))
    work[FULL : FULL + 2 * STATE_ROWS] = 1.0
    for extrapolated in (False, True):
        assert accept(extrapolated, False, work) == 0
        assert (work[CURRENT : CURRENT + DELIVERED] == 1.0).all()
        assert not work[CURRENT + DELIVERED : CURRENT + STATE_ROWS].any()


def test_extrapolation_cancels_the_first_order() -> None:
    full, half = np.random.default_rng(4).normal(size=(2, STATE_ROWS, JOINTS))
    work = np.zeros((WORK_ROWS, JOINTS))
    work[FULL:HALF], work[HALF : HALF + STATE_ROWS] = full, half
    assert accept(True, True, work) == 0
    np.testing.assert_array_equal(work[CURRENT : CURRENT + STATE_ROWS], 2.0 * half - full)
    work[FULL:HALF] = full
    assert accept(False, True, work) == 0
    np.testing.assert_array_equal(work[CURRENT : CURRENT + STATE_ROWS], full)


@pytest.mark.parametrize(
    ("row", "value"),
    [
        (Q, 1.01 * MAX_ANGLE),
        (Q, -1.01 * MAX_ANGLE),
        (V, 1.01 * MAX_VELOCITY),
        (Q, np.nan),
        (V, np.inf),
        (V, -np.inf),
        (W, np.nan),
        (W + NODES - 1, np.inf),
    ],
)
@pytest.mark.parametrize("joint", [0, 5])
def test_a_state_out_of_bounds_is_refused_and_the_current_one_kept(
    row: int, value: float, joint: int
) -> None:
    work = np.zeros((WORK_ROWS, JOINTS))
    work[CURRENT + Q] = 0.5
    assert within_bounds(CURRENT, work) == 0
    work[FULL + row, joint] = value
    assert within_bounds(FULL, work) == joint + 1
    assert accept(False, False, work) == joint + 1
    assert (work[CURRENT + Q] == 0.5).all()
    assert (work[CURRENT + V : FULL] == 0.0).all()
