"""A study as a file: itself in YAML, its entries as CSV or Parquet, its best gains as a preset."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import Any, Literal

from arro3.core import Array, DataType, Field, Schema, Table
from arro3.io import write_parquet
from ruamel.yaml import YAML
from ruamel.yaml.scalarstring import DoubleQuotedScalarString

from slidetune.robot.arm.known import arm_named
from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.plain_yaml import is_plain_text
from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from slidetune.robot.fields.units import unit_of_joints
from slidetune.robot.loop.figures import FIGURES
from slidetune.robot.study.results import axes_of, result_of, table_of
from slidetune.robot.study.study import Entry, Study
from slidetune.robot.study.sweep import Axis
from slidetune.robot.study.tune import Trial, best_of

Format = Literal["yaml", "csv", "parquet", "preset"]
MEDIA: dict[Format, str] = {
    "yaml": "application/yaml",
    "csv": "text/csv",
    "parquet": "application/vnd.apache.parquet",
    "preset": "application/yaml",
}
SUFFIXES: dict[Format, str] = {
    "yaml": "yaml",
    "csv": "csv",
    "parquet": "parquet",
    "preset": "preset.yaml",
}
_WHOLE, _TRUTH, _WORDS = {"number", "draws"}, {"kept", "beaten"}, {"refused"}


def download(
    study: Study, title: str, entries: Sequence[Entry], format: Format, trial: int | None = None
) -> tuple[bytes, str]:
    """Return a study as the content of a file, and its media type.

    Args:
        study: what was wanted.
        title: what people call it.
        entries: its first ones.
        format: which kind of file.
        trial: number of the trial whose gains a preset has; ``None`` for the best one's.

    Raises:
        InvalidExperimentError: if a preset is asked for of what found no gains, or of a trial that
            there is not.
    """
    writers = {"csv": csv_of, "parquet": parquet_of}
    if format == "preset":
        content = _preset(study, entries, trial)
    elif format == "yaml":
        content = _document(study, title, entries)
    else:
        content = writers[format](study.experiment, entries, axes_of(study))
    return content, MEDIA[format]


def unit_of(column: str, slides: Sequence[bool] = ()) -> str:
    """Return the unit of a column of ``table_of``, empty for none or where it is the field's.

    Args:
        column: its name.
        slides: which joints of the arm slide.
    """
    return unit_of_joints(FIGURES[column].unit, slides) if column in FIGURES else ""


def csv_of(experiment: Experiment, entries: Sequence[Entry], axes: Sequence[Axis] = ()) -> bytes:
    """Return entries as CSV, one a line, SI units in the heading.

    Args:
        experiment: what was studied.
        entries: of one study.
        axes: those of a sweep.
    """
    table = table_of(entries, axes)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    slides = arm_named(experiment.robot.model).slides
    units = {name: unit_of(name, slides) for name in table}
    writer.writerow(f"{name} [{unit}]" if unit else name for name, unit in units.items())
    for row in zip(*table.values(), strict=True):
        writer.writerow("" if cell is None else cell for cell in row)
    return text.getvalue().encode()


def parquet_of(
    experiment: Experiment, entries: Sequence[Entry], axes: Sequence[Axis] = ()
) -> bytes:
    """Return entries as a Parquet file; each column's ``unit`` is in its metadata.

    Args:
        experiment: what was studied.
        entries: of one study.
        axes: those of a sweep.
    """
    table = table_of(entries, axes)
    slides = arm_named(experiment.robot.model).slides
    units = {name: unit_of(name, slides) for name in table}
    fields = [Field(name, _type(name), metadata={"unit": unit}) for name, unit in units.items()]
    columns = [Array(table[one.name], one.type) for one in fields]
    file = io.BytesIO()
    write_parquet(Table.from_arrays(columns, schema=Schema(fields)), file)
    return file.getvalue()


def _type(column: str) -> DataType:
    if column in _WHOLE:
        return DataType.int64()
    if column in _TRUTH:
        return DataType.bool()
    return DataType.string() if column in _WORDS else DataType.float64()


def _document(study: Study, title: str, entries: Sequence[Entry]) -> bytes:
    """Return what begins the study again where it is sent to ``POST /api/studies``, and more."""
    document = {
        "kind": study.kind,
        "title": title,
        "wanted": study.wanted.model_dump(mode="json"),
        "experiment": study.experiment.document(),
        "result": result_of(study, entries),
    }
    yaml = YAML()
    yaml.default_flow_style = None
    text = io.BytesIO()
    yaml.dump(_quoted(document), text)
    return text.getvalue()


def _quoted(value: Any) -> Any:
    """Return plain values with quotes around every text that would be read as something else."""
    if isinstance(value, dict):
        return {_quoted(key): _quoted(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_quoted(item) for item in value]
    if isinstance(value, str) and not is_plain_text(value):
        return DoubleQuotedScalarString(value)
    return value


def _preset(study: Study, entries: Sequence[Entry], number: int | None) -> bytes:
    trials = [one for one in entries if isinstance(one, Trial)]
    best = best_of(trials)
    if best is None:
        text = "this study found no gains to write: a preset is what a search comes to"
        raise InvalidExperimentError([FieldError("format", text, "preset")])
    if number is not None and number >= len(trials):
        text = f"must be the number of a trial, 0 to {len(trials) - 1}, got {number}"
        raise InvalidExperimentError([FieldError("trial", text, number)])
    chosen = best if number is None else trials[number]
    return experiment_to_yaml(study.experiment.patched(chosen.patch)).encode()
