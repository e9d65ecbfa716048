"""Presets that several people save, delete and list at the same time."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier, Event
from typing import Any

import httpx
import pytest
import ruamel.yaml

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.preset_name import is_preset_name
from slidetune.robot.experiment.presets import preset_store
from slidetune.server.guard.limits import TooManyPresetsError
from slidetune.server.state import preset_quota
from slidetune.server.state.preset_quota import save_within_quota
from tests.server.conftest import Served

WEB = Path(__file__).resolve().parents[3] / "web"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Give the user's presets a folder of their own."""
    monkeypatch.setenv("SLIDETUNE_PRESETS", str(tmp_path))
    return tmp_path


def test_saving_against_deleting_never_breaks(served: Served, folder: Path) -> None:
    over = Event()

    def delete() -> set[int]:
        with httpx.Client(base_url=served.url, timeout=60.0, trust_env=False) as other:
            found = set()
            while not over.is_set():
                found.add(other.delete("/api/presets/contested").status_code)
            return found

    with ThreadPoolExecutor(1) as pool:
        deleting = pool.submit(delete)
        answers = [
            served.http.put("/api/presets/contested?overwrite=true", content=b"title: mine")
            for _ in range(30)
        ]
        over.set()
        assert deleting.result(60.0) <= {204, 404}
    assert {answer.status_code for answer in answers} == {200}
    assert {answer.json()["title"] for answer in answers} == {"mine"}


def test_of_many_saves_at_once_as_many_pass_as_there_is_room_for(
    served: Served, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(preset_quota, "MAX_PRESETS", 3)
    experiment, start = served.app_state.document.experiment, Barrier(16)

    def save(number: int) -> bool:
        start.wait(60.0)
        try:
            save_within_quota(preset_store(), f"at-once-{number}", experiment)
        except TooManyPresetsError:
            return False
        return True

    with ThreadPoolExecutor(16) as pool:
        assert sum(pool.map(save, range(16))) == 3
    assert len(list(folder.glob("*.yaml"))) == 3


def test_a_list_reads_again_only_what_has_changed(
    served: Served, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for number in range(205):
        text = f"title: preset {number}\n" if number % 2 else f"broken {number}: 1\n"
        (folder / f"mine-{number}.yaml").write_text(text)
    first = served.http.get("/api/presets").json()
    assert sum(bool(preset["problem"]) for preset in first["presets"]) == 103
    parse, parsed = ruamel.yaml.YAML.parse, []

    def watched(self: ruamel.yaml.YAML, stream: Any) -> Any:
        parsed.append(stream)
        return parse(self, stream)

    monkeypatch.setattr(ruamel.yaml.YAML, "parse", watched)
    assert served.http.get("/api/presets").json() == first
    assert parsed == []
    (folder / "mine-1.yaml").write_text("title: changed\n")
    assert served.http.put("/api/presets/mine-3?overwrite=true").status_code == 200
    assert parsed == []
    served.http.get("/api/presets")
    assert len(parsed) == 2


def test_a_preset_answers_with_what_was_saved(served: Served, folder: Path) -> None:
    saved = served.http.put("/api/presets/mine").json()
    assert saved == served.http.get("/api/presets/mine").json()
    assert saved["experiment"] == served.app_state.document.experiment.document()


def test_the_baseline_is_what_was_saved_and_not_what_came_meanwhile(served: Served) -> None:
    document = served.app_state.document
    beginning, saved = document.present()
    document.patch({"title": "meanwhile"})
    document.saved_as("mine", saved, beginning)
    assert document.preset == "mine"
    assert document.baseline == saved
    assert document.experiment.title == "meanwhile"


def test_a_lane_renamed_while_it_was_saved_still_compares(served: Served) -> None:
    document = served.app_state.document
    beginning, saved = document.present()
    gains = saved.lanes["NFTSM"].model_dump(mode="json")
    document.patch({"lanes": {"NFTSM": None, "Renamed": gains}})
    document.saved_as("mine", saved, beginning)
    assert document.baseline.lanes["Renamed"] == saved.lanes["NFTSM"]


def test_what_was_loaded_while_another_was_saved_keeps_its_own_baseline(served: Served) -> None:
    document = served.app_state.document
    beginning, saved = document.present()
    document.replace(saved.patched({"title": "other"}), preset="other")
    document.saved_as("mine", saved, beginning)
    assert document.preset == "other"
    assert document.baseline.title == "other"


@pytest.mark.parametrize("name", ["a_b", "../evil", "A", "", "-a", "a" * 61, "ä", "a b", "a.yaml"])
def test_a_refused_name_is_refused_with_the_rule(served: Served, folder: Path, name: str) -> None:
    assert not is_preset_name(name)
    with pytest.raises(InvalidExperimentError, match="a-z, 0-9 and -, such as my-gains"):
        save_within_quota(preset_store(), name, served.app_state.document.experiment)


def test_the_page_asks_for_the_names_that_the_server_takes() -> None:
    script = (WEB / "experiment" / "presets.js").read_text(encoding="utf-8")
    assert "/^[a-z0-9][a-z0-9-]{0,59}$/" in script
    assert "Small letters, digits and -;" in script
