"""The arm as a model: what payload, armature and scales do to M and to gravity."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slidetune.robot.arm.arm import build_model, flange_positions, nominal_arm, shipped_places
from slidetune.robot.arm.description import DATASHEET_MASS, VENDOR_MASS
from slidetune.robot.arm.known import FLANGE
from slidetune.robot.arm.section import Robot
from slidetune.robot.fields.quantity import JOINTS

Array = np.ndarray
ANGLES = st.lists(st.floats(-3.0, 3.0), min_size=JOINTS, max_size=JOINTS).map(np.array)
GRAVITY = np.array([0.0, 0.0, -9.81])


def dynamics(model: pin.Model, q: Array) -> tuple[Array, Array]:
    """Return M and G at a pose."""
    data = model.createData()
    M = pin.crba(model, data, q).copy()
    return M, pin.computeGeneralizedGravity(model, data, q).copy()


def arm(**changes: Any) -> pin.Model:
    return build_model(Robot.model_validate(changes))


@given(ANGLES)
def test_mass_matrix_is_symmetric_and_positive(q: Array) -> None:
    M, _ = dynamics(arm(), q)
    np.testing.assert_allclose(M, M.T, atol=1e-12)
    assert np.linalg.eigvalsh(M).min() > 0.0


@given(ANGLES, ANGLES)
def test_mass_matrix_rate_minus_twice_coriolis_is_skew(q: Array, v: Array) -> None:
    model = arm()
    data = model.createData()
    h = 1e-6
    rate = (dynamics(model, q + h * v)[0] - dynamics(model, q - h * v)[0]) / (2.0 * h)
    skew = rate - 2.0 * pin.computeCoriolisMatrix(model, data, q, v)
    np.testing.assert_allclose(skew + skew.T, 0.0, atol=1e-4)


@settings(max_examples=30)
@given(ANGLES, st.floats(0.1, 3.0))
def test_inertia_scale_multiplies_inertia_and_gravity(q: Array, scale: float) -> None:
    M, G = dynamics(arm(), q)
    scaled_M, scaled_G = dynamics(arm(inertia_scale=scale), q)
    np.testing.assert_allclose(scaled_M, scale * M, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(scaled_G, scale * G, rtol=1e-9, atol=1e-9)


def test_datasheet_arm_has_the_mass_of_the_real_one() -> None:
    q = np.array([0.1, 0.8, -0.4, 0.3, 0.9, 0.2])
    for one, other in zip(dynamics(arm(inertials="datasheet"), q), dynamics(arm(), q), strict=True):
        ratio = DATASHEET_MASS / VENDOR_MASS
        np.testing.assert_allclose(one, ratio * other, rtol=1e-6, atol=1e-9)


@settings(max_examples=30)
@given(ANGLES)
def test_armature_is_added_to_the_diagonal_alone(q: Array) -> None:
    armature = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    M, G = dynamics(arm(), q)
    other_M, other_G = dynamics(arm(armature=armature), q)
    np.testing.assert_allclose(other_M, M + np.diag(armature), atol=1e-12)
    np.testing.assert_allclose(other_G, G, atol=1e-12)


@settings(max_examples=30)
@given(ANGLES)
def test_payload_is_a_point_mass_in_the_flange_s_frame(q: Array) -> None:
    center = np.array([0.02, -0.03, 0.1])
    loaded = arm(payload={"mass": 3.0, "center": center.tolist()})
    bare = arm()
    data, frame = bare.createData(), bare.getFrameId(FLANGE)
    jacobian = pin.computeFrameJacobian(bare, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
    pin.framesForwardKinematics(bare, data, q)
    arm_to_mass = data.oMf[frame].rotation @ center
    at_mass = jacobian[:3] - pin.skew(arm_to_mass) @ jacobian[3:]
    M, G = dynamics(bare, q)
    loaded_M, loaded_G = dynamics(loaded, q)
    np.testing.assert_allclose(loaded_M, M + 3.0 * at_mass.T @ at_mass, atol=1e-9)
    np.testing.assert_allclose(loaded_G, G - 3.0 * at_mass.T @ GRAVITY, atol=1e-9)


def test_payload_is_not_scaled_with_the_arm() -> None:
    q = np.array([0.1, 0.8, -0.4, 0.3, 0.9, 0.2])
    payload = {"mass": 3.0}
    extra = dynamics(arm(payload=payload), q)[0] - dynamics(arm(), q)[0]
    scaled = dynamics(arm(payload=payload, inertia_scale=2.0), q)[0]
    np.testing.assert_allclose(scaled - dynamics(arm(inertia_scale=2.0), q)[0], extra, atol=1e-9)


def test_models_do_not_share_their_numbers() -> None:
    q = np.zeros(JOINTS)
    before = dynamics(arm(), q)[0]
    arm(inertia_scale=3.0, armature=5.0, payload={"mass": 10.0})
    np.testing.assert_array_equal(dynamics(arm(), q)[0], before)


def nominal(mismatch: float = 1.0, **changes: Any) -> pin.Model | None:
    arm = nominal_arm(Robot.model_validate(changes), mismatch)
    return None if arm is None else arm.model


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"armature": 1.0, "inertia_scale": 2.0},
        {"payload": {"mass": 0.0, "known": False}},
        {"payload": {"mass": 2.0, "known": True}},
        {"viscous_friction": 5.0},
    ],
)
def test_a_controller_that_knows_the_arm_needs_no_second_model(changes: dict[str, Any]) -> None:
    assert nominal(**changes) is None


def test_nominal_arm_knows_armature_but_no_hidden_payload() -> None:
    q = np.array([0.1, 0.8, -0.4, 0.3, 0.9, 0.2])
    found = nominal(armature=0.7, payload={"mass": 2.0})
    assert found is not None
    for one, other in zip(dynamics(found, q), dynamics(arm(armature=0.7), q), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)


@pytest.mark.parametrize("known", [False, True])
def test_mismatch_scales_the_arm_alone(known: bool) -> None:
    q = np.array([0.1, 0.8, -0.4, 0.3, 0.9, 0.2])
    payload = {"mass": 2.0, "known": known}
    found = nominal(0.5, armature=0.7, payload=payload)
    assert found is not None
    load = {"payload": payload} if known else {}
    expected = arm(inertia_scale=0.5, armature=0.7, **load)
    for one, other in zip(dynamics(found, q), dynamics(expected, q), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12)


def test_flange_is_where_pinocchio_sees_it() -> None:
    angles = np.random.default_rng(1).uniform(-6.0, 6.0, (300, JOINTS))
    model = arm()
    data, frame = model.createData(), model.getFrameId(FLANGE)
    expected = []
    for q in angles:
        pin.framesForwardKinematics(model, data, q)
        expected.append(data.oMf[frame].translation.copy())
    np.testing.assert_allclose(flange_positions(angles, shipped_places()), expected, atol=1e-12)


def test_flange_of_an_unknown_pose_is_unknown_and_no_error() -> None:
    angles = np.zeros((3, JOINTS))
    angles[1, 2] = np.nan
    found = flange_positions(angles, shipped_places())
    assert np.isfinite(found[[0, 2]]).all()
    assert np.isnan(found[1]).any()
    assert flange_positions(np.empty((0, JOINTS)), shipped_places()).shape == (0, 3)
