"""A hand-over over HTTP, through a real server and a process of its own."""

from __future__ import annotations

import io
import json
from pathlib import Path
from zipfile import ZipFile

import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml
from slidetune.robot.handover.self_check import HandOverError
from slidetune.server.guard.limits import MAX_HAND_OVERS
from slidetune.server.handover import apart
from slidetune.server.handover.apart import hand_over_apart
from tests.robot.handover.built import check_everywhere, run_python
from tests.server.conftest import Served

SHORT = {
    "simulation": {"horizon": 0.3, "mode": "sampled"},
    "lanes": {"NFTSM": {"c": 0.5, "nu": 2.0, "k1": 20.0, "k2": 5.0}},
}


def begin(served: Served) -> None:
    served.http.post("/api/presets/paper/load").raise_for_status()
    served.http.patch("/api/experiment", json=SHORT).raise_for_status()


def test_the_archive_is_of_the_live_lane(served: Served, tmp_path: Path) -> None:
    begin(served)
    uncertain = {"uncertainty": {"payload": [0.0, 1.0]}}
    served.http.patch("/api/experiment", json=uncertain).raise_for_status()
    wanted = {"lane": "NFTSM", "controller": "mine", "draws": 3}
    answer = served.http.post("/api/hand-over", json=wanted, timeout=180.0)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "application/zip"
    assert answer.headers["content-disposition"] == 'attachment; filename="NFTSM.zip"'
    with ZipFile(io.BytesIO(answer.content)) as archive:
        archive.extractall(tmp_path)
    folder = tmp_path / "NFTSM"
    assert run_python(folder).returncode == 0
    check_everywhere(folder)
    live = served.app_state.document.experiment
    assert experiment_from_yaml((folder / "experiment.yaml").read_bytes()) == live
    assert "mine:" in (folder / "gains.yaml").read_text(encoding="utf-8")
    conditions = json.loads((folder / "conditions.json").read_text(encoding="utf-8"))
    assert conditions["robustness"]["draws"] == 3


def test_what_is_wrong_is_said(served: Served) -> None:
    begin(served)
    for wanted, path in (
        ({"lane": "none"}, "lane"),
        ({"lane": "NFTSM", "controller": "a b"}, "controller"),
        ({"lane": "NFTSM", "draws": 201}, "draws"),
        ({"lane": "NFTSM", "drawn": 1}, "drawn"),
    ):
        answer = served.http.post("/api/hand-over", json=wanted)
        assert answer.status_code == 422, answer.text
        assert [field["path"] for field in answer.json()["error"]["fields"]] == [path]


def test_what_takes_too_long_is_refused(served: Served) -> None:
    begin(served)
    long = {
        "simulation": {"horizon": 20.0, "plant_substeps": 100},
        "uncertainty": {"payload": [0.0, 1.0]},
    }
    served.http.patch("/api/experiment", json=long).raise_for_status()
    answer = served.http.post("/api/hand-over", json={"lane": "NFTSM", "draws": 100})
    assert answer.status_code == 422
    assert "ask for fewer draws" in answer.json()["error"]["message"]


def test_a_process_that_is_lost_is_told_of(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(apart, "_MODULE", "slidetune.robot.version")
    with pytest.raises(HandOverError, match="what makes it ended the process with exit status 0"):
        hand_over_apart(Experiment(), "RBFNN-NFTSM", "a", 0)


def test_so_many_are_made_at_once(served: Served) -> None:
    assert served.http.get("/api/health").json()["limits"]["hand_overs"] == MAX_HAND_OVERS
