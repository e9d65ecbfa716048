"""What was run, in tables: what differs from a shipped preset, and every gain."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from slidetune.robot.arm.known import arm_named
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.field_path import field_path
from slidetune.robot.fields.quantity import Section
from slidetune.robot.fields.units import ANGLES, unit_of_joints
from slidetune.robot.laws import law_of
from slidetune.robot.loop.verdict import said

NONE = "—"
_LONGEST = 60
"""Most characters of a value in a table (*ours*); all of it stands in the YAML."""
_SAID_ABOVE = ("title", "description")

Rows = list[list[str]]
Path = tuple[str, ...]


@dataclass(frozen=True)
class _Leaf:
    """A value of an experiment, and what its field says of it."""

    value: Any
    symbol: str = ""
    title: str = ""
    unit: str = ""


def difference_rows(base: Experiment, experiment: Experiment) -> tuple[list[str], Rows]:
    """Return headings and rows of all values in which an experiment differs from another one.

    A lane or a goal that only one of them has is one row; titles and descriptions are none.

    Args:
        base: the other one.
        experiment: what was run.
    """
    before, after = _leaves_of(base), _leaves_of(experiment)
    old_parts, new_parts = _named_parts(base), _named_parts(experiment)
    rows = []
    for path in dict.fromkeys([*old_parts, *new_parts]):
        old_part, new_part = old_parts.get(path), new_parts.get(path)
        if old_part is None or new_part is None:
            texts = [NONE if part is None else part for part in (old_part, new_part)]
            rows.append([field_path(path), f"a {path[0][:-1]}", *texts, ""])
    whole = {tuple(path) for path in old_parts.keys() ^ new_parts.keys()}
    for path in dict.fromkeys([*before, *after]):
        old, new = before.get(path), after.get(path)
        if path[:2] in whole or path[0] in _SAID_ABOVE or (old and new and old.value == new.value):
            continue
        leaf = new or old
        assert leaf is not None
        name = " ".join(part for part in (leaf.symbol, leaf.title) if part)
        rows.append([field_path(path), name, _text(old), _text(new), leaf.unit])
    return ["field", "name", "preset", "here", "unit"], rows


def _named_parts(experiment: Experiment) -> dict[Path, str]:
    """Return every lane and every goal by its place, with its law, or what it bounds."""
    slides = arm_named(experiment.robot.model).slides
    parts: dict[Path, str] = {}
    for name, lane in experiment.lanes.items():
        parts["lanes", name] = law_of(lane).title
    for name, goal in experiment.goals.items():
        parts["goals", name] = said(goal, slides)
    return parts


def gain_rows(experiment: Experiment) -> tuple[list[str], Rows]:
    """Return headings and rows of every gain: a row a gain, a column a lane.

    Args:
        experiment: what was run.
    """
    slides = arm_named(experiment.robot.model).slides
    lanes = {name: dict(_leaves(lane, (), slides)) for name, lane in experiment.lanes.items()}
    gains: dict[tuple[Path, str, str, str], dict[str, str]] = {}
    for name, leaves in lanes.items():
        for path, leaf in leaves.items():
            if path != ("law",):
                key = path, leaf.symbol, leaf.title, leaf.unit
                gains.setdefault(key, {})[name] = _text(leaf)
    rows = [["", "law", *(law_of(lane).title for lane in experiment.lanes.values()), ""]]
    for (path, symbol, title, unit), values in gains.items():
        texts = (values.get(name, NONE) for name in lanes)
        rows.append([symbol, title or field_path(path), *texts, unit])
    return ["symbol", "gain", *lanes, "unit"], rows


def _leaves_of(experiment: Experiment) -> dict[Path, _Leaf]:
    return dict(_leaves(experiment, (), arm_named(experiment.robot.model).slides))


def _leaves(value: Any, path: Path, slides: tuple[bool, ...]) -> Iterator[tuple[Path, _Leaf]]:
    """Yield every value below one, with its place; a lane or a goal is one itself as well."""
    if isinstance(value, Section):
        for name, info in type(value).model_fields.items():
            inner = getattr(value, name)
            if isinstance(inner, BaseModel | Mapping):
                yield from _leaves(inner, (*path, name), slides)
                continue
            extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
            unit = str(extra.get("unit", ""))
            unit = unit if name in ANGLES else unit_of_joints(unit, slides)
            leaf = _Leaf(inner, str(extra.get("symbol", "")), info.title or name, unit)
            yield (*path, name), leaf
    elif isinstance(value, Mapping):
        for name, inner in value.items():
            yield from _leaves(inner, (*path, str(name)), slides)


def _text(leaf: _Leaf | None) -> str:
    if leaf is None:
        return NONE
    text = value_text(leaf.value)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


def value_text(value: object) -> str:
    """Return a value of an experiment as people read it; every digit that it has."""
    if value is None:
        return "off"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.12g}"
    if isinstance(value, tuple | list):
        return ", ".join(value_text(one) for one in value)
    return str(value)
