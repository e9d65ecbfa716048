"""Brings documents of older formats up to date, and refuses those of newer ones by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import FORMAT
from slidetune.robot.fields.written_value import plain_value, written

Document = dict[str, Any]
Migration = Callable[[Document], Document]

MIGRATIONS: dict[int, Migration] = {}
"""From a format to the next: ``MIGRATIONS[1]`` turns a document of format 1 into format 2."""


def migrated(
    document: Document, migrations: Mapping[int, Migration] = MIGRATIONS, current: int = FORMAT
) -> Document:
    """Return a document in the current format; one that names no format counts as current.

    Args:
        document: an experiment's document of any format; left as it is.
        migrations: steps from a format to the next.
        current: format to reach.

    Raises:
        InvalidExperimentError: for a format that can't be read, newer ones above all.
    """
    version = document.get("slidetune", current)
    if not isinstance(version, int) or isinstance(version, bool) or version < 1:
        text = f"the file's format is a whole number from 1 to {current}, got {written(version)}"
        raise _refusal(version, text)
    if version > current:
        text = f"written by a newer Slidetune: format {written(version)}, this one reads up to"
        raise _refusal(version, f"{text} {current}: update Slidetune")
    while version < current:
        if version not in migrations:
            raise _refusal(version, f"format {version} is too old: this one reads format {current}")
        document = migrations[version](dict(document))
        version += 1
    return {**document, "slidetune": current}


def _refusal(version: object, message: str) -> InvalidExperimentError:
    return InvalidExperimentError([FieldError("slidetune", message, plain_value(version))])
