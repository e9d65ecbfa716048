"""Switching functions and reaching laws."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.workspace import GAIN, REACH, WORK_ROWS, S
from slidetune.robot.laws.terms.switching import (
    REACHINGS,
    SATURATION,
    SIGN,
    SWITCHINGS,
    TANH,
    ReachingGains,
    reach,
    switch,
)

Array = np.ndarray
SLIDING = st.floats(-50.0, 50.0)
LAYER = st.floats(1e-3, 10.0)
PAIRS = [pair for pair in product(SWITCHINGS, REACHINGS) if pair != ("implicit", "power")]


def reached(gains: ReachingGains, sliding: Array) -> tuple[Array, Array]:
    work = np.zeros((WORK_ROWS, JOINTS))
    work[S] = sliding
    reach(gains.pack_reaching(), work)
    return work[REACH].copy(), work[GAIN].copy()


def expected(gains: ReachingGains, s: Array) -> Array:
    k1, k2, epsilon = np.asarray(gains.k1), np.asarray(gains.k2), np.asarray(gains.epsilon)
    value = {
        "tanh": np.tanh(s / epsilon),
        "saturation": np.clip(s / epsilon, -1.0, 1.0),
        "sign": np.sign(s),
        "implicit": np.sign(s),  # where there is no period
    }[gains.switching]
    return {
        "exponential": k1 * s + k2 * value,
        "constant": k2 * value,
        "power": k1 * np.abs(s) ** gains.alpha * value,
    }[gains.reaching]


@given(SLIDING, LAYER)
def test_switching_functions_have_their_values(s: float, epsilon: float) -> None:
    assert switch(float(TANH), s, epsilon)[0] == pytest.approx(np.tanh(s / epsilon), abs=1e-15)
    clipped = float(np.clip(s / epsilon, -1.0, 1.0))
    assert switch(float(SATURATION), s, epsilon)[0] == pytest.approx(clipped, abs=1e-15)
    assert switch(float(SIGN), s, epsilon)[0] == np.sign(s)


@pytest.mark.parametrize("code", [TANH, SATURATION, SIGN])
@given(s=SLIDING, epsilon=LAYER)
def test_switching_functions_are_odd_and_bounded(code: int, s: float, epsilon: float) -> None:
    value, slope = switch(float(code), s, epsilon)
    mirrored, same_slope = switch(float(code), -s, epsilon)
    assert abs(value) <= 1.0
    assert (mirrored, same_slope) == (-value, slope)
    assert 0.0 <= slope <= 1.0 / epsilon


@pytest.mark.parametrize("code", [TANH, SATURATION, SIGN])
@given(s=SLIDING, epsilon=LAYER)
def test_slope_is_the_derivative(code: int, s: float, epsilon: float) -> None:
    step = 1e-6 * epsilon
    assume(abs(abs(s) - epsilon) > 2 * step)
    assume(abs(s) > 2 * step)
    ahead, behind = (switch(float(code), s + sign * step, epsilon)[0] for sign in (1, -1))
    difference = (ahead - behind) / (2 * step)
    assert switch(float(code), s, epsilon)[1] == pytest.approx(difference, abs=1e-4 / epsilon)


@pytest.mark.parametrize(("switching", "reaching"), PAIRS)
def test_reaching_laws_have_their_values(switching: str, reaching: str) -> None:
    gains = ReachingGains(
        k1=[1, 2, 3, 4, 5, 6],
        k2=[6, 5, 4, 3, 2, 1],
        epsilon=[0.1, 0.2, 0.5, 1, 2, 4],
        switching=switching,
        reaching=reaching,
        alpha=0.3,
    )
    for scale in (0.0, 1e-6, 0.01, 1.0, 30.0):
        sliding = scale * np.array([1.0, -1.0, 0.3, -2.0, 0.7, -0.1])
        np.testing.assert_allclose(reached(gains, sliding)[0], expected(gains, sliding), rtol=1e-12)


@pytest.mark.parametrize("switching", ["tanh", "saturation"])
@pytest.mark.parametrize("reaching", REACHINGS)
@settings(max_examples=50)
@given(s=st.floats(0.01, 20.0), sign=st.sampled_from([-1.0, 1.0]))
def test_gain_is_the_slope_of_the_reaching_law(
    switching: str, reaching: str, s: float, sign: float
) -> None:
    gains = ReachingGains(k1=7, k2=11, epsilon=0.7, switching=switching, reaching=reaching)
    assume(abs(s - 0.7) > 1e-5)
    at = np.full(JOINTS, sign * s)
    difference = (reached(gains, at + 1e-6)[0] - reached(gains, at - 1e-6)[0]) / 2e-6
    np.testing.assert_allclose(reached(gains, at)[1], difference, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize(("switching", "reaching"), PAIRS)
@given(s=st.floats(-1e3, 1e3))
def test_reaching_laws_oppose_and_stay_finite(switching: str, reaching: str, s: float) -> None:
    gains = ReachingGains(switching=switching, reaching=reaching, epsilon=1e-4, alpha=0.05)
    value, slope = reached(gains, np.full(JOINTS, s))
    assert np.isfinite(value).all()
    assert np.isfinite(slope).all()
    assert (value * s >= 0.0).all()
    assert (slope >= 0.0).all()


def test_every_joint_has_its_own_gains() -> None:
    base = ReachingGains(k1=1, k2=1, epsilon=1)
    for name in ("k1", "k2", "epsilon"):
        for joint in range(JOINTS):
            values = [1.0] * JOINTS
            values[joint] = 2.0
            changed = reached(ReachingGains(**{**base.model_dump(), name: values}), np.ones(JOINTS))
            differs = changed[0] != reached(base, np.ones(JOINTS))[0]
            assert np.flatnonzero(differs).tolist() == [joint]


@pytest.mark.parametrize("law", ["rbfnn_nftsm", "rbfnn_smc"])
def test_a_law_without_a_model_refuses_the_implicit_sign(law: str) -> None:
    with pytest.raises(InvalidExperimentError) as caught:
        Experiment.from_document({"lanes": {"A": {"law": law, "switching": "implicit"}}})
    (refused,) = caught.value.fields
    assert (refused.path, refused.value) == ("lanes.A.switching", "implicit")
    assert refused.allowed == "tanh, saturation, sign"
    assert "got implicit: that takes sign(S) at the end of the period" in refused.message


def test_the_power_law_has_no_term_whose_sign_could_be_taken_at_the_end() -> None:
    lane = {"law": "smc", "switching": "implicit", "reaching": "power"}
    with pytest.raises(InvalidExperimentError) as caught:
        Experiment.from_document({"lanes": {"A": lane}})
    (refused,) = caught.value.fields
    assert (refused.path, refused.value) == ("lanes.A.switching", "implicit")
    assert "must be tanh, saturation or sign where reaching is power" in refused.message
