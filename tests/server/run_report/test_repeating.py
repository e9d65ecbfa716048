"""The command that repeats a report, and what it needs."""

from __future__ import annotations

import shlex
from pathlib import Path

import numpy as np
import pytest

from slidetune.robot.arm.known import add_arm, forget_arm
from slidetune.robot.doctor.own import read_arm
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.law_files.law_file import law_from
from slidetune.robot.law_files.source import Source
from slidetune.robot.laws import register
from slidetune.robot.motion.recorded import waypoint_text
from slidetune.server.run_report.repeating import repeating
from tests.own_laws import EXAMPLE, own_laws

TWO_LINKS = Path(__file__).resolve().parents[3] / "robot/arm/teaching/two_links.urdf"
RUN = ["python", "-m", "slidetune", "run"]
TO = ["--report", "report.html"]


def test_a_preset_as_it_ships_is_named_and_a_changed_one_is_a_link_to_it() -> None:
    paper = load_preset("paper")
    again = repeating(paper)
    assert (again.preset, again.same, again.needs) == ("paper", True, ())
    assert shlex.split(again.command) == [*RUN, "paper", *TO]
    changed = paper.patched({"lanes": {"NFTSM": {"nu": 30}}})
    again = repeating(changed, since=0.5)
    assert (again.preset, again.same, again.baseline) == ("paper", False, paper)
    command = shlex.split(again.command)
    assert load_preset(command[4]) == changed
    assert command[5:] == ["--since", "0.5", *TO]


def test_lanes_in_another_order_are_another_experiment() -> None:
    paper = load_preset("paper").document()
    turned = {**paper, "lanes": dict(reversed(paper["lanes"].items()))}
    again = repeating(Experiment.from_document(turned))
    assert not again.same
    link = shlex.split(again.command)[4]
    assert list(load_preset(link).lanes) == list(turned["lanes"])


def test_what_no_link_can_hold_is_repeated_from_the_yaml() -> None:
    waypoints = waypoint_text(np.random.default_rng(1).uniform(-1.0, 1.0, (400, 6)))
    trajectory = {"kind": "recorded", "spacing": 0.1, "waypoints": waypoints}
    again = repeating(Experiment.from_document({"trajectory": trajectory}))
    assert shlex.split(again.command) == [*RUN, "experiment.yaml", *TO]
    assert "save the YAML below as experiment.yaml" in again.needs[0]
    assert (again.preset, again.same) == ("", False)


def test_a_law_of_one_s_own_is_named_with_its_file_and_digest() -> None:
    source = Source("mine.py", EXAMPLE)
    with own_laws():
        register(law_from(source))
        lanes = {"A": {"law": "pd_gravity"}}
        again = repeating(Experiment.from_document({"lanes": lanes}))
    assert shlex.split(again.command)[5:] == ["--law", "mine.py", *TO]
    assert source.digest in again.needs[0]


@pytest.mark.parametrize("named", [(), ("--urdf", "mine.urdf", "--tip", "the tip")])
def test_an_own_arm_is_named_as_it_was_or_it_is_said_what_it_takes(named: tuple[str, ...]) -> None:
    arm, _ = read_arm(TWO_LINKS)
    add_arm(arm)
    try:
        again = repeating(Experiment.from_document({"robot": {"model": arm.name}}), arm=named)
    finally:
        forget_arm(arm.name)
    assert shlex.split(again.command)[5:] == [*named, *TO]
    assert ("add --urdf FILE" in again.needs[0]) == (not named)
