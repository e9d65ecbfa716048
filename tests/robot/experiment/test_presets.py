"""The store of presets, and the presets that ship."""

from __future__ import annotations

import errno
import os
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import numpy as np
import pytest

from slidetune.robot.errors import (
    InvalidExperimentError,
    PresetConflictError,
    PresetSyntaxError,
    UnknownPresetError,
)
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_name import is_preset_name, preset_name
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from slidetune.robot.experiment.presets import (
    SHIPPED_FOLDER,
    PresetStorageError,
    PresetStore,
    delete_preset,
    load_preset,
    preset_store,
    presets,
    save_preset,
)
from slidetune.robot.loop.simulate import simulate

SHIPPED = sorted(path.stem for path in SHIPPED_FOLDER.glob("*.yaml"))
MINE = Experiment(title="Mine", description="Look here.")


@pytest.fixture
def store(tmp_path: Path) -> PresetStore:
    """Return a store with one shipped preset and none of the user's."""
    shipped = tmp_path / "shipped"
    shipped.mkdir()
    (shipped / "paper.yaml").write_text(experiment_to_yaml(Experiment()), encoding="utf-8")
    return PresetStore(shipped, tmp_path / "data" / "presets")


@pytest.fixture
def user_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Move the user's folder by the environment variable."""
    monkeypatch.setenv("SLIDETUNE_PRESETS", str(tmp_path / "mine"))
    return tmp_path / "mine"


def test_a_saved_preset_comes_back_equal(store: PresetStore) -> None:
    path = store.save("mine", MINE)
    assert path == store.user / "mine.yaml"
    assert store.load("mine") == MINE
    assert [file.name for file in store.user.iterdir()] == ["mine.yaml"]


def test_a_list_shows_shipped_presets_first(store: PresetStore) -> None:
    store.save("mine", MINE)
    store.save("a-nameless-one", Experiment())
    shown = [(info.name, info.title, info.shipped, info.problem) for info in store.infos()]
    assert shown == [
        ("paper", "paper", True, ""),
        ("a-nameless-one", "a-nameless-one", False, ""),
        ("mine", "Mine", False, ""),
    ]
    assert store.infos()[2].description == "Look here."


def test_an_existing_preset_gives_way_only_on_purpose(store: PresetStore) -> None:
    store.save("mine", MINE)
    with pytest.raises(PresetConflictError, match="mine exists"):
        store.save("mine", Experiment())
    assert store.load("mine") == MINE
    store.save("mine", Experiment(), overwrite=True)
    assert store.load("mine") == Experiment()
    assert [file.name for file in store.user.iterdir()] == ["mine.yaml"]


def test_one_of_many_writers_at_the_same_moment_wins(store: PresetStore) -> None:
    store.save("other", MINE)
    writers = 8
    gate = Barrier(writers)

    def write(number: int) -> int | None:
        gate.wait()
        try:
            store.save("mine", Experiment(title=f"Writer {number}"))
        except PresetConflictError:
            return None
        return number

    with ThreadPoolExecutor(writers) as pool:
        winners = [number for number in pool.map(write, range(writers)) if number is not None]
    assert len(winners) == 1
    assert store.load("mine").title == f"Writer {winners[0]}"
    assert sorted(file.name for file in store.user.iterdir()) == ["mine.yaml", "other.yaml"]


def test_a_file_system_without_hard_links_will_do(
    store: PresetStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    def link(source: str, target: Path) -> None:
        raise PermissionError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "link", link)
    store.save("mine", MINE)
    with pytest.raises(PresetConflictError, match="mine exists"):
        store.save("mine", Experiment())
    assert store.load("mine") == MINE
    assert [file.name for file in store.user.iterdir()] == ["mine.yaml"]


def test_shipped_presets_can_be_neither_replaced_nor_deleted(store: PresetStore) -> None:
    with pytest.raises(PresetConflictError, match="read-only"):
        store.save("paper", MINE, overwrite=True)
    with pytest.raises(PresetConflictError, match="read-only"):
        store.delete("paper")
    assert store.load("paper") == Experiment()
    assert store.is_shipped("paper")
    assert not store.is_shipped("../shipped/paper")


def test_a_deleted_preset_is_gone(store: PresetStore) -> None:
    store.save("mine", MINE)
    store.delete("mine")
    with pytest.raises(UnknownPresetError):
        store.load("mine")
    with pytest.raises(UnknownPresetError):
        store.delete("mine")


def test_an_unknown_name_lists_the_known_ones_and_the_closest(store: PresetStore) -> None:
    store.save("my-gains", MINE)
    with pytest.raises(UnknownPresetError) as caught:
        store.load("papr")
    text = str(caught.value)
    assert text == "no preset 'papr'; did you mean paper? Known: my-gains, paper"


@pytest.mark.parametrize(
    "name",
    ["", "..", "../x", "a/b", "a\\b", "-a", "A", "a.yaml", "a b", "ä", "con", "com1", "a\n",
     "a\x00", "x" * 61],
)  # fmt: skip
def test_a_name_is_never_a_path(store: PresetStore, tmp_path: Path, name: str) -> None:
    before = sorted(tmp_path.rglob("*"))
    assert not is_preset_name(name)
    with pytest.raises(InvalidExperimentError) as caught:
        store.save(name, MINE)
    assert caught.value.fields[0].path == "name"
    with pytest.raises(UnknownPresetError):
        store.load(name)
    with pytest.raises(UnknownPresetError):
        store.delete(name)
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    ("title", "name"),
    [
        ("My gains", "my-gains"),
        ("  ../Étude № 2: ε = 0.03/λ ", "etude-no-2-0-03"),
        ("CON", "con-preset"),
        ("a" * 59 + " b" * 20, "a" * 59),
    ],
)
def test_a_title_makes_a_name(title: str, name: str) -> None:
    assert preset_name(title) == name
    assert is_preset_name(name)


def test_a_title_without_letters_makes_no_name() -> None:
    with pytest.raises(InvalidExperimentError, match="such as my-gains"):
        preset_name("λ → ∞")


def test_a_broken_file_is_listed_with_its_problem(store: PresetStore) -> None:
    store.save("good", MINE)
    (store.user / "bad.yaml").write_text("robot: {payload: {mass: 99}}\n", encoding="utf-8")
    (store.user / "binary.yaml").write_bytes(b"\xff\xfe\x00")
    (store.user / "My gains.yaml").write_text("title: x\n", encoding="utf-8")
    (store.user / "paper.yaml").write_text("title: shadow\n", encoding="utf-8")
    (store.user / "folder.yaml").mkdir()
    (store.user / ".hidden.yaml").write_text("title: x\n", encoding="utf-8")
    problems = {info.name: info.problem for info in store.infos() if not info.shipped}
    assert sorted(problems) == ["My gains", "bad", "binary", "folder", "good", "paper"]
    assert problems["good"] == ""
    assert problems["bad"].startswith("bad.yaml: line 1: robot.payload.mass: ")
    assert "UTF-8" in problems["binary"]
    assert "rename" in problems["My gains"]
    assert "ships" in problems["paper"]
    assert "no preset file" in problems["folder"]
    assert store.load("paper") == Experiment()
    with pytest.raises(InvalidExperimentError, match="line 1"):
        store.load("bad")


def test_an_edit_of_a_file_is_seen(store: PresetStore) -> None:
    path = store.save("mine", MINE)
    assert store.load("mine").title == "Mine"
    path.write_text("title: Yours\n", encoding="utf-8")
    assert store.load("mine").title == "Yours"


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    blocked = PresetStore(tmp_path / "shipped", tmp_path / "file")
    assert blocked.infos() == []
    with pytest.raises(PresetStorageError, match="can't save preset mine"):
        blocked.save("mine", MINE)


def test_the_environment_moves_the_user_folder(user_folder: Path) -> None:
    assert save_preset("mine", MINE) == user_folder / "mine.yaml"
    assert load_preset("mine") == MINE
    assert [info.name for info in presets() if not info.shipped] == ["mine"]
    delete_preset("mine")
    assert [info.name for info in presets() if not info.shipped] == []


def test_without_it_the_folder_is_the_users_own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SLIDETUNE_PRESETS", raising=False)
    assert preset_store().user.name == "presets"
    assert preset_store().user.is_absolute()
    assert preset_store().shipped == SHIPPED_FOLDER


def test_a_path_is_read_from_anywhere(user_folder: Path, tmp_path: Path) -> None:
    path = tmp_path / "Any name.yaml"
    path.write_text(experiment_to_yaml(MINE), encoding="utf-8")
    assert load_preset(path) == MINE
    assert load_preset(str(path)) == MINE
    for missing in (tmp_path / "no.yaml", tmp_path, "x\x00.yaml", "x" * 5000 + ".yaml"):
        with pytest.raises(UnknownPresetError):
            load_preset(missing)
    path.write_bytes(b"#" * 200_000)
    with pytest.raises(PresetSyntaxError, match=r"Any name\.yaml: must be at most 64 KiB"):
        load_preset(path)


def test_the_presets_of_the_documentation_ship() -> None:
    expected = {
        "paper", "paper-undisturbed", "experiment-quintic", "chattering-sign", "chattering-tanh",
        "chattering-tanh-250hz", "realistic",
    }  # fmt: skip
    assert expected <= set(SHIPPED)
    assert [info.problem for info in presets() if info.shipped] == [""] * len(SHIPPED)
    assert list(load_preset("paper").lanes) == ["RBFNN-NFTSM", "RBFNN-SMC", "NFTSM"]


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_preset_is_what_the_writer_makes_of_it(name: str) -> None:
    text = (SHIPPED_FOLDER / f"{name}.yaml").read_text(encoding="utf-8")
    experiment = experiment_from_yaml(text)
    assert is_preset_name(name)
    assert text == experiment_to_yaml(experiment), "write it again with experiment_to_yaml"
    assert experiment.title
    assert 2 <= len(re.findall(r"\.(?=\s)", experiment.description)) <= 7


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_preset_runs(name: str) -> None:
    run = simulate(load_preset(name).patched({"simulation": {"horizon": 0.3}}))
    assert {lane: result.freeze for lane, result in run.lanes.items()} == dict.fromkeys(run.lanes)


@pytest.mark.parametrize(
    ("name", "loud", "smooth"),
    [("chattering-sign", "sign", "tanh"), ("chattering-tanh-250hz", "narrow", "wide")],
)
def test_a_chattering_preset_teaches_its_lesson(name: str, loud: str, smooth: str) -> None:
    lanes = simulate(load_preset(name).patched({"simulation": {"horizon": 2.0}})).lanes
    chattering = {lane: lanes[lane].metrics_since(1.0).chattering for lane in lanes}
    assert chattering[loud] > 100.0 * chattering[smooth]


def test_the_chattering_preset_tells_the_figures_of_its_own_run() -> None:
    preset = load_preset("chattering-sign")
    words = " ".join(preset.description.split())
    told = re.search(r"about (\d+) times the.*errors of (\S+) and (\S+) mrad", words)
    assert told is not None
    metrics = {name: lane.metrics for name, lane in simulate(preset).lanes.items()}
    errors = [f"{1000 * metrics[name].mae.mean():.2f}" for name in ("sign", "tanh")]
    assert list(told.groups()[1:]) == errors
    ratio = metrics["sign"].chattering / metrics["tanh"].chattering
    assert ratio == pytest.approx(float(told[1]), rel=0.05)


def test_the_arms_of_the_tour_differ_as_the_readme_says() -> None:
    run = simulate(load_preset("paper").patched({"simulation": {"horizon": 25.0}}))
    readme = " ".join((SHIPPED_FOLDER.parent / "README.md").read_text(encoding="utf-8").split())
    assert "They soon differ by centimetres, and NFTSM drifts off by decimetres" in readme
    ours, drifting = (run.lanes[name].flange for name in ("RBFNN-NFTSM", "NFTSM"))
    apart = np.linalg.norm(ours - drifting, axis=-1)
    assert 0.02 < apart[run.time < 3.0].max() < 0.1
    assert 0.2 < apart[run.time > 22.0].max() < 1.0


def test_every_lane_of_the_realistic_preset_follows_within_milliradians() -> None:
    run = simulate(load_preset("realistic").patched({"simulation": {"horizon": 3.0}}))
    for lane in run.lanes.values():
        assert lane.metrics_since(1.0).mae.max() < 0.006
        assert (lane.metrics.peak_torque < [150, 150, 150, 28, 28, 28]).all()


@pytest.mark.parametrize(
    ("number", "way_out"),
    [(errno.ENOSPC, "free some space"), (errno.EROFS, "SLIDETUNE_PRESETS"), (errno.EIO, "")],
)
def test_a_failed_save_says_what_to_do_and_keeps_the_old_preset(
    store: PresetStore, monkeypatch: pytest.MonkeyPatch, number: int, way_out: str
) -> None:
    store.save("mine", MINE)

    def fail(_: int) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(PresetStorageError, match=os.strerror(number)) as caught:
        store.save("mine", Experiment(), overwrite=True)
    assert way_out in str(caught.value)
    assert store.load("mine") == MINE
    assert [file.name for file in store.user.iterdir()] == ["mine.yaml"]
