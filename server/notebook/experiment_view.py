"""An experiment as a notebook shows it: the gains of its lanes, and what makes it another one."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import lru_cache
from typing import Any

from slidetune.robot.arm.known import arm_named
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.merge_patch import difference
from slidetune.robot.experiment.presets import load_preset, presets
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.verdict import said
from slidetune.server.notebook.view import Table, View

NONE = "—"
MOST_DIFFERENCES = 40
"""Fields of an experiment that differ from a preset's (*ours*): with more it is another one."""


def experiment_view(experiment: Experiment) -> View:
    """Return lanes with law and gains, goals, and what differs from the nearest shipped preset."""
    arm, simulation = arm_named(experiment.robot.model), experiment.simulation
    title = experiment.title or "Untitled experiment"
    about = f"{arm.title}, {experiment.trajectory.kind}, {simulation.horizon:g} s"
    lanes = tuple(
        (name, LAWS[lane.law].title if lane.law in LAWS else lane.law, _gains(lane))
        for name, lane in experiment.lanes.items()
    )
    tables = [Table(("lane", "law", "gains"), lanes, words=True)]
    if experiment.goals:
        goals = tuple(
            (name, said(goal, arm.slides), goal.priority) for name, goal in experiment.goals.items()
        )
        tables.append(Table(("goal", "bound", "priority"), goals, words=True))
    tables += _differences(experiment)
    return View(f"{title}: {about}, {simulation.mode}", (), tuple(tables))


def _gains(lane: Any) -> str:
    values = lane.model_dump(mode="json")
    return ", ".join(f"{name} {_text(value)}" for name, value in values.items() if name != "law")


def _text(value: Any) -> str:
    if isinstance(value, bool) or value is None:
        return {True: "on", False: "off", None: NONE}[value]
    if isinstance(value, float | int):
        return f"{value:.6g}"
    if isinstance(value, list):
        return f"({', '.join(map(_text, value))})"
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


@lru_cache(maxsize=1)
def _shipped() -> dict[str, dict[str, Any]]:
    return {one.name: load_preset(one.name).document() for one in presets() if one.shipped}


def _differences(experiment: Experiment) -> list[Table]:
    """Return what differs from the shipped preset that is nearest, if one is near at all."""
    document = _without_words(experiment.document())
    found = {
        name: list(_leaves(difference(_without_words(base), document), base))
        for name, base in _shipped().items()
    }
    name = min(found, key=lambda one: len(found[one]))
    changed, base = found[name], _shipped()[name]
    if not 0 < len(changed) <= MOST_DIFFERENCES:
        return []
    rows = tuple((".".join(path), _at(base, path), _at(document, path)) for path in changed)
    return [Table(("field", f"preset {name}", "here"), rows, words=True)]


def _without_words(document: dict[str, Any]) -> dict[str, Any]:
    words = ("title", "description")
    return {name: value for name, value in document.items() if name not in words}


def _leaves(patch: Any, base: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Yield the paths of what differs; what is new as a whole is one path."""
    if not isinstance(patch, dict) or not isinstance(base, dict):
        yield path
        return
    for name, value in patch.items():
        yield from _leaves(value, base.get(name), (*path, name))


def _at(document: Any, path: tuple[str, ...]) -> str:
    for name in path:
        if not isinstance(document, dict) or name not in document:
            return NONE
        document = document[name]
    return _text(document)
