"""Merge patches of an experiment's document."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.merge_patch import merge_patch
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.laws import LAWS

# RFC 7396, appendix A, without the cases whose target is no object.
RFC_EXAMPLES: list[tuple[Any, Any, Any]] = [
    ({"a": "b"}, {"a": "c"}, {"a": "c"}),
    ({"a": "b"}, {"b": "c"}, {"a": "b", "b": "c"}),
    ({"a": "b"}, {"a": None}, {}),
    ({"a": "b", "b": "c"}, {"a": None}, {"b": "c"}),
    ({"a": ["b"]}, {"a": "c"}, {"a": "c"}),
    ({"a": "c"}, {"a": ["b"]}, {"a": ["b"]}),
    ({"a": {"b": "c"}}, {"a": {"b": "d", "c": None}}, {"a": {"b": "d"}}),
    ({"a": [{"b": "c"}]}, {"a": [1]}, {"a": [1]}),
    ({"a": "foo"}, None, None),
    ({"a": "foo"}, "bar", "bar"),
    ({"e": None}, {"a": 1}, {"e": None, "a": 1}),
    ({}, {"a": {"bb": {"ccc": None}}}, {"a": {"bb": {}}}),
]
THREE = {
    "lanes": {
        "first": {"law": "rbfnn_nftsm", "nu": 1.5, "learning_rate": 7.0, "k1": 20.0},
        "second": {"law": "smc", "lambda_": 3.0},
        "third": {"law": "computed_torque"},
    }
}


def three() -> Experiment:
    return Experiment.from_document(THREE)


@pytest.mark.parametrize(("target", "patch", "result"), RFC_EXAMPLES)
def test_examples_of_the_standard(target: Any, patch: Any, result: Any) -> None:
    before = copy.deepcopy(target)
    assert merge_patch(target, patch) == result
    assert target == before


def test_a_patch_changes_what_it_names_and_nothing_else() -> None:
    before = three()
    after = before.patched({"lanes": {"first": {"nu": 30}}, "simulation": {"horizon": 5}})
    expected = before.document()
    expected["lanes"]["first"]["nu"] = 30.0
    expected["simulation"]["horizon"] = 5.0
    assert after.document() == expected
    assert before == three()


def test_an_empty_patch_changes_nothing() -> None:
    assert three().patched({}) == three()


def test_null_takes_a_value_back_to_its_default() -> None:
    limited = Experiment.from_document({"robot": {"torque_limit": 50, "armature": 1.0}})
    freed = limited.patched({"robot": {"torque_limit": None, "armature": None}})
    assert freed == Experiment()


def test_a_lane_is_removed_by_null_whatever_its_name() -> None:
    named = Experiment.from_document({"lanes": {"torque_limit": {"law": "smc"}, **THREE["lanes"]}})
    assert named.patched({"lanes": {"torque_limit": None}}) == three()


def test_a_new_law_drops_the_gains_that_it_does_not_have() -> None:
    lane = three().patched({"lanes": {"first": {"law": "smc"}}}).lanes["first"].model_dump()
    assert lane["law"] == "smc"
    assert lane["k1"] == 20.0
    assert not {"nu", "learning_rate"} & set(lane)


def test_a_new_law_drops_a_choice_that_it_does_not_offer() -> None:
    lane = {"law": "smc", "switching": "implicit", "k1": 9.0}
    experiment = Experiment.from_document({"lanes": {"A": lane}})
    changed = experiment.patched({"lanes": {"A": {"law": "rbfnn_smc"}}}).lanes["A"]
    assert (changed.switching, changed.k1) == ("tanh", 9.0)
    kept = experiment.patched({"lanes": {"A": {"law": "nftsm"}}}).lanes["A"]
    assert kept.switching == "implicit"


def test_a_new_law_keeps_no_gain_that_has_another_unit_there() -> None:
    lane = {"law": "smc", "k1": 70.0, "epsilon": 0.3, "lambda_": 9.0}
    experiment = Experiment.from_document({"lanes": {"A": lane}})
    for law, kept in (("adaptive_smc", 0.3), ("super_twisting", None)):
        changed = experiment.patched({"lanes": {"A": {"law": law}}}).lanes["A"]
        assert changed.k1 == LAWS[law].lane().k1 != 70.0
        assert changed.lambda_ == 9.0
        assert getattr(changed, "epsilon", None) == kept


def test_a_new_law_may_bring_its_own_gains() -> None:
    patch = {"lanes": {"first": {"law": "rbfnn_smc", "lambda_": 8}}}
    lane = three().patched(patch).lanes["first"]
    assert (lane.lambda_, lane.learning_rate) == (8.0, 7.0)


def test_a_patch_that_names_a_foreign_gain_is_refused() -> None:
    with pytest.raises(InvalidExperimentError) as caught:
        three().patched({"lanes": {"first": {"law": "smc", "nu": 2}}})
    assert [field.path for field in caught.value.fields] == ["lanes.first.nu"]


def test_every_law_can_take_the_place_of_every_other() -> None:
    laws = ("rbfnn_nftsm", "rbfnn_smc", "nftsm", "smc", "computed_torque")
    for before in laws:
        experiment = Experiment.from_document({"lanes": {"A": {"law": before}}})
        for after in laws:
            lane = experiment.patched({"lanes": {"A": {"law": after}}}).lanes["A"]
            assert lane == Experiment.from_document({"lanes": {"A": {"law": after}}}).lanes["A"]


def test_a_new_kind_of_trajectory_drops_what_it_does_not_have() -> None:
    kinds = ("sine", "quintic", "hold", "circle")
    for before in kinds:
        experiment = Experiment.from_document({"trajectory": {"kind": before}})
        for after in kinds:
            changed = experiment.patched({"trajectory": {"kind": after}}).trajectory
            assert changed == Experiment.from_document({"trajectory": {"kind": after}}).trajectory


def test_a_renamed_lane_keeps_its_place() -> None:
    lane = three().document()["lanes"]["second"]
    renamed = three().patched({"lanes": {"second": None, "other": lane}})
    assert list(renamed.lanes) == ["first", "other", "third"]
    assert renamed.lanes["other"] == three().lanes["second"]


def test_a_further_lane_comes_last() -> None:
    assert list(three().patched({"lanes": {"new": {"law": "smc"}}}).lanes)[-1] == "new"


@pytest.mark.parametrize(
    "patch",
    [
        [1],
        "text",
        None,
        5,
        {"lanes": "x"},
        {"lanes": {"first": 3}},
        {"lanes": {"first": [1]}},
        {"lanes": {"first": {"law": None}}},
        {"trajectory": {"kind": None}},
        {"trajectory": 4},
        {"lanes": {"first": None, "second": None, "third": None}},
        {"lanes": {"new": {"nu": 1}}},
        {"lanes": {"first": {"law": {"a": 1}}}},
        {"lanes": {"first": {"law": ["smc"]}}},
    ],
)
def test_a_shapeless_patch_is_refused_and_changes_nothing(patch: Any) -> None:
    experiment = three()
    with pytest.raises(InvalidExperimentError):
        experiment.patched(patch)
    assert experiment == three()


def test_gains_of_a_lane_that_is_not_there_are_refused_by_the_names_of_those_that_are() -> None:
    experiment = load_preset("paper")
    with pytest.raises(InvalidExperimentError) as refused:
        experiment.patched({"lanes": {"NFTMS": {"nu": 3.0}}})
    (field,) = refused.value.fields
    assert field.path == "lanes.NFTMS"
    assert all(name in field.message for name in (*experiment.lanes, *LAWS))


PATCHES: list[Any] = [
    {},
    {"title": "x", "lanes": {"first": {"nu": 30, "k1": [1, 2, 3, 4, 5, 6]}}},
    {"lanes": {"second": {"law": "computed_torque"}, "third": None}},
    {"lanes": {"first": None, "new": {"law": "smc"}}},
    {"robot": {"payload": {"mass": 2.0}, "lag": 0.004}, "disturbance": {"constant": 3.0}},
    {"robot": None, "trajectory": {"kind": "hold"}, "simulation": None},
    {"robot": {"model": "jaka_zu5"}, "goals": {"near": {"kind": "figure", "bound": 0.01}}},
    {"uncertainty": {"payload": [0.0, 3.0]}, "simulation": {"mode": "sampled"}},
    {"lanes": {"first": {"nu": -1}}, "robot": {"lag": 9}, "unknown": {"a": 1}},
    {"lanes": {"first": {"k1": [1, 2]}, "third": 5}, "trajectory": "sine"},
    {"robot": {"model": "gone"}, "title": 7},
    {"robot": 3},
    {"lanes": None},
    {"goals": {"near": {"kind": "figure", "bound": -1}, " ": {}}},
    [],
    {1: 2},
]


@pytest.mark.parametrize("patch", PATCHES, ids=str)
def test_what_a_patch_does_not_name_need_not_be_validated_again(patch: Any) -> None:
    """The same comes of it, or the same refusal, as of the whole document."""
    found = []
    for way in (Experiment.patched, whole):
        try:
            made = way(three(), patch)
            found.append((made, made.document(), hash(made)))
        except InvalidExperimentError as error:
            found.append(error.fields)
    assert found[0] == found[1]


def whole(experiment: Experiment, patch: Any) -> Experiment:
    return Experiment.from_document(merge_patch(experiment.document(), patch))
