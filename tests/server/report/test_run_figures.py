"""The curves of a run as figures of a page."""

from __future__ import annotations

import json
import re
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import Run, simulate
from slidetune.server.live.lane_colors import PALETTE
from slidetune.server.report.figure_page import figure_page
from slidetune.server.report.run_figures import run_sections


@pytest.fixture(scope="module")
def run() -> Run:
    lanes = {"A": {"law": "nftsm"}, "calm": {"law": "computed_torque", "kp": 1, "kd": 1}}
    simulation = {"mode": "sampled", "horizon": 0.5}
    return simulate(Experiment.from_document({"lanes": lanes, "simulation": simulation}))


@pytest.fixture(scope="module")
def sections(run: Run) -> list[Any]:
    data = re.search(r'id="data">(.*?)</script>', figure_page("", "", run_sections(run)), re.DOTALL)
    assert data is not None
    return list(json.loads(data[1]))


def test_every_joint_has_every_quantity_of_every_lane(sections: list[Any]) -> None:
    for section in sections[:5]:
        assert [figure["heading"] for figure in section["figures"]] == [
            f"Joint {joint}" for joint in range(1, 7)
        ]
        for figure in section["figures"]:
            lanes = [curve for curve in figure["curves"] if curve["name"] != "desired"]
            assert [(curve["name"], curve["color"]) for curve in lanes] == [
                ("A", PALETTE[0]), ("calm", PALETTE[1]),
            ]  # fmt: skip


def test_a_diverged_lane_ends_where_it_stopped(run: Run, sections: list[Any]) -> None:
    freeze = run.lanes["A"].freeze
    assert freeze is not None
    stopped, running = sections[1]["figures"][0]["curves"]
    assert stopped["x"][-1] == pytest.approx(freeze.time)
    assert running["x"][-1] == pytest.approx(0.5)
    assert np.isfinite(stopped["y"]).all()
