"""Commands about arms, as people run them: in a process of its own."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np

from slidetune.robot.arm.teaching import TWO_LINKS
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml
from tests.robot.doctor.descriptions import described
from tests.server.test_cli import slidetune, strict

UR5 = str(described("ur5_robot.urdf"))


def test_the_doctor_prints_its_report_and_ends_with_0_or_2(tmp_path: Path) -> None:
    done = slidetune("doctor", UR5, folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "ur5 is an arm of 6 joints" in done.stdout
    done = slidetune("doctor", UR5, "--json", "-", "--tip", "wrist_3_link", folder=tmp_path)
    document = strict(done.stdout)
    assert document["arm"]["tip"] == "wrist_3_link"
    assert [joint["effort"] for joint in document["arm"]["joints"]][:2] == [150.0, 150.0]
    refused = slidetune("doctor", str(described("anymal.urdf")), folder=tmp_path)
    assert refused.returncode == 2
    assert "floating base" in " ".join(refused.stdout.split())
    refused = slidetune("doctor", "nowhere.urdf", "--json", "-", folder=tmp_path)
    assert refused.returncode == 2
    document = strict(refused.stdout)
    assert document["arm"] is None
    assert document["findings"][0]["kind"] == "refused"
    assert [path.name for path in tmp_path.iterdir()] == []


def test_an_arm_is_kept_listed_and_removed(tmp_path: Path) -> None:
    done = slidetune("arm", "add", UR5, "--title", "My UR5", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    name = done.stdout.strip()
    assert name.startswith("ur5-")
    assert "ur5 is an arm of 6 joints" in done.stderr
    listed = strict(slidetune("arms", "--json", "-", folder=tmp_path).stdout)["arms"]
    assert [arm["name"] for arm in listed] == ["jaka_zu5", "pendulum", "two_links", name]
    assert (listed[-1]["title"], listed[-1]["shipped"]) == ("My UR5", False)
    assert name in slidetune("arms", folder=tmp_path).stdout
    (tmp_path / "arms" / name / "arm.json").write_text("{")
    damaged = slidetune("arms", folder=tmp_path)
    assert damaged.returncode == 0
    assert "damaged" in damaged.stdout
    assert slidetune("arm", "remove", name, folder=tmp_path).returncode == 0
    again = slidetune("arm", "remove", name, folder=tmp_path)
    assert again.returncode == 2
    assert "kept are: none" in again.stderr
    assert list((tmp_path / "arms").iterdir()) == []


def test_a_refused_arm_is_not_kept_and_says_why(tmp_path: Path) -> None:
    done = slidetune("arm", "add", str(described("anymal.urdf")), folder=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert "floating base" in " ".join(done.stderr.split())
    assert not (tmp_path / "arms").exists()


def test_run_takes_a_urdf_alone_and_keeps_nothing(tmp_path: Path) -> None:
    shutil.copy(TWO_LINKS, tmp_path / "mine.urdf")
    done = slidetune("run", "--urdf", "mine.urdf", "--json", "-", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    document = strict(done.stdout)
    model = document["experiment"]["robot"]["model"]
    assert model.startswith("two-links-")
    assert f"Its name in experiments is {model}" in done.stderr
    lanes = document["lanes"]
    assert list(lanes) == ["RBFNN-NFTSM", "NFTSM", "Computed torque PD"]
    assert all(lane["frozen"] is None and lane["gamma"] < 1.0 for lane in lanes.values())
    assert max(np.max(lane["metrics"]["max_error"]) for lane in lanes.values()) < 0.05
    assert [path.name for path in tmp_path.iterdir()] == ["mine.urdf"]


def test_a_preset_of_an_own_arm_names_the_way_out_and_runs_with_it(tmp_path: Path) -> None:
    shutil.copy(TWO_LINKS, tmp_path / "mine.urdf")
    first = strict(slidetune("run", "--urdf", "mine.urdf", "--json", "-", folder=tmp_path).stdout)
    experiment = {**first["experiment"], "simulation": {"horizon": 0.3}}
    (tmp_path / "own.yaml").write_text(json.dumps(experiment), encoding="utf-8")
    unknown = slidetune("run", "own.yaml", folder=tmp_path)
    assert unknown.returncode == 2
    assert "slidetune arm add FILE" in unknown.stderr
    kept = slidetune("arm", "add", "mine.urdf", folder=tmp_path)
    assert kept.stdout.strip() == experiment["robot"]["model"]
    known = slidetune("run", "own.yaml", "--json", "-", folder=tmp_path)
    assert known.returncode == 0, known.stderr
    assert strict(known.stdout)["experiment"]["robot"] == experiment["robot"]


def test_a_preset_is_put_on_another_arm_where_its_joints_fit(tmp_path: Path) -> None:
    (tmp_path / "short.yaml").write_text(
        "lanes: {A: {law: nftsm, k1: 10, k2: 5}}\nsimulation: {horizon: 0.3}\n"
    )
    moved = slidetune("run", "short.yaml", "--urdf", UR5, "--json", "-", folder=tmp_path)
    assert moved.returncode == 0, moved.stderr
    assert strict(moved.stdout)["experiment"]["robot"]["model"].startswith("ur5-")
    refused = slidetune("run", "paper", "--urdf", str(TWO_LINKS), folder=tmp_path)
    assert refused.returncode == 2
    assert "paper is an experiment for JAKA Zu 5 with 6 joints" in refused.stderr
    assert "disturbance.constant" in refused.stderr


def test_options_of_an_arm_need_one(tmp_path: Path) -> None:
    for arguments in (("run",), ("run", "paper", "--tip", "x"), ("serve", "--total-mass", "3")):
        done = slidetune(*arguments, folder=tmp_path)
        assert done.returncode == 2
        assert "--urdf FILE" in done.stderr


def test_a_study_of_an_own_arm_writes_a_preset_for_it(tmp_path: Path) -> None:
    (tmp_path / "goal.yaml").write_text(
        "robot: {model: two_links}\n"
        "lanes: {A: {law: smc, k1: 10, k2: 1}}\n"
        "trajectory: {kind: sine, amplitude: 0.2}\n"
        "simulation: {horizon: 0.3}\n"
        "goals: {near: {kind: figure, figure: mae, bound: 0.5}}\n"
    )
    arguments = ("tune", "goal.yaml", "--urdf", str(TWO_LINKS), "--trials", "4")
    done = slidetune(*arguments, "--out", "tuned.yaml", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "tuned.yaml").read_text(encoding="utf-8")
    name = next(line.split()[1] for line in text.splitlines() if "model:" in line)
    assert slidetune("arm", "add", str(TWO_LINKS), folder=tmp_path).stdout.strip() == name
    assert experiment_from_yaml(text.replace(name, "two_links")).robot.model == "two_links"
