"""A refused value comes back as JSON would write it, and never at length."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.written_value import LONGEST, plain_value, written


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "null"),
        (True, "true"),
        (-3, "-3"),
        (0.5, "0.5"),
        ("soft", "soft"),
        ([1, None, "a"], '[1, null, "a"]'),
        ({"law": "smc", "on": False}, '{"law": "smc", "on": false}'),
        ([[[[1]]]], "[[[…]]]"),
        (list(range(20)), "[0, 1, 2, 3, 4, 5, 6, 7, …]"),
        ("\ud800", "\\ud800"),
        ([10**5000], "[a whole number of more than 40 digits]"),
    ],
)
def test_a_value_is_written_as_in_json(value: Any, text: str) -> None:
    assert written(value) == text


@pytest.mark.parametrize("value", ["x" * 10**6, ["x" * 10**6] * 9, {"k" * 10**6: 1}])
def test_a_long_value_is_cut(value: Any) -> None:
    assert len(written(value)) == LONGEST + 1


def test_what_an_error_carries_is_strict_json() -> None:
    for value in (math.nan, math.inf, -math.inf, 10**5000, "\ud800", [math.nan]):
        assert json.dumps(plain_value(value), allow_nan=False).encode()


def test_a_refusal_speaks_no_python() -> None:
    document = {"lanes": {"A": None}, "title": True, "robot": {"payload": [None]}}
    with pytest.raises(InvalidExperimentError) as caught:
        Experiment.from_document(document)
    assert "None" not in str(caught.value)
    assert "True" not in str(caught.value)
