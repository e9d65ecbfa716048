"""Recordings on the command line as people use them: in a process of its own."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from slidetune.robot.loop.simulate import Run, simulate
from slidetune.server.exports.csv_file import csv_lines
from slidetune.server.exports.recorded_run import recorded_run
from tests.server.test_cli import slidetune, strict

PRESET: dict[str, Any] = {
    "title": "Two links",
    "robot": {
        "model": "two_links",
        "armature": [0.05, 0.03],
        "viscous_friction": [0.8, 0.4],
        "coulomb_friction": [1.2, 0.6],
    },
    "trajectory": {"kind": "quintic", "duration": 4.0, "end": [1.5, -1.2]},
    "lanes": {"A": {"law": "computed_torque"}},
    "simulation": {"horizon": 6.0},
}


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """An experiment in ``two.yaml``, its run as a log in ``log.csv``, and one without friction."""
    experiment = Experiment.from_document(PRESET)
    found = simulate(experiment)
    smooth = experiment.patched({"robot": {"viscous_friction": 0, "coulomb_friction": 0}})
    for name, one in (("two.yaml", experiment), ("smooth.yaml", smooth)):
        (tmp_path / name).write_text(experiment_to_yaml(one), encoding="utf-8")
    (tmp_path / "log.csv").write_text("".join(csv_lines(recorded_run(found))), encoding="utf-8")
    lines = (tmp_path / "log.csv").read_text(encoding="utf-8").split("\n")
    (tmp_path / "late.csv").write_text("\n".join([lines[0], *lines[501:]]), encoding="utf-8")
    return found


def test_a_recording_becomes_the_desired_motion(run: Run, tmp_path: Path) -> None:
    done = slidetune("reference", "two.yaml", "log.csv", "--out", "followed.yaml", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "RMS residual [mrad]" in done.stdout
    followed = experiment_from_yaml((tmp_path / "followed.yaml").read_bytes())
    assert followed.trajectory.kind == "recorded"
    found = simulate(followed)
    np.testing.assert_allclose(found.q_d, run.lanes["A"].q, atol=2e-4)
    printed = slidetune(
        "reference", "two.yaml", "log.csv", "--spacing", "0.2", "--json", "-", folder=tmp_path
    )
    document = strict(printed.stdout)
    assert document["spacing"] == 0.2
    assert document["waypoints"] == 31
    assert document["patch"]["trajectory"]["origin"] == "log.csv"


def test_logs_stand_beside_the_lanes(run: Run, tmp_path: Path) -> None:
    arguments = ("log", "two.yaml", "log.csv", "late.csv")
    done = slidetune(*arguments, "--no-own", "--json", "-", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    document = strict(done.stdout)
    lane, log, late = (
        document["lanes"]["A"]["metrics"],
        document["logs"]["log.csv"],
        document["logs"]["late.csv"],
    )
    for name in ("mae", "max_error", "peak_torque", "chattering", "flange_rms"):
        np.testing.assert_allclose(log["metrics"][name], lane[name], rtol=0.02)
    assert abs(log["shift"]) < 2e-3
    assert late["shift"] - log["shift"] == pytest.approx(0.5, abs=2e-3)
    given = slidetune(*arguments, "--shift", "0", "--shift", "0.5", folder=tmp_path)
    assert given.returncode == 0, given.stderr
    assert "late.csv" in given.stdout
    assert "shifted by 0.5 s; error against its own desired motion" in given.stdout
    wrong = slidetune(*arguments, *("--shift", "1") * 3, folder=tmp_path)
    assert wrong.returncode == 2
    assert "for each of the 2 logs, got 3" in wrong.stderr


def test_a_log_says_what_it_knows_and_writes_it(run: Run, tmp_path: Path) -> None:
    fit = ("--fit", "viscous_friction", "--fit", "coulomb_friction")
    done = slidetune(
        *("identify", "smooth.yaml", "log.csv", *fit, "--out", "found.yaml", "--csv", "left.csv"),
        folder=tmp_path,
    )
    assert done.returncode == 0, done.stderr
    assert "viscous friction of joint 2" in done.stdout
    assert "95 % interval" in done.stdout
    found = experiment_from_yaml((tmp_path / "found.yaml").read_bytes()).robot
    np.testing.assert_allclose(found.viscous_friction, [0.8, 0.4], rtol=0.02)
    np.testing.assert_allclose(found.coulomb_friction, [1.2, 0.6], rtol=0.02)
    assert found.armature == run.experiment.robot.armature
    lines = (tmp_path / "left.csv").read_text(encoding="utf-8").splitlines()
    rows = list(csv.DictReader(lines))
    assert float(rows[5]["tau1 [N·m]"]) - float(rows[5]["fitted1 [N·m]"]) == pytest.approx(
        float(rows[5]["residual1 [N·m]"])
    )
    document = strict(
        slidetune("identify", "smooth.yaml", "log.csv", *fit, "--json", "-", folder=tmp_path).stdout
    )
    assert [one["told"] for one in document["estimates"]] == ["yes"] * 4
    assert set(document["patch"]["robot"]) == {"viscous_friction", "coulomb_friction"}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("reference", "two.yaml", "none.csv"), "none.csv: there is no such file"),
        (("reference", "two.yaml", "two.yaml"), "two.yaml: "),
        (("reference", "paper", "log.csv"), "joint_3, joint_4"),
        (("log", "two.yaml", "log.csv", "--source", "B"), "no columns of 'B': there are A"),
        (("log", "two.yaml", "log.csv", "--map", "joint"), "--map must be WHAT=COLUMN"),
        (("log", "two.yaml", "log.csv", "--shift", "soon"), "--shift must be auto or seconds"),
        (("log", "two.yaml", "log.csv", "--angles", "gon"), "--angles must be rad or deg"),
        (("log", "two.yaml", "log.csv", "--since", "6"), "--since"),
        (("identify", "two.yaml", "log.csv", "--fit", "mass"), "some of payload, armature"),
        (("identify", "two.yaml", "log.csv", "--torque-constants", "1,x"), "--torque-constants"),
        (("identify", "two.yaml", "log.csv", "--torque-constants", "1,2"), "has no currents"),
        (("identify", "two.yaml", "log.csv", "--json", "-", "--csv", "-"), "two results"),
    ],
)
def test_what_is_refused_ends_with_2_and_says_why(
    run: Run, tmp_path: Path, arguments: tuple[str, ...], words: str
) -> None:
    done = slidetune(*arguments, folder=tmp_path)
    assert done.returncode == 2, done.stdout
    assert words in " ".join(done.stderr.split())
    assert "Traceback" not in done.stderr
