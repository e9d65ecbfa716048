"""Links that stand for experiments: whole, short, and refused when they are not what they were."""

from __future__ import annotations

import json
import random
import zlib
from base64 import urlsafe_b64encode
from hashlib import sha256
from pathlib import Path

import pytest

from slidetune.robot.errors import InvalidExperimentError, UnknownPresetError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.permalink import read_permalink
from slidetune.robot.experiment.presets import (
    link_to,
    load_preset,
    preset_store,
    read_link,
    save_preset,
)
from tests.trust.random_experiment import Draw

ADDRESS = "http://127.0.0.1:8080/#x="
CHANGED = {"lanes": {"RBFNN-NFTSM": {"nu": 30, "k1": 200}, "NFTSM": {"mu": 0.7}}}


def written(experiment: Experiment) -> str:
    return json.dumps(experiment.document())


def refusal(link: str) -> str:
    with pytest.raises(InvalidExperimentError) as caught:
        read_link(link)
    assert [field.path for field in caught.value.fields] == ["link"]
    return str(caught.value)


def test_every_experiment_comes_back_as_it_was() -> None:
    drawn, arms = 0, ("jaka_zu5", "pendulum", "two_links")
    for seed in range(60):
        try:
            experiment = Experiment.from_document(Draw(seed, arms=arms).document())
        except InvalidExperimentError:
            continue
        drawn += 1
        linked = read_link(ADDRESS + link_to(experiment))
        assert written(linked.experiment) == written(experiment)
    assert drawn > 30


def test_three_gains_of_a_preset_make_a_link_of_less_than_300_characters() -> None:
    experiment = load_preset("paper").patched(CHANGED)
    link = ADDRESS + link_to(experiment)
    assert len(link) < 300
    linked = read_link(link)
    assert linked.preset == "paper"
    assert linked.baseline == load_preset("paper")
    assert load_preset(link) == experiment


def test_a_preset_is_its_name() -> None:
    for info in preset_store().infos():
        if info.shipped:
            link = link_to(load_preset(info.name))
            assert link.startswith(f"1.{info.name}.")
            assert len(link) < 60


def test_the_order_of_lanes_comes_along() -> None:
    document = load_preset("paper").document()
    document["lanes"] = dict(reversed(document["lanes"].items()))
    turned = Experiment.from_document(document)
    assert list(read_link(link_to(turned)).experiment.lanes) == list(turned.lanes)


def test_whatever_is_changed_about_a_link_is_refused() -> None:
    link = link_to(load_preset("paper").patched(CHANGED))
    dice = random.Random(1)
    letters = "ABCDEFabcdef0123456789-_."
    for at in range(len(link)):
        other = dice.choice([letter for letter in letters if letter != link[at]])
        refusal(link[:at] + other + link[at + 1 :])
        refusal(link[:at] + link[at + 1 :])
        if at:
            refusal(ADDRESS + link[:at])
    assert "has format 2" in refusal("2" + link[1:])


def test_an_experiment_that_is_another_one_here_is_said_and_opened_on_demand() -> None:
    link = link_to(load_preset("paper").patched(CHANGED))

    def later(name: str) -> Experiment:
        return load_preset(name).patched({"simulation": {"horizon": 12}})

    with pytest.raises(InvalidExperimentError, match="another version of Slidetune"):
        read_permalink(link, later)
    opened = read_permalink(link, later, despite=True).experiment
    assert opened == later("paper").patched(CHANGED)


def sealed(preset: str, patch: object) -> str:
    """Make a link by hand, as one who knows how may."""
    packer = zlib.compressobj(9, wbits=-15)
    packed = packer.compress(json.dumps(patch).encode()) + packer.flush()
    text = f"1.{preset}.00000000.{urlsafe_b64encode(packed).decode().rstrip('=')}"
    return f"{text}.{sha256(text.encode()).hexdigest()[:8]}"


def test_what_no_experiment_holds_is_refused_by_field() -> None:
    for preset, patch, path in (
        (
            "",
            {**load_preset("paper").document(), "robot": {"model": "ur5-00000000"}},
            "robot.model",
        ),
        ("paper", {"lanes": {"NFTSM": {"nu": -1}}}, "lanes.NFTSM.nu"),
        ("paper", {"gravity": 9.81}, "gravity"),
        ("paper", ["lanes"], "link"),
        ("paper", {"lanes": {"NFTSM": {"nu": float("nan")}}}, "link"),
    ):
        with pytest.raises(InvalidExperimentError) as caught:
            read_link(sealed(preset, patch))
        assert path in [field.path for field in caught.value.fields]


def test_only_presets_that_ship_are_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SLIDETUNE_PRESETS", str(tmp_path))
    save_preset("mine", load_preset("paper"))
    for name in ("mine", "nothing"):
        with pytest.raises(UnknownPresetError):
            read_link(sealed(name, {}))


def test_what_unpacks_to_far_more_than_an_experiment_is_refused() -> None:
    assert "KiB" in refusal(sealed("", {"title": "0" * 5_000_000}))
    assert "at most" in refusal("1" * 100_000)
    deep: dict[str, object] = {}
    for _ in range(500):
        deep = {"lanes": deep}
    with pytest.raises(InvalidExperimentError):
        read_link(sealed("", deep))


def test_a_motion_that_is_too_long_for_a_link_says_so() -> None:
    dice = random.Random(2)
    rows = [" ".join(f"{dice.uniform(-1, 1):.7f}" for _ in range(6)) for _ in range(500)]
    motion = {"kind": "recorded", "waypoints": "\n".join(rows), "spacing": 0.02}
    document = {**load_preset("paper").document(), "trajectory": motion}
    with pytest.raises(InvalidExperimentError, match="export it as YAML"):
        link_to(Experiment.from_document(document))
