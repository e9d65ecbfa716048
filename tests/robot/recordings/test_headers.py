"""What headers say: those of ROS, UR, PlotJuggler, spreadsheets and our own exports."""

from __future__ import annotations

import pytest

from slidetune.robot.recordings.headers import ANGLE, CURRENT, TORQUE, VELOCITY, meaning_of
from slidetune.robot.recordings.units import factor_of, split_unit

JOINTS = ("joint_1", "joint_2", "shoulder_pan_joint", "joint_s")

CLEAR = [
    ("q1", ANGLE, False, None, 1, "", ""),
    ("q1 [rad]", ANGLE, False, None, 1, "rad", ""),
    ("q2_deg", ANGLE, False, None, 2, "deg", ""),
    ("Q_3 (°)", ANGLE, False, None, 3, "°", ""),
    ("J1", ANGLE, False, None, 1, "", ""),
    ("Joint 4 position [deg]", ANGLE, False, None, 4, "deg", ""),
    ("joint_1", ANGLE, False, 0, None, "", ""),
    ("JOINT_2", ANGLE, False, 1, None, "", ""),
    ("joint_s", ANGLE, False, 3, None, "", ""),
    ("joint_s_deg", ANGLE, False, 3, None, "deg", ""),
    ("joint_1.velocity [rad/s]", VELOCITY, False, 0, None, "rad/s", ""),
    ("position[0]", ANGLE, False, None, 0, "", ""),
    ("position[joint_1]", ANGLE, False, 0, None, "", ""),
    ("/joint_states/shoulder_pan_joint/effort", TORQUE, False, 2, None, "", ""),
    ("/robot1/joint_states/shoulder_pan_joint/position", ANGLE, False, 2, None, "", "robot1"),
    ("actual_q_0", ANGLE, False, None, 0, "", ""),
    ("actual_qd_5", VELOCITY, False, None, 5, "", ""),
    ("target_qd_5", VELOCITY, True, None, 5, "", ""),
    ("target_q_0", ANGLE, True, None, 0, "", ""),
    ("target_moment_2", TORQUE, True, None, 2, "", ""),
    ("actual_current_1", CURRENT, False, None, 1, "", ""),
    ("q_d1 [rad]", ANGLE, True, None, 1, "rad", ""),
    ("RBFNN-NFTSM/tau6 [N·m]", TORQUE, False, None, 6, "N·m", "RBFNN-NFTSM"),
    ("Computed torque/q1 [rad]", ANGLE, False, None, 1, "rad", "Computed torque"),
    ("actualPosition1", ANGLE, False, None, 1, "", ""),
    ("tau1_nm", TORQUE, False, None, 1, "nm", ""),
]
UNCLEAR = [
    "qd1",
    "x",
    "target_qdd_0",
    "actual_TCP_pose_0",
    "joint_temperatures_0",
    "joint_1_temperature",
    "e1 [rad]",
    "S1 [rad/s]",
    "",
    "/",
    "1",
    "joint",
    "q",
    "q1 tau1",
    "joint_1 joint_2 q 3",
    "joint_10_2",
]


@pytest.mark.parametrize(
    ("header", "quantity", "reference", "joint", "index", "unit", "source"), CLEAR
)
def test_a_clear_header_is_understood(
    header: str,
    quantity: str,
    reference: bool,
    joint: int | None,
    index: int | None,
    unit: str,
    source: str,
) -> None:
    found = meaning_of(header, JOINTS)
    assert found is not None
    assert (found.quantity, found.reference) == (quantity, reference)
    assert (found.joint, found.index, found.unit, found.source) == (joint, index, unit, source)


@pytest.mark.parametrize("header", UNCLEAR)
def test_an_unclear_header_is_no_guess(header: str) -> None:
    assert meaning_of(header, JOINTS) is None


@pytest.mark.parametrize(
    ("unit", "measured", "factor"),
    [
        ("deg", "angle", 0.017453292519943295),
        ("°/s", "angle rate", 0.017453292519943295),
        ("RPM", "angle rate", 0.10471975511965977),
        ("Nm", "torque", 1.0),
        ("N·m", "torque", 1.0),
        ("mNm", "torque", 1e-3),
        ("mA", "current", 1e-3),
        ("µs", "time", 1e-6),
        ("mm", "place", 1e-3),
        ("", "torque", 1.0),
        ("mm", "angle", None),
        ("rad", "torque", None),
    ],
)
def test_units_become_si(unit: str, measured: str, factor: float | None) -> None:
    assert factor_of(unit, measured) == factor


def test_an_index_is_no_unit() -> None:
    assert split_unit("position[0]") == ("position[0]", "")
