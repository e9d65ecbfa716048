"""Numbers of an experiment by their path: ``disturbance.constant[2]``, the second joint's."""

from __future__ import annotations

import re
from typing import Any

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.field_path import path_parts

_JOINT = re.compile(r"(.*)\[([1-9])\]", re.DOTALL)


def number_patch(experiment: Experiment, path: str, value: float) -> dict[str, Any]:
    """Return the merge patch that sets a number.

    Args:
        experiment: where the number stands.
        path: dotted keys; with a joint in brackets, counted from 1, that joint's share alone.
        value: the new one; of six without a joint all are set to it.

    Raises:
        InvalidExperimentError: if no number stands there.
    """
    found = _JOINT.fullmatch(path)
    keys, joint = (found[1], int(found[2])) if found else (path, 0)
    parts = path_parts(keys)
    place: Any = experiment.document()
    for part in parts:
        if not isinstance(place, dict) or part not in place:
            raise _refusal(path, f"no number stands at {path}: name one such as robot.payload.mass")
        place = place[part]
    if not isinstance(place, int | float | list) or isinstance(place, bool):
        raise _refusal(path, f"{path} is no number to set")
    patch: Any = value
    joints = experiment.joints
    if joint:
        if joint > joints or not isinstance(place, int | float | list):
            raise _refusal(path, f"{path} has no joint {joint}: joints are 1 to {joints}")
        patch = list(place) if isinstance(place, list) else [place] * joints
        if len(patch) != joints:
            raise _refusal(path, f"{path} has {len(patch)} numbers, not one a joint")
        patch[joint - 1] = value
    for part in reversed(parts):
        patch = {part: patch}
    return dict(patch)


def number_at(experiment: Experiment, path: str) -> float:
    """Return the number at a path; of six without a joint the first.

    Raises:
        InvalidExperimentError: if no number stands there.
    """
    number_patch(experiment, path, 0.0)
    found = _JOINT.fullmatch(path)
    place: Any = experiment.document()
    for part in path_parts(found[1] if found else path):
        place = place[part]
    if isinstance(place, list):
        place = place[int(found[2]) - 1 if found else 0]
    return float(place)


def _refusal(path: str, text: str) -> InvalidExperimentError:
    return InvalidExperimentError([FieldError(path, text)])
