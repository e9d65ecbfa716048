"""What a study is told on the command line: a YAML file, and options that count more."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.plain_yaml import PlainDocument, read_plain_yaml
from slidetune.robot.fields.refusal import field_errors
from slidetune.robot.study.fit import Fitting
from slidetune.robot.study.sweep import Axis, axis
from slidetune.robot.study.tuning import Tuning, told

MOST_AXES = 2
"""More than two fields make no picture (*ours*)."""


def wanted_tuning(experiment: Experiment, file: str, given: Mapping[str, Any]) -> Tuning:
    """Return what a search is told.

    Args:
        experiment: whose first lane it is where none is named, and whose uncertainty is drawn from.
        file: a YAML file with the fields of ``Tuning``, or an empty text.
        given: those of the command line; ``None`` for what is not given.

    Raises:
        InvalidExperimentError: naming every refused field, with the line of the file.
        OSError: if the file can't be read.
    """
    read = read_plain_yaml(Path(file).read_bytes()) if file else PlainDocument({}, {})
    options = {name: value for name, value in given.items() if value is not None}
    try:
        return Tuning.model_validate(told(experiment, {**read.values, **options}))
    except ValidationError as error:
        refused = [
            replace(one, line=None if one.path in options else read.line(one.path))
            for one in field_errors(error, Tuning)
        ]
        raise InvalidExperimentError(refused) from error


def wanted_fitting(file: str, trials: int | None) -> Fitting:
    """Return what a fit is told.

    Args:
        file: a YAML file with the fields of ``Fitting``.
        trials: how many, where that is given on the command line.

    Raises:
        InvalidExperimentError: naming every refused field, with the line of the file.
        OSError: if the file can't be read.
    """
    read = read_plain_yaml(Path(file).read_bytes())
    given = {} if trials is None else {"trials": trials}
    try:
        return Fitting.model_validate({**read.values, **given})
    except ValidationError as error:
        refused = [replace(one, line=read.line(one.path)) for one in field_errors(error, Fitting)]
        raise InvalidExperimentError(refused) from error


def wanted_axes(texts: Sequence[str]) -> list[Axis]:
    """Return the axes of a sweep from texts such as ``k1=10:500:20:log``.

    Raises:
        InvalidExperimentError: for more than two, or one that isn't of this form.
    """
    if len(texts) > MOST_AXES:
        text = f"a sweep has one field or two, got {len(texts)}"
        raise InvalidExperimentError([FieldError("axes", text)])
    return [_axis(text) for text in texts]


def _axis(text: str) -> Axis:
    name, _, rest = text.partition("=")
    parts = rest.split(":")
    logarithmic = len(parts) == 4 and parts[3] == "log"
    try:
        if len(parts) != 3 and not logarithmic:
            raise ValueError
        return axis(name, float(parts[0]), float(parts[1]), int(parts[2]), logarithmic)
    except InvalidExperimentError:
        raise
    except ValueError as error:
        form = "FIELD=LOW:HIGH:COUNT"
        wanted = f"must be {form} or {form}:log, such as k1=10:500:20:log"
        raise InvalidExperimentError([FieldError(name, f"{wanted}, got {text}")]) from error
