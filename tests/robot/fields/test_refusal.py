"""Refusals say which field, which value, what is allowed, and the way out."""

from __future__ import annotations

import json
from typing import Any

import pytest

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.laws import LAWS

HUGE = 10**5000
CASES: list[tuple[dict[str, Any], str, object, tuple[str, ...]]] = [
    ({"lanes": {"A": {"law": "nftsm", "nu": -1}}}, "lanes.A.nu", -1, ("[0.01, 100] 1/s", "-1")),
    ({"lanes": {"A": {"law": "smc", "k1": "hard"}}}, "lanes.A.k1", "hard", ("number", "hard")),
    ({"lanes": {"A": {"law": "smc", "k1": [1, 2]}}}, "lanes.A.k1", "[1, 2]", ("6 numbers",)),
    ({"lanes": {"A": {"law": "smc", "k1": 1000.001}}}, "lanes.A.k1", 1000.001, ("1000.001",)),
    ({"lanes": {"A": None}}, "lanes.A", None, ("must be a mapping",)),
    ({"lanes": {"A": {}}}, "lanes.A.law", None, ("rbfnn_nftsm", "computed_torque")),
    ({"lanes": {}}, "lanes", "{}", ("at least 1",)),
    ({"lanes": {"a/b": {"law": "smc"}}}, "lanes.a/b", "a/b", ("1 to 40 characters",)),
    ({"trajectory": {"kind": "circle", "radius": 2}}, "trajectory.radius", 2, ("[0.005, 0.5] m",)),
    ({"robot": {"payload": {"mass": -1}}}, "robot.payload.mass", -1, ("[0, 10] kg",)),
    ({"robot": {"payload": {"known": "maybe"}}}, "robot.payload.known", "maybe", ("true or",)),
    ({"robot": {"inertials": "light"}}, "robot.inertials", "light", ("'vendor' or 'datasheet'",)),
    ({"disturbance": {"seed": HUGE}}, "disturbance.seed", None, ("whole number",)),
    ({"simulation": {"horizon": HUGE}}, "simulation.horizon", None, ("[0.1, 120] s",)),
    ({"simulation": {"horizon": 120, "step": 1e-4}}, "simulation.horizon", 120.0, ("200000",)),
    ({"slidetune": 99}, "slidetune", 99, ("1",)),
    ({"title": "x" * 121}, "title", None, ("120 characters",)),
]


def refusals(document: Any) -> tuple[FieldError, ...]:
    with pytest.raises(InvalidExperimentError) as caught:
        Experiment.from_document(document)
    return caught.value.fields


@pytest.mark.parametrize(("document", "path", "value", "parts"), CASES)
def test_refusal_names_field_value_and_what_is_allowed(
    document: dict[str, Any], path: str, value: object, parts: tuple[str, ...]
) -> None:
    (field,) = refusals(document)
    assert field.path == path
    if value is not None:
        assert field.value == value
    for part in parts:
        assert part in f"{field.message} {field.allowed}"


@pytest.mark.parametrize(
    ("document", "path", "hint"),
    [
        ({"robto": {}}, "robto", "did you mean robot?"),
        ({"lanes": {"A": {"law": "nftsm", "inertia_shape": 1}}}, "lanes.A.inertia_shape", "shaped"),
        ({"lanes": {"A": {"law": "nftms"}}}, "lanes.A.law", "did you mean nftsm?"),
        ({"trajectory": {"kind": "sin"}}, "trajectory.kind", "did you mean sine?"),
        ({"simulation": {"horizn": 1}}, "simulation.horizn", "did you mean horizon?"),
        ({"disturbance": {"noise": {"seed": 1}}}, "disturbance.noise.seed", "Known: amplitude"),
    ],
)
def test_an_unknown_name_gets_a_hint_and_the_known_ones(
    document: dict[str, Any], path: str, hint: str
) -> None:
    (field,) = refusals(document)
    assert field.path == path
    assert hint in field.message


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("law", LAWS)
def test_a_lane_named_after_a_law_is_found(name: str, law: str) -> None:
    gain = "kd" if law == "computed_torque" else "k1"
    (field,) = refusals({"lanes": {name: {"law": law, gain: -5}}})
    assert field.path == f"lanes.{name}.{gain}"
    assert field.allowed.startswith("[")


def test_all_bad_fields_are_told_at_once() -> None:
    document = {
        "robot": {"armature": -1},
        "simulation": {"step": 1},
        "lanes": {"A": {"law": "smc", "k1": -1, "k2": -1}},
    }
    paths = {field.path for field in refusals(document)}
    assert paths == {"robot.armature", "simulation.step", "lanes.A.k1", "lanes.A.k2"}


@pytest.mark.parametrize(
    "document",
    [
        {"title": "\ud800"},
        {"\ud800": 1},
        {"lanes": {"\ud800": {"law": "smc"}}},
        [1],
        "text",
        3,
        None,
        {1: 2},
        {"lanes": {1: {"law": "smc"}}},
        {"title": ["x" * 100_000]},
        {"lanes": [HUGE]},
        {"robot": {"\udfff": HUGE}},
    ],
)
def test_refusals_can_be_sent_and_are_short(document: Any) -> None:
    for field in refusals(document):
        text = json.dumps([field.path, field.message, field.value, field.allowed])
        assert len(text.encode()) < 2000
        assert str(field).encode()


def test_a_refused_name_of_a_lane_is_told_once() -> None:
    (field,) = refusals({"lanes": {"a/b": {"law": "smc"}}})
    assert field.message.startswith("a lane's name has 1 to 40 characters")
    assert field.message.count("a/b") == 1
