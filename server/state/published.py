"""What the server says of the laws and fields that there are."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from slidetune.robot.arm.known import SHIPPED, arm_named
from slidetune.robot.arm.known_arm import KnownArm
from slidetune.robot.experiment.document import LONGEST_LANE_NAME, Experiment
from slidetune.robot.experiment.preset_name import LONGEST_NAME
from slidetune.robot.fields.quantity import PER_JOINT
from slidetune.robot.fields.units import ANGLES, unit_of_joints
from slidetune.robot.laws import LAWS
from slidetune.robot.lessons.lesson import MOST_EXAGGERATION
from slidetune.robot.loop.figures import FIGURES

_END = "end"
"""The pose that is not the one to begin from."""


def law_infos() -> list[dict[str, Any]]:
    """Return name, title and summary of every law."""
    names = ("name", "title", "summary", "model_based", "network", "version")
    return [{name: getattr(law, name) for name in names} for law in LAWS.values()]


def arm_info(arm: KnownArm) -> dict[str, Any]:
    """Return name, title and joints of an arm."""
    joints = zip(arm.joint_names, arm.slides, strict=True)
    return {
        "name": arm.name,
        "title": arm.title,
        "meaning": arm.meaning,
        "joints": [{"name": name, "slides": slides} for name, slides in joints],
    }


def published_schema(model: str) -> dict[str, Any]:
    """Return the JSON Schema of an experiment with what else its readers need.

    Args:
        model: the arm that it is for: its number of joints, their units and poses stand in it.
    """
    arm = arm_named(model)
    schema = Experiment.model_json_schema()
    for name, field in _fields(schema):
        _fit(name, field, arm)
    figures = [figure.document() for figure in FIGURES.values()]
    for figure in figures:
        figure["unit"] = unit_of_joints(figure["unit"], arm.slides)
        figure["shown_unit"] = unit_of_joints(figure["shown_unit"], arm.slides)
    return {
        **schema,
        "x-laws": law_infos(),
        "x-figures": figures,
        "x-arm": arm_info(arm),
        "x-bounds": {
            "lane_name": LONGEST_LANE_NAME,
            "preset_name": LONGEST_NAME,
            "exaggeration": MOST_EXAGGERATION,
        },
    }


def _fields(schema: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for part in (schema, *schema["$defs"].values()):
        yield from part.get("properties", {}).items()


def _fit(name: str, field: dict[str, Any], arm: KnownArm) -> None:
    """Let a field be that of an arm."""
    if "unit" in field and name not in ANGLES:
        field["unit"] = unit_of_joints(field["unit"], arm.slides)
    for shape in (field, *field.get("anyOf", ())):
        if shape.get(PER_JOINT):
            shape["minItems"] = shape["maxItems"] = arm.joints
    if arm.name != SHIPPED and field.get(PER_JOINT) and isinstance(field.get("default"), list):
        field["default"] = list(arm.away if name == _END else arm.home)
