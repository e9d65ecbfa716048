"""What a report, a page, a table and a preset say of an arm whose joints slide."""

from __future__ import annotations

import io
from collections.abc import Iterator

import numpy as np
import pinocchio as pin
import pytest
from rich.console import Console

from slidetune.robot.arm.known import KnownArm, add_arm, forget_arm
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from slidetune.robot.handover.package import package
from slidetune.robot.loop.simulate import simulate
from slidetune.server.exports.columns import columns_of
from slidetune.server.exports.recorded_run import recorded_run
from slidetune.server.report.run_figures import run_sections
from slidetune.server.report.run_report import print_report, report
from slidetune.server.run_report.page import run_report
from slidetune.server.run_report.recording import record
from slidetune.server.state.published import published_schema


def arm(name: str, *slides: bool) -> KnownArm:
    model = pin.Model()
    for number, slide in enumerate(slides):
        kind = pin.JointModelPrismaticUnaligned if slide else pin.JointModelRevoluteUnaligned
        axis = np.array([1.0, 0.0, 0.0] if slide else [0.0, 0.0, 1.0])
        place = pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.3]))
        joint = model.addJoint(number, kind(axis), place, f"joint_{number + 1}")
        body = pin.Inertia(1.0, np.array([0.1, 0.0, 0.0]), 0.01 * np.eye(3))
        model.appendBodyToJoint(joint, body, pin.SE3.Identity())
    model.addFrame(pin.Frame("tip", len(slides), 0, pin.SE3.Identity(), pin.FrameType.BODY))
    return KnownArm(name, name, "", model, "tip", (0.0,) * len(slides))


@pytest.fixture(autouse=True)
def arms() -> Iterator[None]:
    add_arm(arm("slider", True))
    add_arm(arm("both", True, False))
    add_arm(arm("more", True, True, False, False, False, False))  # six: compiled already
    yield
    forget_arm("more")
    forget_arm("slider")
    forget_arm("both")


def experiment(model: str) -> Experiment:
    lanes = {"A": {"law": "smc", "k1": 5.0, "k2": 1.0, "epsilon": 0.1}}
    goals = {"near": {"kind": "figure", "figure": "max_error", "bound": 0.01}}
    document = {"robot": {"model": model}, "lanes": lanes, "goals": goals}
    return Experiment.from_document({**document, "simulation": {"horizon": 0.3}})


def printed(model: str) -> str:
    screen = io.StringIO()
    print_report(report(simulate(experiment(model))), Console(file=screen, width=300))
    return screen.getvalue()


def test_a_report_has_the_unit_of_an_arm_that_slides_or_says_that_it_is_mixed() -> None:
    alone = printed("slider")
    assert "mean |e| [mm]" in alone
    assert "peak |τ| [N]" in alone
    assert "N·m" not in alone
    assert "rad" not in alone
    both = printed("both")
    assert "mean |e| [mrad | mm]" in both
    assert "The second unit is that of J1, which slides; a total" in both
    assert "The second unit is that of J1 and J2, which slide; a total" in printed("more")
    assert report(simulate(experiment("both")))["units"]["max_error"] == "rad | m"


def test_columns_and_axes_have_the_unit_of_their_joint() -> None:
    run = simulate(experiment("both"))
    names = [name for name, _ in columns_of(recorded_run(run))]
    assert "A/q1 [m]" in names
    assert "A/q2 [rad]" in names
    assert "A/tau1 [N]" in names
    assert "A/tau2 [N·m]" in names
    position = run_sections(run)[0]
    assert [figure.axis for figure in position.figures] == ["q [m]", "q [rad]"]
    page = run_report(run, report(run), record)
    assert page.rate > 0.0
    for text in ("mean |e| [mrad | mm]", "≤ 0.01 rad | m<", "is that of J1, which slides"):
        assert text in page.html


def test_a_preset_says_the_units_of_its_arm_and_how_many_joints_it_has() -> None:
    alone, both = experiment_to_yaml(experiment("slider")), experiment_to_yaml(experiment("both"))
    assert "A value per joint is one number. A line" in alone
    assert "one number for both or a list of two" in both
    assert "k₁, N·s/m, Eq. 13" in alone
    assert "k₁, N·m·s/rad | N·s/m, Eq. 13" in both
    assert "ω, rad/s: angular frequency" in both
    assert "α₀, rad: phase" in both


def test_angles_of_a_sine_stay_angles_where_a_joint_slides() -> None:
    sine = published_schema("slider")["$defs"]["SineTrajectory"]["properties"]
    units = [sine[name]["unit"] for name in ("amplitude", "angular_frequency", "phase", "offset")]
    assert units == ["m", "rad/s", "rad", "m"]


def test_a_hand_over_says_the_unit_of_each_joint_or_that_they_differ() -> None:
    alone, mixed = (package(experiment(model), "A").files for model in ("slider", "both"))
    assert "/* measured position [m] */" in alone["law.h"]
    assert "proportional reaching gain k₁ [N·s/m]" in alone["gains.yaml"]
    assert "| 1 | joint\\_1 | slides |" in alone["README.md"]
    assert "rad" not in alone["law.h"].replace("gradual", "")
    assert "/* measured velocity [rad/s | m/s] */" in mixed["law.h"]
    assert "q: measured position [rad | m]." in mixed["law.py"]
    assert "| torque limit [N·m or N] |" in mixed["conditions.md"]
