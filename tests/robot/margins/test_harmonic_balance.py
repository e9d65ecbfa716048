"""The limit cycle by harmonic balance, against scalar loops written without our code."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.margins.harmonic_balance import limit_cycles
from slidetune.robot.margins.switching_loop import SwitchingLoop
from slidetune.robot.margins.switching_term import SwitchingTerm
from tests.robot.margins.scalar_loop import Scalar, run, swing

Array = np.ndarray

ONE = np.array([1e-3])
SIGN = SwitchingTerm.within("sign", np.ones(JOINTS))
CASES = [
    Scalar(2.0, 0.001, lag=0.002, lags=2),
    Scalar(2.0, 0.001, lag=0.004, lags=2),
    Scalar(2.0, 0.001, lag=0.01, lags=2, delay=0.001),
    Scalar(2.0, 0.001, lag=0.005, lags=1, delay=0.003),
    Scalar(2.0, 0.001, lag=0.01, lags=1, delay=0.002),
    Scalar(2.0, 0.004, lag=0.01, lags=2),
    Scalar(2.0, 0.004, lag=0.01, lags=1, delay=0.003),
    Scalar(30.0, 0.00025, lag=0.001, lags=2, delay=0.0005),
]


def six(loop: Scalar, coupling: float = 0.0) -> SwitchingLoop:
    """Six scalar loops as those of six joints; the first two may act on each other."""
    lags, size = (loop.lags if loop.lag else 0), (1 + (loop.lags if loop.lag else 0)) * JOINTS
    one = np.eye(JOINTS)
    own, torque = np.zeros((size, size)), np.zeros((size, JOINTS))
    gain = one.copy()
    gain[0, 1] = gain[1, 0] = coupling
    blocks = [slice(k * JOINTS, (k + 1) * JOINTS) for k in range(1 + lags)]
    if lags:
        own[blocks[0], blocks[1]] = -loop.kappa * gain
        for here, source in zip(blocks[1:], [*blocks[2:], None], strict=True):
            own[here, here] = -one / loop.lag
            if source is None:
                torque[here] = one / loop.lag
            else:
                own[here, source] = one / loop.lag
    else:
        torque[blocks[0]] = -loop.kappa * gain
    return SwitchingLoop(
        own=own,
        torque=torque,
        rest=np.zeros((JOINTS, size)),
        proportional=np.zeros((JOINTS, size)),
        gain=one,
        surface=np.eye(JOINTS, size),
        delay=loop.delay + 0.5 * loop.period,
        hold=loop.period,
        fastest=np.pi / loop.period,
        kappa=np.full(JOINTS, loop.kappa),
        load=np.zeros(JOINTS),
    )


def test_two_equal_lags_have_the_limit_cycle_of_the_textbook() -> None:
    lag, kappa = 0.005, 3.0
    continuous = replace(six(Scalar(kappa, 1e-5, lag, 2)), delay=0.0, hold=0.0)
    for cycle in limit_cycles(continuous, SIGN):
        assert cycle is not None
        assert cycle.omega == pytest.approx(1.0 / lag, rel=2e-3)
        # The third harmonic, a 45th of the first, is in the whole swing.
        assert cycle.amplitude == pytest.approx(2.0 * kappa * lag / np.pi, rel=0.03)
        assert cycle.crossing == pytest.approx(0.5 * kappa * lag, rel=2e-3)


@pytest.mark.parametrize("count", [0, 1])
def test_a_loop_that_never_turns_by_half_a_circle_has_no_limit_cycle(count: int) -> None:
    loop = Scalar(3.0, 1e-5, 0.005 * count, 1)
    continuous = replace(six(loop), delay=0.0, hold=0.0)
    assert limit_cycles(continuous, SIGN) == (None,) * JOINTS


@pytest.mark.parametrize("case", CASES)
def test_sign_swings_as_fast_and_as_far_as_predicted(case: Scalar) -> None:
    frequency, amplitude = swing(run(case, np.sign, 3.0, ONE)[:, 0], case.period)
    cycle = limit_cycles(six(case), SIGN)[2]
    assert cycle is not None
    assert cycle.omega / (2.0 * np.pi) == pytest.approx(frequency, rel=0.1)
    assert cycle.amplitude == pytest.approx(amplitude, rel=0.25)
    assert cycle.slowest < 2.0 * np.pi * frequency < cycle.fastest


@pytest.mark.parametrize("case", CASES)
def test_super_twisting_swings_as_fast_and_as_far_as_predicted(case: Scalar) -> None:
    unit = case._replace(kappa=1.0, disturbance=0.0)
    roots, rates = np.array([15.0, 5.0, 30.0]), np.array([110.0, 110.0, 50.0])
    z = np.zeros(3)

    def twist(S: Array) -> Array:
        torque = roots * np.sqrt(np.abs(S)) * np.sign(S) + z
        z[:] += unit.period * rates * np.sign(S)
        return np.asarray(torque)

    runs = run(unit, twist, 6.0, np.full(3, 1e-3)).T
    for S, root, rate in zip(runs, roots, rates, strict=True):
        frequency, _ = swing(S, unit.period)
        gains = (np.full(JOINTS, gain) for gain in (root, rate))
        cycle = limit_cycles(six(unit), SwitchingTerm("twisting", np.ones(JOINTS), *gains))[3]
        assert cycle is not None
        assert cycle.omega / (2.0 * np.pi) == pytest.approx(frequency, rel=0.1)
        assert cycle.amplitude == pytest.approx(0.5 * np.ptp(S[len(S) // 2 :]), rel=0.25)


def test_a_joint_whose_super_twisting_gains_are_0_does_not_swing() -> None:
    unit = CASES[0]._replace(kappa=1.0, disturbance=0.0)
    root, rate = np.full(JOINTS, 15.0), np.full(JOINTS, 110.0)
    root[2] = rate[2] = root[4] = 0.0
    cycles = limit_cycles(six(unit), SwitchingTerm("twisting", np.ones(JOINTS), root, rate))
    assert cycles[2] is None
    assert cycles[3] is not None
    assert np.isfinite(cycles[3].phasors).all()


@pytest.mark.parametrize("case", CASES)
def test_tanh_within_a_thin_layer_swings_as_predicted(case: Scalar) -> None:
    silent = limit_cycles(six(case), SIGN)[0]
    assert silent is not None
    layers = silent.crossing * np.array([0.3, 0.6])
    runs = run(case, lambda S: np.tanh(S / layers), 3.0, np.full(2, 1e-3)).T
    for S, layer in zip(runs, layers, strict=True):
        frequency, amplitude = swing(S, case.period)
        cycle = limit_cycles(six(case), SwitchingTerm.within("tanh", np.full(JOINTS, layer)))[0]
        assert cycle is not None
        assert cycle.omega / (2.0 * np.pi) == pytest.approx(frequency, rel=0.1)
        assert cycle.amplitude == pytest.approx(amplitude, rel=0.25)


@pytest.mark.parametrize("case", CASES)
def test_the_crossing_is_where_tanh_falls_silent(case: Scalar) -> None:
    calm = case._replace(disturbance=0.0)
    cycle = limit_cycles(six(calm), SwitchingTerm.within("tanh", np.ones(JOINTS)))[0]
    assert cycle is not None

    layers = cycle.crossing * np.array([0.5, 0.7, 0.8, 0.9, 1.1, 1.2, 1.5])
    S = run(calm, lambda S: np.tanh(S / layers), 4.0, 0.3 * layers)
    swings = np.ptp(S[-len(S) // 4 :], axis=0) > 0.2 * layers
    np.testing.assert_array_equal(swings, layers < cycle.crossing)


def test_a_layer_wider_than_the_crossing_is_silent() -> None:
    loop = six(CASES[1])
    crossing = limit_cycles(loop, SIGN)[0].crossing  # type: ignore[union-attr]
    for switching in ("tanh", "saturation"):
        wide, thin = (
            limit_cycles(loop, SwitchingTerm.within(switching, np.full(JOINTS, share * crossing)))[
                0
            ]
            for share in (1.1, 0.8)
        )
        assert wide is not None
        assert thin is not None
        assert wide.amplitude == 0.0
        assert thin.amplitude > 0.1 * crossing


@pytest.mark.parametrize("coupling", [-0.5, 0.5])
def test_joints_that_act_on_each_other_swing_farther_together(coupling: float) -> None:
    cycles = limit_cycles(six(CASES[1], coupling), SIGN)
    first, third = cycles[0], cycles[2]
    assert first is not None
    assert third is not None
    assert first.locked == (0, 1)
    assert third.locked == (2,)
    assert first.alone == pytest.approx(third.amplitude, rel=2e-3)
    assert first.amplitude == pytest.approx(1.5 * third.amplitude, rel=2e-3)
    assert np.sign(first.phasors[1].real) == np.sign(coupling)


def test_a_load_makes_the_swing_smaller_and_leaves_its_frequency() -> None:
    free = six(CASES[1])
    loaded = replace(free, load=np.full(JOINTS, 0.5))
    one, other = (limit_cycles(loop, SIGN)[0] for loop in (free, loaded))
    assert one is not None
    assert other is not None
    assert other.omega == one.omega
    assert other.amplitude == pytest.approx(one.amplitude * np.cos(0.25 * np.pi), rel=1e-6)


def test_the_curve_crosses_the_axis_where_the_limit_cycle_is() -> None:
    loop = six(CASES[1], 0.5)
    for joint, cycle in enumerate(limit_cycles(loop, SIGN)):
        assert cycle is not None
        (point,) = cycle.curve(loop, joint, np.array([cycle.omega]))
        assert point.real == pytest.approx(-cycle.crossing, rel=1e-3)
        assert abs(point.imag) < 5e-3 * cycle.crossing
