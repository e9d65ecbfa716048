"""Masses that no body has are refused; the datasheet's mass goes where it is asked to."""

from __future__ import annotations

from math import inf, nan
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.doctor.examine import examine
from slidetune.robot.doctor.inertials import ROUNDING, not_physical
from slidetune.robot.doctor.urdf.description import Inertial, Pose
from tests.robot.doctor.arm_text import FORE_INERTIAL, GOOD, UPPER_INERTIA, changed, examined, only
from tests.robot.doctor.descriptions import described

UPPER_INERTIAL = f"""    <inertial>
      <origin xyz="0 0 0.2"/>
      <mass value="2.0"/>
      {UPPER_INERTIA}
    </inertial>
"""
WEIGHTLESS = changed(UPPER_INERTIAL, "", changed(FORE_INERTIAL, ""))
BASE, UPPER, FORE = 0.2 * 0.2 * 0.1, np.pi * 0.04**2 * 0.4, 4.0 / 3.0 * np.pi * 0.05**3


def drawn(random: np.random.Generator, moments: tuple[float, float, float]) -> Inertial:
    """Return an inertial of these principal moments, about axes that are drawn."""
    turn = pin.exp3(random.uniform(-2.0, 2.0, 3))
    tensor = turn @ np.diag(moments) @ turn.T
    return Inertial(1, Pose(), 1.0, tuple(tensor[np.triu_indices(3)]))


def test_moments_of_bodies_are_physical_however_they_lie() -> None:
    random = np.random.default_rng(0)
    for _ in range(200):
        places, masses = random.uniform(-1.0, 1.0, (5, 3)), random.uniform(0.0, 1.0, 5)
        squares = (masses[:, None] * places**2).sum(axis=0)
        moments = tuple(squares.sum() - squares)
        assert not_physical(drawn(random, moments)) == ""


def test_moments_of_no_body_are_refused_however_they_lie() -> None:
    random = np.random.default_rng(1)
    for _ in range(200):
        small, middle = random.uniform(0.1, 1.0, 2)
        beyond = (small + middle) * (1.0 + 5.0 * ROUNDING)
        assert "triangle inequality" in not_physical(drawn(random, (small, middle, beyond)))
        assert "above 0" in not_physical(drawn(random, (-0.01 * middle, middle, middle)))


def test_rounding_of_three_digits_is_forgiven() -> None:
    assert not_physical(Inertial(1, Pose(), 1.0, (0.333, 0, 0, 0.667, 0, 1.0))) == ""
    assert not_physical(Inertial(1, Pose(), 1.0, (0.3, 0, 0, 0.6, 0, 1.0)))


def test_a_whole_mass_is_spread_by_volume(tmp_path: Path) -> None:
    found = examined(tmp_path, WEIGHTLESS, total_mass=12.0)
    assert found.arm is not None
    masses = [inertia.mass for inertia in found.arm.model.inertias]
    density = 12.0 / (BASE + UPPER + FORE)
    np.testing.assert_allclose(masses, density * np.array([BASE, UPPER, FORE]))
    upper, fore = list(found.arm.model.inertias)[1:]
    across = (3 * 0.04**2 + 0.4**2) / 12
    expected = upper.mass * np.diag([across, across, 0.04**2 / 2])
    np.testing.assert_allclose(upper.inertia, expected, atol=1e-15)
    np.testing.assert_allclose(upper.lever, [0.0, 0.0, 0.2])
    np.testing.assert_allclose(fore.inertia, 0.4 * fore.mass * 0.05**2 * np.eye(3), atol=1e-15)
    assumed = {finding.where: finding.text for finding in only(found, "assumed")}
    assert set(assumed) == {"link base", "link upper", "link fore"}
    assert "kg of the arm's 12 by the volume of its visuals" in assumed["link upper"]
    assert "by the volume of its collisions" in assumed["link base"]


def test_without_that_mass_the_way_out_is_named(tmp_path: Path) -> None:
    refused = only(examined(tmp_path, WEIGHTLESS), "refused")
    assert [finding.where for finding in refused] == ["link upper", "link fore"]
    assert all("total_mass" in finding.remedy for finding in refused)


def test_what_other_links_weigh_is_taken_off(tmp_path: Path) -> None:
    found = examined(tmp_path, changed(FORE_INERTIAL, ""), total_mass=5.0)
    assert found.arm is not None
    masses = [inertia.mass for inertia in found.arm.model.inertias]
    np.testing.assert_allclose(masses[1], 2.0)
    np.testing.assert_allclose(sum(masses), 5.0)


def test_an_inertia_that_no_body_has_is_replaced(tmp_path: Path) -> None:
    found = examined(tmp_path, changed('izz="0.004"', 'izz="0.4"'), total_mass=5.0)
    assert found.arm is not None
    np.testing.assert_allclose(sum(inertia.mass for inertia in found.arm.model.inertias), 5.0)


@pytest.mark.parametrize(
    ("mass", "words"),
    [
        (0.0, "total_mass must be above 0 kg, got 0"),
        (-3.0, "total_mass must be above 0 kg, got -3"),
        (nan, "total_mass must be above 0 kg, got nan"),
        (inf, "total_mass must be above 0 kg, got inf"),
        (1.5, "1.5 kg less 2 kg of the other links"),
        (1e9, "allowed is 1 to 100000"),
    ],
)
def test_a_mass_that_cannot_be_is_refused(mass: float, words: str, tmp_path: Path) -> None:
    found = examined(tmp_path, changed(FORE_INERTIAL, ""), total_mass=mass)
    assert found.arm is None
    assert any(one.where == "total_mass" and words in one.text for one in only(found, "refused"))


def test_a_mass_without_need_changes_nothing(tmp_path: Path) -> None:
    found = examined(tmp_path, GOOD, total_mass=50.0)
    (noted,) = found.findings
    assert noted.kind == "noted"
    assert noted.text == "total_mass isn't used: what moves has its masses, 3 kg in all"


def test_nothing_to_spread_it_on_is_said(tmp_path: Path) -> None:
    bare = changed("<sphere", "<speer", changed(FORE_INERTIAL, "")).replace("<box", "<bux")
    found = examined(tmp_path, bare, total_mass=5.0)
    assert any("have no shape with volume" in one.text for one in only(found, "refused"))


def test_the_mass_of_a_real_arm_is_spread_over_its_meshes(tmp_path: Path) -> None:
    text = described("xarm7.urdf").read_text(encoding="utf-8")
    while "<inertial>" in text:
        before, _, rest = text.partition("<inertial>")
        text = before + rest.partition("</inertial>")[2]
    path = tmp_path / "xarm7.urdf"
    path.write_text(text, encoding="utf-8")
    folder = next(p for p in described("xarm7.urdf").parents if p.name == "example-robot-data")
    assert examine(path, [folder]).arm is None
    found = examine(path, [folder], total_mass=13.7)
    assert found.arm is not None, found.findings
    np.testing.assert_allclose(sum(inertia.mass for inertia in found.arm.model.inertias), 13.7)
    for inertia in list(found.arm.model.inertias)[1:]:
        small, middle, large = np.linalg.eigvalsh(inertia.inertia)
        assert 0.0 < small <= middle <= large < small + middle
