"""Errors that are raised on purpose."""

from __future__ import annotations

import builtins
import inspect
import pickle

import pytest

from slidetune.robot import errors
from slidetune.robot.errors import (
    FieldError,
    InvalidExperimentError,
    PresetSyntaxError,
    SlidetuneError,
    UnknownPresetError,
    UnreachableError,
)

CHILDREN = [
    kind
    for _, kind in inspect.getmembers(errors, inspect.isclass)
    if issubclass(kind, SlidetuneError) and kind is not SlidetuneError
]
REFUSED = FieldError("lanes.NFTSM.nu", "nu must be in [0.01, 100] 1/s, got 0", 0, "[0.01, 100] 1/s")


@pytest.mark.parametrize("kind", CHILDREN)
def test_every_error_is_also_the_builtin_that_callers_expect(kind: type[Exception]) -> None:
    others = [base for base in kind.__mro__ if base.__module__ == builtins.__name__]
    assert set(others) & {ValueError, KeyError, OSError}


def test_a_field_error_reads_as_a_sentence() -> None:
    assert str(REFUSED) == "lanes.NFTSM.nu: nu must be in [0.01, 100] 1/s, got 0"
    assert str(FieldError("", "must be a mapping", line=3)) == "line 3: must be a mapping"
    assert str(FieldError("a", "b", line=3)) == "line 3: a: b"


def test_all_refused_fields_are_told() -> None:
    error = InvalidExperimentError([REFUSED, FieldError("title", "too long")])
    assert [field.path for field in error.fields] == ["lanes.NFTSM.nu", "title"]
    assert str(error).splitlines() == [str(REFUSED), "title: too long"]


@pytest.mark.parametrize("kind", [InvalidExperimentError, PresetSyntaxError])
def test_refusals_survive_the_way_from_another_process(kind: type[InvalidExperimentError]) -> None:
    error = kind([REFUSED, FieldError("title", "too long", line=7)])
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is kind
    assert copy.fields == error.fields
    assert str(copy) == str(error)


def test_unreachable_path_keeps_the_field_to_blame_between_processes() -> None:
    copy = pickle.loads(pickle.dumps(UnreachableError("singular", field="pose")))
    assert (str(copy), copy.field) == ("singular", "pose")


def test_unknown_preset_is_told_without_quotes() -> None:
    assert str(UnknownPresetError("no preset 'x'")) == "no preset 'x'"
