"""What no document may hold is refused before anything walks it."""

from __future__ import annotations

import math
from typing import Any

import pytest

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.plain_values import (
    DEEPEST,
    LONGEST_KEY,
    MOST_KEYS,
    MOST_VALUES,
    UnfitError,
    plain_values,
)


def nested(levels: int, kind: type = dict) -> Any:
    value: Any = 1
    for _ in range(levels):
        value = {"a": value} if kind is dict else [value]
    return value


@pytest.mark.parametrize("kind", [dict, list])
def test_depth_is_bounded(kind: type) -> None:
    assert plain_values(nested(DEEPEST, kind)) == nested(DEEPEST, kind)
    with pytest.raises(UnfitError, match="nested deeper") as caught:
        plain_values(nested(DEEPEST + 1, kind))
    assert caught.value.path.count(".") == DEEPEST - 1


@pytest.mark.parametrize(
    "many",
    [
        {str(number): number for number in range(MOST_KEYS + 1)},
        {"robot": [[[]] * MOST_VALUES]},
        {"lanes": {str(number): {"nu": 1} for number in range(MOST_KEYS // 2)}},
    ],
)
def test_the_number_of_values_is_bounded(many: dict[str, Any]) -> None:
    with pytest.raises(UnfitError, match=r"more than \d000"):
        plain_values(many)
    for take in (Experiment.from_document, Experiment().patched):
        with pytest.raises(InvalidExperimentError, match=r"more than \d000") as caught:
            take(many)
        assert len(caught.value.fields) == 1
    assert plain_values({"a": [1] * (MOST_VALUES - 10)})


def test_whole_numbers_beyond_every_float_are_infinite() -> None:
    assert plain_values({"a": [10**5000, -(10**5000), 2**53]}) == {
        "a": [math.inf, -math.inf, 2**53]
    }


@pytest.mark.parametrize(
    ("key", "text"), [("x" * (LONGEST_KEY + 1), "121 characters"), ("\ud800", "surrogates")]
)
def test_keys_are_short_and_whole(key: str, text: str) -> None:
    with pytest.raises(UnfitError, match=text) as caught:
        plain_values({"lanes": {key: None}})
    assert caught.value.path == "lanes"


@pytest.mark.parametrize(
    "document",
    [
        {"robot": nested(5000)},
        {"title": nested(5000, list)},
        {"lanes": {"A": {"law": nested(5000)}}},
        {"trajectory": {"kind": 10**5000}},
        {"lanes": {"A": {"law": 10**5000}}},
        {"slidetune": 10**5000},
        {"x" * 1_000_000: 1},
        nested(5000),
    ],
)
def test_an_unfit_document_or_patch_is_refused_shortly(document: Any) -> None:
    for take in (Experiment.from_document, Experiment().patched):
        with pytest.raises(InvalidExperimentError) as caught:
            take(document)
        assert 10 < len(str(caught.value)) < 600


def test_a_patch_removes_no_lane_whose_name_cannot_be_told() -> None:
    for key in ("\ud800", "x" * 200_000):
        with pytest.raises(InvalidExperimentError, match="the patch contains a key"):
            Experiment().patched({"lanes": {key: None}})
