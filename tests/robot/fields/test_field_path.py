"""A path says which key it means, whatever is in the keys."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml
from slidetune.robot.fields.field_path import field_path, path_parts


@pytest.mark.parametrize(
    ("parts", "path"),
    [
        (["lanes", "NFTSM", "nu"], "lanes.NFTSM.nu"),
        (["lanes", "Second lane", "nu"], "lanes.Second lane.nu"),
        (["lanes", "nu 0.5", "nu"], 'lanes."nu 0.5".nu'),
        (["lanes", 'the "soft" one', "nu"], r'lanes."the \"soft\" one".nu'),
        (["", "ν"], '"".ν'),
        ([], ""),
    ],
)
def test_only_an_ambiguous_key_is_quoted(parts: list[str], path: str) -> None:
    assert field_path(parts) == path


@given(st.lists(st.text(st.characters(exclude_categories=["Cs"]), max_size=8), max_size=5))
def test_a_path_leads_back_to_its_keys(parts: list[str]) -> None:
    assert path_parts(field_path(parts)) == tuple(parts)


def test_a_lane_with_a_dot_in_its_name_is_told_from_a_nested_one() -> None:
    with pytest.raises(InvalidExperimentError) as caught:
        Experiment.from_document({"lanes": {"a.b": {"law": "nftsm", "nu": -1}}})
    (field,) = caught.value.fields
    assert field.path == 'lanes."a.b".nu'
    assert path_parts(field.path) == ("lanes", "a.b", "nu")


def test_a_dotted_name_finds_its_own_line() -> None:
    text = "lanes:\n  a: {law: smc}\n  a.b:\n    law: nftsm\n    nu: -1\n"
    with pytest.raises(InvalidExperimentError) as caught:
        experiment_from_yaml(text)
    assert [(field.path, field.line) for field in caught.value.fields] == [('lanes."a.b".nu', 5)]
