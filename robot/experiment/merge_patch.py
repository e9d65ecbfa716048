"""JSON Merge Patch (RFC 7396) of an experiment's document."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal, get_args, get_origin

from pydantic.fields import FieldInfo

from slidetune.robot.errors import FieldError, InvalidExperimentError, unknown_lane
from slidetune.robot.fields.plain_values import UnfitError, plain_values
from slidetune.robot.goals.section import GOALS
from slidetune.robot.laws import LAWS
from slidetune.robot.motion.recorded import RecordedTrajectory
from slidetune.robot.motion.trajectory import (
    CircleTrajectory,
    HoldTrajectory,
    QuinticTrajectory,
    SineTrajectory,
)

Document = dict[str, Any]

_TRAJECTORIES = {
    "sine": SineTrajectory,
    "quintic": QuinticTrajectory,
    "hold": HoldTrajectory,
    "circle": CircleTrajectory,
    "recorded": RecordedTrajectory,
}


def merged_values(target: Any, patch: Any) -> Any:
    """Return plain values changed by a JSON Merge Patch (RFC 7396), whatever they stand for."""
    if not isinstance(patch, Mapping):
        return patch
    merged = dict(target) if isinstance(target, Mapping) else {}
    for key, value in patch.items():
        if value is None:
            merged.pop(key, None)
        else:
            merged[key] = merged_values(merged.get(key), value)
    return merged


def _fitting(before: Any, after: Any, patch: Any, tag: str, known: Mapping[str, Any]) -> Any:
    """Drop what a newly chosen variant doesn't know, unless the patch itself names it."""
    if not isinstance(before, Mapping) or not isinstance(after, Mapping):
        return after
    variant = after.get(tag)
    if variant == before.get(tag) or not isinstance(variant, str) or variant not in known:
        return after
    fields = known[variant].model_fields
    old = known[before[tag]].model_fields if before.get(tag) in known else {}
    return {
        key: value
        for key, value in after.items()
        if key in patch
        or (key in fields and _is_offered(fields[key], value) and _alike(key, old, fields))
    }


def _is_offered(field: FieldInfo, value: Any) -> bool:
    """Tell whether a choice offers that value; other fields say themselves what they refuse."""
    return get_origin(field.annotation) is not Literal or value in get_args(field.annotation)


def _alike(key: str, old: Mapping[str, FieldInfo], new: Mapping[str, FieldInfo]) -> bool:
    """Tell whether a number means the same in both: it has one unit."""
    extras = [fields[key].json_schema_extra for fields in (old, new) if key in fields]
    units = {extra.get("unit") for extra in extras if isinstance(extra, Mapping)}
    return len(units) <= 1


def _renamed_in_place(before: Document, after: Document) -> Document:
    gone = [name for name in before if name not in after]
    new = [name for name in after if name not in before]
    if len(gone) != 1 or len(new) != 1:
        return after
    order = [new[0] if name == gone[0] else name for name in before]
    return {name: after[name] for name in order}


def _refuse_unknown(changes: Mapping[str, Any], before: Mapping[str, Any]) -> None:
    """Refuse gains for a lane that isn't there: it is misspelt, or a new one without its law."""
    way_out = f". A new lane needs its law, one of {', '.join(LAWS)}"
    unknown = [
        replace(unknown_lane(f"lanes.{name}", name, before, way_out), value=None)
        for name, change in changes.items()
        if name not in before and isinstance(change, Mapping) and "law" not in change
    ]
    if unknown:
        raise InvalidExperimentError(unknown)


def merge_patch(document: Document, patch: Mapping[str, Any]) -> Document:
    """Return ``document`` changed by ``patch``; see ``Experiment.patched``.

    ``null`` removes, so that ``torque_limit: null`` takes it back to its default, which is "off".

    Raises:
        InvalidExperimentError: for a patch that no document could hold, such as one nested too
            deep, or one of a lane that isn't there.
    """
    try:
        patch = plain_values(patch)
    except UnfitError as error:
        raise InvalidExperimentError([FieldError(error.path, f"the patch {error}")]) from error
    merged: Document = merged_values(document, patch)
    if not isinstance(patch, Mapping):
        return merged
    lanes, changes = merged.get("lanes"), patch.get("lanes")
    if isinstance(lanes, dict) and isinstance(changes, Mapping):
        before = document["lanes"]
        _refuse_unknown(changes, before)
        law_lanes = {name: law.lane for name, law in LAWS.items()}
        fitted = {
            name: _fitting(before.get(name), lane, changes.get(name) or {}, "law", law_lanes)
            for name, lane in lanes.items()
        }
        merged["lanes"] = _renamed_in_place(before, fitted)
    goals, changes = merged.get("goals"), patch.get("goals")
    if isinstance(goals, dict) and isinstance(changes, Mapping):
        before = document.get("goals", {})
        fitted = {
            name: _fitting(before.get(name), goal, changes.get(name) or {}, "kind", GOALS)
            for name, goal in goals.items()
        }
        merged["goals"] = _renamed_in_place(before, fitted)
    if isinstance(patch.get("trajectory"), Mapping):
        merged["trajectory"] = _fitting(
            document["trajectory"], merged["trajectory"], patch["trajectory"], "kind", _TRAJECTORIES
        )
    return merged


def difference(before: Any, after: Any) -> Any:
    """Return the merge patch that turns one document into another.

    Args:
        before: a document.
        after: another.

    Returns:
        The patch; an empty mapping if they are equal.
    """
    if not isinstance(before, Mapping) or not isinstance(after, Mapping):
        return after
    patch: Document = {key: None for key in before if key not in after}
    for key, value in after.items():
        if key not in before:
            patch[key] = value
        elif before[key] != value:
            patch[key] = difference(before[key], value)
    return patch
