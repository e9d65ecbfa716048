"""What a lane's law is made of: the names by which its texts are chosen, and the gains it uses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.quantity import PER_JOINT, Section
from slidetune.robot.fields.units import unit_of_joints
from slidetune.robot.laws import SHIPPED, law_of

Array = np.ndarray

_SURFACES = {
    "rbfnn_nftsm": "terminal",
    "nftsm": "terminal",
    "computed_torque": "pd",
    "integral_smc": "integral",
}
"""Sliding variables of the laws; all others have the linear one."""
_FIXED: dict[str, set[str]] = {
    "super_twisting": {"twisting", "sign", "shaped"},
    "adaptive_smc": {"adaptive"},
    "computed_torque": {"shaped"},
}
"""What belongs to a law whatever its gains."""
_SHAPED_UNITS = {
    ("exponential", "k1"): "1/s",
    ("exponential", "k2"): "rad/s²",
    ("constant", "k2"): "rad/s²",
    ("power", "k1"): "rad/s²·(s/rad)^α",
}
_TORQUE_UNITS = {
    ("exponential", "k1"): "N·m·s/rad",
    ("exponential", "k2"): "N·m",
    ("constant", "k2"): "N·m",
    ("power", "k1"): "N·m·(s/rad)^α",
}
"""Units of reaching gains, see the table in docs/notation.md."""
_GROUPS = ("Sliding surface", "PD", "Error equation", "Reaching", "Twisting", "Adaptation")
"""Groups of gains in the order of a step; the network's and the observer's come after them."""
_OTHER_UNITS = {"mu": "(rad/s)^(1-p/k)"}


@dataclass(frozen=True)
class Gain:
    """One gain of a lane that its law uses.

    Attributes:
        name: its key.
        symbol: its sign.
        title: its name in words.
        unit: its unit, empty for none.
        equation: where it stands, such as ``Eq. 5``; empty where nowhere.
        values: a number for each joint, or one alone where the whole arm has one.
    """

    name: str
    symbol: str
    title: str
    unit: str
    equation: str
    values: tuple[float, ...] | float

    @property
    def described(self) -> str:
        """What it is in one line: ``error gain ν [1/s], Eq. 5``."""
        title = self.title[:1].lower() + self.title[1:]
        unit = f" [{self.unit}]" if self.unit else ""
        equation = f", {self.equation}" if self.equation else ""
        return f"{title} {self.symbol}{unit}{equation}"


def check_exportable(experiment: Experiment, name: str) -> None:
    """Refuse a lane that can't be handed over.

    Raises:
        InvalidExperimentError: if there is no such lane, or its law is of a file of one's own.
    """
    lane = experiment.lane(name)
    law = law_of(lane).name
    if law not in SHIPPED:
        text = (
            f"{law} is a law from a file of your own, and only the laws that ship with the program "
            f"can be written in C: {', '.join(sorted(SHIPPED))}"
        )
        raise InvalidExperimentError([FieldError(f"lanes.{name}.law", text, law)])


def portable(experiment: Experiment) -> Experiment:
    """Return an experiment without the lanes that only their own law's file makes run."""
    lanes = {name: lane for name, lane in experiment.lanes.items() if law_of(lane).name in SHIPPED}
    return experiment.model_copy(update={"lanes": lanes})


def choices_of(lane: Section) -> frozenset[str]:
    """Return the names that hold of a lane: see the ``@if`` of the texts.

    Args:
        lane: law and gains of a lane, of a law that ships with the program.
    """
    law = law_of(lane)
    found = {_SURFACES.get(law.name, "linear"), *_FIXED.get(law.name, ())}
    # The remaining choices are called as in the lane itself.
    named = (getattr(lane, key, "") for key in ("switching", "reaching"))
    found.update(str(one) for one in named if one)
    if law.network:
        found.update({"network", str(getattr(lane, "network_input", ""))})
    if law.model_based:
        found.add("model")
    if getattr(lane, "inertia_shaped", False):
        found.add("shaped")
    observer = getattr(lane, "observer", "none")
    if observer != "none":
        found.update({"observer", observer})
    if "power" in found:
        found.discard("adaptive")  # the power reaching law has no k2 that could be adapted
    if {"adaptive", "constant", "sign"} <= found:
        found.add("gainless")  # its reaching law knows all it needs by S and the adapted k2
    if "model" in found and "pd" not in found:
        found.add("slope_e")
        found.update({"slope_de"} if "terminal" in found else ())
    return frozenset(found)


def gains_of(lane: Section, joints: int, slides: tuple[bool, ...]) -> list[Gain]:
    """Return the gains that have an effect, group by group.

    Args:
        lane: law and gains of a lane.
        joints: how many joints the arm has.
        slides: whether each of them slides.
    """
    properties: dict[str, Any] = type(lane).model_json_schema()["properties"]
    choices, gains = choices_of(lane), []
    for name, field in sorted(properties.items(), key=lambda one: _place(one[1])):
        if "minimum" not in field or not _acts(lane, name, field, choices):
            continue
        per_joint = any(shape.get(PER_JOINT) for shape in field.get("anyOf", ()))
        value: Any = getattr(lane, name)
        values = tuple(float(one) for one in np.broadcast_to(value, joints)) if per_joint else value
        unit = unit_of_joints(_unit(lane, name, field), slides)
        known = field.get("symbol", name), field.get("title", name)
        gains.append(Gain(name, *known, unit, field.get("equation", ""), values))
    return gains


def _place(field: dict[str, Any]) -> int:
    group = field.get("group", "")
    return _GROUPS.index(group) if group in _GROUPS else len(_GROUPS)


def _acts(lane: Section, name: str, field: dict[str, Any], choices: frozenset[str]) -> bool:
    """Tell whether a gain has an effect under the lane's choices."""
    if name == "epsilon" and "adaptive" in choices:
        return True  # the adaptation asks whether |S| is beyond it, whatever switches
    if name == "epsilon" and not choices & {"tanh", "saturation"}:
        return False
    needs: dict[str, tuple[str, ...]] = field.get("needs", {})
    return all(getattr(lane, choice) in options for choice, options in needs.items())


def _unit(lane: Section, name: str, field: dict[str, Any]) -> str:
    if not hasattr(lane, "reaching"):
        return str(field.get("unit", _OTHER_UNITS.get(name, "")))
    units = _SHAPED_UNITS if getattr(lane, "inertia_shaped", False) else _TORQUE_UNITS
    own = units.get((lane.reaching, name)) or field.get("unit", _OTHER_UNITS.get(name, ""))
    return str(own)
