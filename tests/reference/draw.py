"""Draws the experiments that are held against the reference."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any

import numpy as np

from slidetune.robot.arm.section import Robot
from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.experiment.simulation import Simulation
from slidetune.robot.fields.quantity import JOINTS
from tests.trust.random_experiment import Draw

Document = dict[str, Any]

HORIZON = 1.0
_STEERED = ("paper", "paper-undisturbed", "experiment-quintic", "realistic", "chattering-tanh")
_SECTIONS = (
    ("robot", ("inertia_scale", "armature", "viscous_friction", "coulomb_friction")),
    ("trajectory", ("amplitude", "angular_frequency", "duration")),
    ("disturbance", ("constant", "nominal_mismatch")),
)


LAWS = ("rbfnn_nftsm", "rbfnn_smc", "nftsm", "smc", "computed_torque")
"""Laws that the reference knows: those without a memory of their own."""
_SAMPLED_ALONE = ("implicit",)
"""Options that in continuous mode are another one."""
_WORLD = (
    (Disturbance, "disturbance.sine", ("amplitude", "frequency", "phase")),
    (Disturbance, "disturbance.pulse", ("amplitude", "duration")),
    (Disturbance, "disturbance.noise", ("amplitude", "bandwidth")),
    (Robot, "robot.payload", ("mass",)),
    (Robot, "robot", ("torque_limit",)),
    (Simulation, "simulation", ("initial_error",)),
)


def by_hand(seed: int) -> Document:
    """Return a lane of a shipped preset with one to four sliders moved."""
    dice = random.Random(seed)
    preset, name, patch = _steered(dice)
    lane = patch["lanes"][name]
    sliders = [("lane", key) for key in _numbers(type(preset.lanes[name])) if key not in "pk"]
    for section, keys in _SECTIONS:
        known = _numbers(type(getattr(preset, section)))
        sliders += [(section, key) for key in keys if key in known]
    for section, key in dice.sample(sliders, dice.randint(1, 4)):
        kind = type(preset.lanes[name] if section == "lane" else getattr(preset, section))
        value = _placed(dice, _numbers(kind)[key])
        (lane if section == "lane" else patch.setdefault(section, {}))[key] = value
    if "switching" in type(preset.lanes[name]).model_fields:
        if dice.random() < 0.3:
            lane["switching"] = dice.choice(["tanh", "saturation", "sign"])
        if dice.random() < 0.3:
            lane["reaching"] = dice.choice(["exponential", "constant", "power"])
    return preset.patched(patch).document()


def in_its_world(seed: int) -> Document:
    """Return a lane of a shipped preset, its world moved in one to three places and one gain."""
    dice = random.Random(seed)
    preset, name, patch = _steered(dice)
    kind = type(preset.lanes[name])
    key = dice.choice([key for key in _numbers(kind) if key not in "pk"])
    patch["lanes"][name][key] = _placed(dice, _numbers(kind)[key])
    for root, path, keys in dice.sample(_WORLD, dice.randint(1, 3)):
        first, *inner = path.split(".")
        section, place = root, patch.setdefault(first, {})
        for part in inner:
            section, place = section.model_fields[part].annotation, place.setdefault(part, {})
        numbers = _numbers(section)
        place.update({key: _placed(dice, numbers[key]) for key in keys})
        if path == "disturbance.pulse":
            place["start"] = dice.uniform(0.0, 0.9)
        if path == "robot.payload":
            place["known"] = dice.random() < 0.5
    return preset.patched(patch).document()


def widely(seed: int) -> Document:
    """Return an experiment drawn over all bounds, of the law whose turn it is."""
    law = LAWS[seed % len(LAWS)]
    dice = random.Random(seed)
    for attempt in range(1000):
        drawn = Draw(1000 * seed + attempt, without=_SAMPLED_ALONE, prompt=0.0).document()
        lanes = [lane for lane in drawn["lanes"].values() if lane["law"] == law]
        if not lanes:
            continue
        drawn["lanes"] = {"A": lanes[0]}
        start = {key: drawn["simulation"][key] for key in ("initial_velocity", "initial_error")}
        drawn["simulation"] = {**_simulation(), **start}
        if dice.random() < 2 / 3:
            drawn["robot"].update(viscous_friction=0.0, coulomb_friction=0.0)
        if dice.random() < 2 / 3:
            drawn["robot"]["torque_limit"] = None
        if dice.random() < 2 / 3:
            drawn["robot"]["payload"]["mass"] = 0.0
        lag = np.broadcast_to(drawn["robot"]["lag"], JOINTS)
        # The reference has a lag at every joint or at none.
        drawn["robot"]["lag"] = np.maximum(lag, 2e-4).tolist() if dice.random() < 0.5 else 0.0
        drawn["disturbance"]["pulse"]["start"] = dice.uniform(0.0, 1.0)
        try:
            experiment = Experiment.from_document(drawn)
            pack(experiment)  # refuses a circle that the arm can't follow
            return experiment.document()
        except InvalidExperimentError:
            continue
    raise AssertionError("no draw was valid")


def _steered(dice: random.Random) -> tuple[Experiment, str, Document]:
    """Return a shipped preset, the name of one of its lanes, and a patch that leaves that alone."""
    # Its texts may be written anew without another solution.
    preset = load_preset(dice.choice(_STEERED)).patched({"title": "", "description": ""})
    name = dice.choice(list(preset.lanes))
    others = {other: None for other in preset.lanes if other != name}
    return preset, name, {"lanes": {name: {}, **others}, "simulation": _simulation()}


def _simulation() -> Document:
    return {"mode": "continuous", "step": 0.001, "scheme": "extrapolated", "horizon": HORIZON}


def _numbers(section: Any) -> dict[str, Document]:
    """Return the numeric fields of a section with their bounds."""
    extras = {key: field.json_schema_extra for key, field in section.model_fields.items()}
    return {key: extra for key, extra in extras.items() if extra and "minimum" in extra}


def _placed(dice: random.Random, extra: Document) -> float:
    """Return a random place of a slider."""
    low, high = float(extra["minimum"]), float(extra["maximum"])
    if extra.get("scale") == "log":
        return min(max(math.exp(dice.uniform(math.log(low), math.log(high))), low), high)
    return dice.uniform(low, high)


DRAWS: dict[str, Callable[[int], Document]] = {
    "hand": by_hand,
    "wide": widely,
    "world": in_its_world,
}
"""How the experiments of each origin are drawn from a seed."""
