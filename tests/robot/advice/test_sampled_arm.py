"""The change that makes a sampled experiment work, tried over the whole horizon."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.advice.advice import advice_on
from slidetune.robot.advice.sampled_arm import sampled_arm
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.merge_patch import difference
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import simulate
from tests.reference.draw import by_hand, in_its_world


def sampled(preset: str, **changes: Any) -> Experiment:
    mode = {"simulation": {"mode": "sampled"}}
    return load_preset(preset).patched(mode).patched(changes)


@pytest.mark.parametrize(
    ("preset", "changes"),
    [
        ("paper", {}),
        ("paper-undisturbed", {}),
        ("experiment-quintic", {}),
        ("paper", {"simulation": {"control_rate": 200.0}}),
        ("paper", {"lanes": {"Textbook": {"law": "smc"}, "NFTSM": {"switching": "sign"}}}),
    ],
)
def test_every_lane_runs_to_the_end_with_what_is_offered(
    preset: str, changes: dict[str, Any]
) -> None:
    before = sampled(preset, **changes)
    frozen = [name for name, lane in simulate(before).lanes.items() if lane.freeze]
    offer = sampled_arm(pack(before))
    assert offer is not None
    assert list(offer.lanes) == frozen == list(before.lanes)
    after = before.patched(offer.patch)
    assert not [name for name, lane in simulate(after).lanes.items() if lane.freeze]
    # One edit, and one back.
    assert after.patched(difference(after.document(), before.document())) == before
    assert sampled_arm(pack(after)) is None


def test_what_is_offered_runs_for_any_gains_and_worlds_and_what_was_there_did_not_follow() -> None:
    offers = 0
    for seed in range(24):
        for drawn in (by_hand, in_its_world):
            rate = (250.0, 500.0, 1000.0, 2000.0)[seed % 4]
            simulation = {"mode": "sampled", "control_rate": rate, "horizon": 2.0}
            before = Experiment.from_document(drawn(seed)).patched({"simulation": simulation})
            offer = sampled_arm(pack(before))
            if offer is None:
                continue
            offers += 1
            for name, lane in simulate(before).lanes.items():
                lost = lane.freeze is not None or np.abs(lane.e).max() > 0.1
                assert lost or name not in offer.lanes, (drawn, seed, name)
            for name, lane in simulate(before.patched(offer.patch)).lanes.items():
                assert lane.freeze is None, (drawn, seed, name, lane.freeze)
    assert offers >= 10


def test_a_lane_that_holds_keeps_its_gains_and_the_arm_its_load() -> None:
    payload = {"mass": 2.0}
    lanes = {"Calm": {"law": "computed_torque", "kp": 400.0, "kd": 40.0}}
    before = sampled("paper", lanes=lanes, robot={"payload": payload})
    offer = sampled_arm(pack(before))
    assert offer is not None
    assert "Calm" not in offer.lanes
    after = before.patched(offer.patch)
    assert after.lanes["Calm"] == before.lanes["Calm"]
    assert after.robot.payload == before.robot.payload


@pytest.mark.parametrize(
    "experiment",
    [
        load_preset("paper"),
        sampled("realistic"),
        sampled("realistic", simulation={"control_rate": 60.0}),
        sampled("chattering-tanh"),
        sampled("paper", disturbance={"constant": 100.0}),
        sampled("paper", trajectory={"angular_frequency": 5.0}),
    ],
    ids=["continuous", "works", "that arm", "chatters", "no motor does", "too fast a motion"],
)
def test_nothing_is_offered_that_is_needless_or_would_not_do(experiment: Experiment) -> None:
    assert sampled_arm(pack(experiment)) is None


def test_each_lane_that_diverges_is_told_of_it_once() -> None:
    packed = pack(sampled("paper"))
    for name in packed.experiment.lanes:
        notes = [note for note in advice_on(packed, name) if note.path == "simulation.mode"]
        [note] = notes
        assert note.level == "warning"
        assert note.title == "Use the sampled arm"
        assert "every lane is unstable" in note.message
