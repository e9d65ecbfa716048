"""The set-valued sign at the end of a control period, against an independent solver."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import lsq_linear

from slidetune.robot.arm.arm import build_arm
from slidetune.robot.arm.section import Robot
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.workspace import CURVE, GAIN, PERIOD, REACH, S_V, WORK_ROWS, S
from slidetune.robot.laws.terms.implicit_switching import implicit_reach, implicit_reach_shaped
from slidetune.robot.laws.terms.switching import (
    IMPLICIT,
    K1,
    K2,
    SIGN,
    SWITCHING_CODE,
    ReachingGains,
    reach,
)

Array = np.ndarray
DRAWS = 300


def workspace(gains: ReachingGains, sliding: Array, slope: Array, period: float) -> Array:
    work = np.zeros((WORK_ROWS, JOINTS))
    work[S], work[S_V], work[PERIOD, 0] = sliding, slope, period
    reach(gains.pack_reaching(), work)
    return work


def unshaped(
    M: Array, gains: ReachingGains, sliding: Array, slope: Array, period: float
) -> tuple[Array, Array]:
    """Return the reaching torque and the sliding variable that it predicts."""
    work = workspace(gains, sliding, slope, period)
    implicit_reach(np.ascontiguousarray(M), work)
    torque = work[REACH].copy()
    return torque, sliding - period * slope * np.linalg.solve(M, torque)


def drawn(seed: int, reaching: str = "exponential") -> tuple[Array, ReachingGains, Array, Array]:
    """Draw an inertia, gains, a sliding variable and Γ; some gains and some S are 0."""
    random = np.random.default_rng(seed)
    if seed % 2:
        model = build_arm(Robot(armature=0.1 * random.integers(0, 2))).model
        M = pin.crba(model, model.createData(), random.uniform(-3.0, 3.0, JOINTS))
        M = np.triu(M) + np.triu(M, 1).T
    else:
        basis, _ = np.linalg.qr(random.normal(size=(JOINTS, JOINTS)))
        M = (basis * np.geomspace(1.0, 10.0 ** -random.uniform(0.0, 4.0), JOINTS)) @ basis.T
        M = 0.5 * (M + M.T)
    k1 = random.uniform(0.0, 200.0, JOINTS) * (random.random(JOINTS) < 0.7)
    k2 = 10.0 ** random.uniform(-1.0, 2.0, JOINTS) * (random.random(JOINTS) < 0.8)
    slope = 10.0 ** random.uniform(-1.0, 1.0, JOINTS)
    sliding = 10.0 ** random.uniform(-4.0, 1.0, JOINTS) * random.normal(size=JOINTS)
    sliding *= random.random(JOINTS) < 0.9
    gains = ReachingGains(k1=k1.tolist(), k2=k2.tolist(), switching="implicit", reaching=reaching)
    return M, gains, sliding, slope


def least_squares(
    M: Array, gains: ReachingGains, sliding: Array, slope: Array, period: float
) -> Array:
    """Return the reaching torque as the dual problem's: bounded least squares in (k₁S⁺, ξ)."""
    k1, k2 = np.array(gains.k1), np.array(gains.k2)
    if gains.reaching == "constant":
        k1 = np.zeros(JOINTS)
    A = M / period
    half = np.linalg.cholesky(np.linalg.inv(A)).T
    b = A @ (sliding / slope)
    stiff = k1 * slope
    rows = [np.hstack([half, half * k2])]
    lasting = np.divide(1.0, np.sqrt(stiff), out=np.zeros(JOINTS), where=stiff > 0.0)
    rows.append(np.hstack([np.diag(lasting), np.zeros((JOINTS, JOINTS))]))
    bound = np.concatenate([np.where(stiff > 0.0, np.inf, 1e-300), np.where(k2 > 0, 1.0, 1e-300)])
    scale = np.concatenate([np.where(stiff > 0.0, 1.0, 0.0), np.where(k2 > 0, 1.0, 0.0)])
    found = lsq_linear(
        np.vstack(rows) * scale,
        np.concatenate([half @ b, np.zeros(JOINTS)]),
        (-bound, bound),
        method="bvls",
        tol=1e-15,
        max_iter=1000,
    )
    p, xi = np.split(found.x * scale, 2)
    return p + k2 * xi


@pytest.mark.parametrize("reaching", ["exponential", "constant"])
def test_torque_is_that_of_an_independent_solver(reaching: str) -> None:
    for seed in range(DRAWS):
        M, gains, sliding, slope = drawn(seed, reaching)
        torque, _ = unshaped(M, gains, sliding, slope, 1e-3)
        expected = least_squares(M, gains, sliding, slope, 1e-3)
        size = max(1.0, float(np.abs(expected).max()))
        assert np.abs(torque - expected).max() < 1e-6 * size, seed


@pytest.mark.parametrize("period", [2e-4, 1e-3, 1e-2])
def test_torque_lies_in_the_law_of_the_sliding_variable_that_it_leads_to(period: float) -> None:
    for seed in range(DRAWS):
        M, gains, sliding, slope = drawn(seed)
        torque, end = unshaped(M, gains, sliding, slope, period)
        k1, k2 = np.array(gains.k1), np.array(gains.k2)
        switched, size = torque - k1 * end, np.abs(torque).max() + np.abs(k1 * sliding).max() + 1.0
        assert (np.abs(switched) <= k2 + 1e-8 * size).all(), seed
        moving = np.abs(end) > 1e-9 * np.abs(sliding).max()
        error = np.abs(switched - k2 * np.sign(end))[moving]
        assert (error <= 1e-8 * size).all(), seed


def test_shaped_law_is_the_closed_formula_and_a_saturation_of_width_period_times_k2() -> None:
    random = np.random.default_rng(5)
    for _ in range(DRAWS):
        period = 10.0 ** random.uniform(-3.5, -2.0)
        k1, k2 = random.uniform(0.0, 100.0, JOINTS), random.uniform(0.0, 50.0, JOINTS)
        k1[random.integers(JOINTS)] = k2[random.integers(JOINTS)] = 0.0
        gains = ReachingGains(k1=k1.tolist(), k2=k2.tolist(), switching="implicit")
        sliding = random.normal(size=JOINTS) * 2.0 * period * 25.0
        work = workspace(gains, sliding, np.ones(JOINTS), period)
        implicit_reach_shaped(work)
        layer = period * k2
        xi = np.clip(np.divide(sliding, layer, out=np.zeros(JOINTS), where=layer > 0.0), -1, 1)
        end = (sliding - layer * xi) / (1.0 + period * k1)
        np.testing.assert_allclose(work[REACH], k1 * end + k2 * xi, rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(end, sliding - period * work[REACH], atol=1e-14)


def test_gain_of_the_shaped_law_is_its_slope() -> None:
    gains = ReachingGains(k1=20.0, k2=10.0, switching="implicit")
    sliding = np.array([0.001, -0.005, 0.009, 0.02, -0.5, 3.0])

    def asked(s: Array) -> Array:
        work = workspace(gains, s, np.ones(JOINTS), 1e-3)
        implicit_reach_shaped(work)
        return work

    slope = (asked(sliding + 1e-7)[REACH] - asked(sliding - 1e-7)[REACH]) / 2e-7
    np.testing.assert_allclose(asked(sliding)[GAIN], slope, rtol=1e-6)


def test_joints_without_coupling_are_each_their_own_closed_formula() -> None:
    inertia = np.array([2.0, 1.0, 0.5, 0.2, 0.1, 0.05])
    gains = ReachingGains(k1=[5, 0, 9, 0, 2, 0], k2=[3, 0, 0, 4, 1, 2], switching="implicit")
    sliding, slope = np.array([0.1, -0.2, 0.3, 0.001, -0.004, 0.5]), np.full(JOINTS, 2.0)
    torque, _ = unshaped(np.diag(inertia), gains, sliding, slope, 1e-3)
    share = 1e-3 * slope / inertia
    k1, k2 = share * np.array(gains.k1), share * np.array(gains.k2)
    xi = np.clip(np.divide(sliding, k2, out=np.zeros(JOINTS), where=k2 > 0.0), -1.0, 1.0)
    end = (sliding - k2 * xi) / (1.0 + k1)
    expected = np.array(gains.k1) * end + np.array(gains.k2) * xi
    np.testing.assert_allclose(torque, expected, rtol=1e-10)


def test_without_gains_there_is_no_torque() -> None:
    M, _, sliding, slope = drawn(3)
    gains = ReachingGains(k1=0.0, k2=0.0, switching="implicit")
    assert not unshaped(M, gains, sliding, slope, 1e-3)[0].any()


def test_without_a_period_it_is_the_sign() -> None:
    for period, code in ((0.0, SIGN), (1e-3, IMPLICIT)):
        work = workspace(
            ReachingGains(switching="implicit"), np.ones(JOINTS), np.ones(JOINTS), period
        )
        assert work[CURVE + SWITCHING_CODE, 0] == code
        assert (work[CURVE + K1 : CURVE + K2 + 1] == 150.0).all()
