"""The files that pages speak of, in the folder in which their code and commands are run."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path

from slidetune import Experiment, load_preset, simulate
from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from tests.docs.pages import ROOT
from tests.robot.doctor.descriptions import described
from tests.robot.recordings.files import NAMES, joint_states, messages, table

SHORT = {"simulation": {"horizon": 0.3}}
ONE_LANE = dict.fromkeys(("RBFNN-NFTSM", "RBFNN-SMC", "Computed torque"))
"""Of the preset `realistic` but NFTSM."""


def _experiment(folder: Path, *patches: Mapping[str, object]) -> Experiment:
    experiment = load_preset("realistic").patched(SHORT)
    for patch in patches:
        experiment = experiment.patched(patch)
    (folder / "experiment.yaml").write_text(experiment_to_yaml(experiment), encoding="utf-8")
    return experiment


def plain(folder: Path) -> None:
    """Write ``experiment.yaml``, a short one."""
    _experiment(folder)


def longer(folder: Path) -> None:
    """Write ``experiment.yaml``, one that goes on for longer than a second."""
    _experiment(folder, {"simulation": {"horizon": 1.5}})


def to_be_tuned(folder: Path) -> None:
    """Write ``experiment.yaml`` with a goal and something uncertain, and what a search found."""
    goal = {"kind": "figure", "figure": "mae", "bound": 0.002}
    uncertain = {"payload": [0, 3], "seed": 1}
    experiment = _experiment(folder, {"goals": {"near": goal}, "uncertainty": uncertain})
    (folder / "tuned.yaml").write_text(experiment_to_yaml(experiment), encoding="utf-8")
    (folder / "docs").mkdir()
    shutil.copyfile(ROOT / "docs" / "fit-paper.yaml", folder / "docs" / "fit-paper.yaml")


def with_an_arm(folder: Path) -> None:
    """Write ``arm.urdf``, that of a UR5, with its meshes below ``src``."""
    urdf = described("ur5_robot.urdf")
    shutil.copyfile(urdf, folder / "arm.urdf")
    package = next(place for place in urdf.parents if place.name == "example-robot-data")
    (folder / "src").mkdir()
    os.symlink(package, folder / "src" / package.name)
    _experiment(folder)
    shutil.copyfile(folder / "experiment.yaml", folder / "preset.yaml")


def with_recordings(folder: Path) -> None:
    """Write ``move.csv``, and two logs of one lane, ``monday.mcap`` and ``tuesday.mcap``."""
    experiment = load_preset("realistic").patched(
        {"lanes": ONE_LANE, "simulation": {"horizon": 3.0, "input_delay": 0.0}}
    )
    run = simulate(experiment, estimate=False)
    lane, every = run.lanes["NFTSM"], slice(None, None, 10)  # 50 rows a second
    heads = ["t", *(f"q{number}" for number in range(1, 7))]
    table(folder / "move.csv", heads, [run.time[every], lane.q[every]])
    told = messages(NAMES, lane.q[every], velocity=lane.v[every], effort=lane.tau[every])
    for name in ("monday", "tuesday"):
        joint_states(folder / f"{name}.mcap", {"/joint_states": told})


SCENERY: Mapping[str, Callable[[Path], None]] = {
    "own-arm.md": with_an_arm,
    "own-data.md": with_recordings,
    "teach.md": longer,
    "studies.md": to_be_tuned,
    "tune.md": to_be_tuned,
    "README.md": to_be_tuned,
}
"""What stands there before a page's blocks are run; `plain` for all other pages."""
