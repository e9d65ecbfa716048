"""The gains as parameters of a ros2_control controller."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from math import isinf

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.handover.choices import Gain

CONTROLLER = "slidetune_controller"
"""Name of the controller where none is given (*ours*)."""
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_SETTINGS = ("torque_limit", "period")


def check_controller(name: str) -> None:
    """Refuse what ROS takes for no name of a node.

    Raises:
        InvalidExperimentError: naming what is allowed.
    """
    if not _NAME.fullmatch(name):
        text = f"must be letters, digits and _, and begin with a letter, got {name[:80]!r}"
        raise InvalidExperimentError([FieldError("controller", text, name[:80])])


def gains_yaml(controller: str, law: str, joints: Sequence[str], gains: Sequence[Gain]) -> str:
    """Return the gains in the layout of ROS 2 parameters.

    Args:
        controller: name of the controller's node.
        law: name of the law.
        joints: names of the arm's joints, in the order of all lists.
        gains: what ``tuned_gains`` returned.
    """
    lines = [
        "# Parameters of the controller, for ros2_control: the numbers of law_tuned in law.c.",
        "# Each list has one number a joint, in the order of `joints`; .inf is no limit.",
        f"{controller}:",
        "  ros__parameters:",
        f"    law: {law}",
        f"    joints: [{', '.join(json.dumps(name, ensure_ascii=False) for name in joints)}]",
    ]
    settings = [gain for gain in gains if gain.name in _SETTINGS]
    lines += [_line(gain, 4) for gain in settings]
    lines += ["    gains:"]
    lines += [_line(gain, 6) for gain in gains if gain not in settings]
    return "\n".join(lines) + "\n"


def _line(gain: Gain, indent: int) -> str:
    values = gain.values
    text = _number(values) if isinstance(values, float) else f"[{', '.join(map(_number, values))}]"
    return f"{' ' * indent}{gain.name}: {text} # {gain.described}"


def _number(value: float) -> str:
    """Write a number as a real one of YAML 1.1 and 1.2: with a point, whatever its exponent."""
    if isinf(value):
        return ".inf" if value > 0.0 else "-.inf"
    digits, e, exponent = repr(float(value)).partition("e")
    return f"{digits}{'' if '.' in digits else '.0'}{e}{exponent}"
