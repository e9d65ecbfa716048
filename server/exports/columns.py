"""What is recorded as a table of numbers: every column, each with its unit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slidetune.robot.arm.known import arm_named
from slidetune.robot.fields.units import unit_of_joints
from slidetune.server.exports.recorded import GROUPS, Recorded

Array = np.ndarray
Columns = list[tuple[str, Array]]

AXES = ("x", "y", "z")


def columns_of(recorded: Recorded) -> Columns:
    """Return name with unit and values of every column, such as ``("NFTSM/q1 [rad]", …)``."""
    slides = arm_named(recorded.arm).slides
    columns = [("time [s]", recorded.time)]
    if recorded.revision is not None:
        columns.append(("revision", recorded.revision))
    desired = recorded.desired
    columns += _joints("q_d", "rad", desired["q_d"], slides)
    columns += _joints("v_d", "rad/s", desired["v_d"], slides)
    columns += _axes("flange_d", desired["flange_d"])
    for name, lane in recorded.lanes.items():
        for group, unit in GROUPS:
            columns += _joints(f"{name}/{group}", unit, lane[group], slides)
        columns += _axes(f"{name}/flange", lane["flange"])
    return columns


def _joints(name: str, unit: str, block: Array, slides: Sequence[bool]) -> Columns:
    return [
        (f"{name}{joint + 1} [{unit_of_joints(unit, [slide])}]", block[:, joint])
        for joint, slide in enumerate(slides)
    ]


def _axes(name: str, block: Array) -> Columns:
    return [(f"{name}_{axis} [m]", block[:, index]) for index, axis in enumerate(AXES)]
