"""A lane's law as C and as Python: the texts of its terms, one after the other."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from math import isinf

from slidetune.robot.arm.known import arm_named
from slidetune.robot.environment.layout import LIMIT
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.fields.units import unit_of_joints
from slidetune.robot.handover.choices import Gain, choices_of, gains_of
from slidetune.robot.handover.template import written_text
from slidetune.robot.kernels.workspace import NODES
from slidetune.robot.laws import law_of
from slidetune.robot.version import __version__

_PARTS = ("head", "surface", "reaching", "implicit", "network", "observer", "step")
"""The texts of which a law is made, in their order."""
_C_PARTS = (*_PARTS[:5], "equivalent_control", *_PARTS[5:])
_WIDTH = 98
"""Columns of a line of the texts (*ours*)."""


def tuned_gains(packed: Packed, name: str) -> list[Gain]:
    """Return all numbers of a step: the lane's gains, the torque limits and the control period.

    Args:
        packed: a sampled experiment as numbers.
        name: the lane.
    """
    slides = arm_named(packed.experiment.robot.model).slides
    limits = tuple(packed.environment[LIMIT].tolist())
    torque = unit_of_joints("N·m", slides)
    period = packed.experiment.simulation.hold
    return [
        *gains_of(packed.experiment.lanes[name], packed.joints, slides),
        Gain("torque_limit", "τ_max", "Torque limit", torque, "", limits),
        Gain("period", "T", "Control period", "s", "", period),
    ]


def law_texts(packed: Packed, name: str) -> dict[str, str]:
    """Return the files of a lane's law by name: C, Python and their checks.

    Args:
        packed: a sampled experiment as numbers.
        name: the lane, whose law ships with the program.
    """
    lane = packed.experiment.lanes[name]
    choices, gains = choices_of(lane), tuned_gains(packed, name)
    common = common_values(packed, name)
    c = {**common, **_c_values(choices, gains)}
    python = {**common, **_python_values(choices, gains)}
    return {
        "law.h": written_text("c/law.h", choices, c),
        "law.c": "".join(written_text(f"c/{part}.c", choices, c) for part in _C_PARTS),
        "check.c": written_text("c/check.c", choices, c),
        "Makefile": written_text("c/Makefile", choices, c),
        "law.py": "".join(written_text(f"python/{part}.py", choices, python) for part in _PARTS),
        "check.py": written_text("python/check.py", choices, python),
    }


def plain_name(name: str) -> str:
    """Return a lane's name as it may stand in a comment of any language."""
    shown = "".join(letter if letter.isprintable() else "?" for letter in name)
    return shown.replace('"', "'")


def common_values(packed: Packed, name: str) -> dict[str, str]:
    """Return what the texts of every language say of a lane: title, units, numbers of joints."""
    law = law_of(packed.experiment.lanes[name])
    slides = arm_named(packed.experiment.robot.model).slides
    shaped = "shaped" in choices_of(packed.experiment.lanes[name])
    units = {
        "ANGLE": "rad",
        "SPEED": "rad/s",
        "ACCELERATION": "rad/s²",
        "TORQUE": "N·m",
        "INERTIA": "kg·m²",
        "REACH": "rad/s²" if shaped else "N·m",
    }
    return {
        "TITLE": law.title,
        "SUMMARY": law.summary,
        "VERSION": __version__,
        "LANE": plain_name(name),
        "JOINTS": str(packed.joints),
        "NODES": str(NODES),
        **{key: unit_of_joints(unit, slides) for key, unit in units.items()},
    }


def _c_values(choices: frozenset[str], gains: Sequence[Gain]) -> dict[str, str]:
    terminal, exponential = "terminal" in choices, "exponential" in choices
    damping = "gains->k1[i] * terms->S_de[i]" if terminal else "gains->k1[i]"
    x = {"angle": "in->q[j]", "desired": "in->q_d[j]"}
    tuned = [f".{gain.name} = {_c_number(gain.values)}," for gain in gains]
    return {
        "GAINS": _block([_c_member(gain) for gain in gains], 4),
        "TUNED": _block(tuned, 4),
        "K2": "terms->k2[j]" if "adaptive" in choices else "gains->k2[j]",
        "SW": "s" if "sign" in choices else "s, gains->epsilon[j]",
        "Y": "terms->S[j] / terms->S_de[j]" if terminal else "terms->S[j]",
        "DAMPING": damping if exponential else "0.0",
        "X": _chosen(x, choices, "in->q_d[j] - in->q[j]"),
    }


def _c_member(gain: Gain) -> str:
    size = "[LAW_JOINTS]" if isinstance(gain.values, tuple) else ""
    return f"double {gain.name}{size}; /* {gain.described} */"


def _c_number(values: tuple[float, ...] | float) -> str:
    if isinstance(values, tuple):
        return f"{{{', '.join(_c_number(value) for value in values)}}}"
    return "HUGE_VAL" if isinf(values) else repr(float(values))


def _python_values(choices: frozenset[str], gains: Sequence[Gain]) -> dict[str, str]:
    terminal, exponential = "terminal" in choices, "exponential" in choices
    adaptive = "adaptive" in choices
    damping = "gains.k1 * slope" if terminal else "gains.k1"
    x = {"angle": "inputs.q", "desired": "inputs.q_d"}
    kinds = [
        f"{gain.name}: {'Array' if isinstance(gain.values, tuple) else 'float'}" for gain in gains
    ]
    slope = "slope: Array, " if terminal else ""
    return {
        "GAINS": _block([f"{gain.name}: {gain.described}." for gain in gains], 8),
        "FIELDS": _block(kinds, 4),
        "TUNED": _block([f"{gain.name}={_python_number(gain.values)}," for gain in gains], 4),
        "K2": "k2" if adaptive else "gains.k2",
        "K2_PARAMETER": "k2: Array, " if adaptive else "",
        "K2_ARGUMENT": "k2, " if adaptive else "",
        "SW": "s" if "sign" in choices else "s, gains.epsilon",
        "Y": "(s / slope)" if terminal else "s",
        "DAMPING": damping if exponential else "np.zeros(JOINTS)",
        "IMPLICIT_PARAMETERS": f"s: Array, {slope}M: Array, gains: Gains",
        "X": _chosen(x, choices, "e"),
    }


def _python_number(values: tuple[float, ...] | float) -> str:
    if isinstance(values, tuple):
        return f"np.array([{', '.join(_python_number(value) for value in values)}])"
    return "np.inf" if isinf(values) else repr(float(values))


def _chosen(texts: dict[str, str], choices: frozenset[str], otherwise: str) -> str:
    return next((text for choice, text in texts.items() if choice in choices), otherwise)


def _block(lines: Sequence[str], indent: int) -> str:
    """Return lines as a block whose long ones go on, further in, without its last line's end."""
    blank = " " * indent
    wrapped = (
        textwrap.fill(
            line,
            _WIDTH,
            initial_indent=blank,
            subsequent_indent=2 * blank if indent == 4 else f"{blank}    ",
            break_long_words=False,
            break_on_hyphens=False,
        )
        for line in lines
    )
    return "\n".join(wrapped)
