"""The command line as people run it: in a process of its own."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from html import unescape
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from slidetune.robot.experiment.presets import SHIPPED_FOLDER, link_to, load_preset, presets
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.recordings.mcap_file import McapFile
from tests.own_laws import EXAMPLE, before_torque

ROOT = SHIPPED_FOLDER.parent
SHORT = {"simulation": {"horizon": 0.3}}


def slidetune(*arguments: str, folder: Path) -> subprocess.CompletedProcess[str]:
    settings = {
        "PYTHONPATH": str(ROOT),
        "PYTHONIOENCODING": "utf-8",
        "SLIDETUNE_PRESETS": str(folder),
        "SLIDETUNE_STUDIES": str(folder / "studies"),
        "SLIDETUNE_ARMS": str(folder / "arms"),
    }
    return subprocess.run(
        [sys.executable, "-m", "slidetune", *arguments],
        cwd=folder,
        env={**os.environ, **settings},
        capture_output=True,
        encoding="utf-8",
        timeout=300,
    )


def strict(text: str) -> Any:
    def refuse(name: str) -> None:
        raise AssertionError(f"{name} isn't JSON")

    return json.loads(text, parse_constant=refuse)


@pytest.fixture
def short(tmp_path: Path) -> Experiment:
    """Two lanes, 0.3 s, in ``short.yaml``."""
    lanes = {"A": {"law": "rbfnn_nftsm"}, "B, [red]": {"law": "nftsm"}}
    experiment = Experiment.from_document({"lanes": lanes, **SHORT})
    (tmp_path / "short.yaml").write_text(experiment_to_yaml(experiment), encoding="utf-8")
    return experiment


def test_run_writes_what_simulate_returns(short: Experiment, tmp_path: Path) -> None:
    files = ("--csv", "a.csv", "--parquet", "a.parquet", "--mcap", "a.mcap")
    done = slidetune("run", "short.yaml", "--json", "-", *files, "--since", "0.1", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    document, run = strict(done.stdout), simulate(short)
    assert document["experiment"] == short.document()
    for name, lane in run.lanes.items():
        figures = lane.metrics_since(0.1).document()
        assert document["lanes"][name]["metrics"] == {
            **figures,
            "reaching_time": list(figures["reaching_time"]),
        }
    header, *rows = (tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()
    assert header.startswith("time [s],q_d1 [rad],")
    assert '"B, [red]/tau6 [N·m]"' in header
    assert len(rows) == len(run.time) == 301
    table = pd.read_parquet(tmp_path / "a.parquet")
    assert np.array_equal(table["B, [red]/tau6 [N·m]"], run.lanes["B, [red]"].tau[:, 5])
    assert McapFile(tmp_path / "a.mcap", "/a/joint_states").names[1] == "joint_1/position"


def test_run_prints_every_lane_with_its_figures(short: Experiment, tmp_path: Path) -> None:
    done = slidetune("run", "short.yaml", folder=tmp_path)
    assert done.returncode == 0
    mae = simulate(short).lanes["B, [red]"].metrics.mae[0] * 1e3
    row = next(line for line in done.stdout.splitlines() if "B, [red]" in line)
    assert f"{mae:.4g}" in row
    for word in ("mean |e| [mrad]", "flange RMS [mm]", "chattering [N·m/s]", "lanes.A.nu"):
        assert word in done.stdout


def test_run_ends_with_3_where_a_lane_diverges_and_says_why(tmp_path: Path) -> None:
    simulation = {"mode": "sampled", "horizon": 1}
    wild = {"lanes": {"A": {"law": "rbfnn_nftsm"}}, "simulation": simulation}
    text = experiment_to_yaml(Experiment.from_document(wild))
    (tmp_path / "wild.yaml").write_text(text, encoding="utf-8")
    done = slidetune("run", "wild.yaml", "--json", "wild.json", folder=tmp_path)
    assert done.returncode == 3
    assert "A diverged: Joint" in done.stdout
    lane = strict((tmp_path / "wild.json").read_text(encoding="utf-8"))["lanes"]["A"]
    assert lane["frozen"]["time"] == lane["metrics"]["diverged_at"] < 1.0


def test_a_refused_value_ends_with_2_and_names_field_and_line(tmp_path: Path) -> None:
    text = "lanes:\n  A:\n    law: nftsm\n    nu: -3\n"
    (tmp_path / "bad.yaml").write_text(text, encoding="utf-8")
    done = slidetune("run", "bad.yaml", "--json", "out.json", folder=tmp_path)
    assert done.returncode == 2
    assert "line 4: lanes.A.nu" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out.json").exists()


@pytest.mark.parametrize("name", ["nowhere", "[/red]"])
def test_an_unknown_preset_ends_with_2_and_lists_the_known_ones(name: str, tmp_path: Path) -> None:
    done = slidetune("run", name, folder=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    if name == "nowhere":
        assert all(preset.name in done.stderr for preset in presets() if preset.shipped)


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (("--since", "0.3"), "horizon"),
        (("--since", "nan"), "--since"),
        (("--csv", "nowhere/a.csv"), "no folder nowhere"),
        (("--csv", "-", "--json", "-"), "standard output"),
    ],
)
def test_an_option_that_can_not_work_ends_with_2_before_anything_runs(
    arguments: tuple[str, ...], word: str, short: Experiment, tmp_path: Path
) -> None:
    done = slidetune("run", "short.yaml", *arguments, folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert word in done.stderr


def test_a_run_repeats_from_the_experiment_that_its_json_holds(
    short: Experiment, tmp_path: Path
) -> None:
    done = slidetune("run", "short.yaml", "--json", "-", folder=tmp_path)
    again = simulate(Experiment.from_document(strict(done.stdout)["experiment"]))
    assert np.array_equal(again.lanes["A"].q, simulate(short).lanes["A"].q)
    assert experiment_from_yaml(experiment_to_yaml(again.experiment)) == short


def test_a_link_runs_as_the_experiment_that_it_stands_for(
    short: Experiment, tmp_path: Path
) -> None:
    address = f"http://127.0.0.1:8000/#x={link_to(short)}&lane=NFTSM&right.view=live"
    done = slidetune("run", address, "--json", "-", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert Experiment.from_document(strict(done.stdout)["experiment"]) == short
    cut = slidetune("run", address.partition("&")[0][:-3], folder=tmp_path)
    assert cut.returncode == 2
    assert "cut off" in cut.stderr


def test_the_command_in_a_report_repeats_it(tmp_path: Path) -> None:
    changes = {**SHORT, "lanes": {"NFTSM": {"nu": 30}, "RBFNN-SMC": None}}
    link = link_to(load_preset("paper").patched(changes))
    done = slidetune("run", link, "--since", "0.1", "--report", "report.html", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "NFTSM" in done.stdout
    first = (tmp_path / "report.html").read_text(encoding="utf-8")
    command = re.search(r'<code id="command">(.*?)</code>', first)
    assert command is not None
    words = shlex.split(unescape(command[1]))
    assert words[:3] == ["python", "-m", "slidetune"]
    done = slidetune(*words[3:], "--json", "run.json", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    again = strict((tmp_path / "run.json").read_text(encoding="utf-8"))
    assert again.pop("preset") == link
    for page in (first, (tmp_path / "report.html").read_text(encoding="utf-8")):
        data = re.search(r'id="report">(.*?)</script>', page, re.DOTALL)
        assert data is not None
        assert strict(data[1]) == again


def test_paper_prints_the_comparison_and_writes_its_page(tmp_path: Path) -> None:
    done = slidetune("paper", "--html", "paper.html", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "published" in done.stdout
    assert (tmp_path / "paper.html").stat().st_size > 1e6
    assert [path.name for path in tmp_path.iterdir()] == ["paper.html"]


def test_help_names_every_command(tmp_path: Path) -> None:
    done = slidetune("--help", folder=tmp_path)
    assert done.returncode == 0
    assert all(command in done.stdout for command in ("serve", "run", "paper", "bench"))


def test_a_law_of_one_s_own_runs_and_one_that_never_returns_is_ended(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("lanes: {A: {law: pd_gravity}}\nsimulation: {horizon: 0.3}\n")
    law = tmp_path / "pd.py"
    law.write_text(EXAMPLE)
    refused = slidetune("run", "a.yaml", folder=tmp_path)
    assert refused.returncode == 2
    assert "--law FILE.py" in refused.stderr
    done = slidetune("run", "a.yaml", "--law", "pd.py", "--json", "-", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "A" in json.loads(done.stdout)["lanes"]
    law.write_text(before_torque("while True:", "    e += 1.0"))
    ended = slidetune("run", "a.yaml", "--law", "pd.py", folder=tmp_path)
    assert ended.returncode == 2
    assert "EndlessLoopError" in ended.stderr
    assert 'File "pd.py", line' in ended.stderr
