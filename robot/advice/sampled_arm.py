"""An arm and gains with which a sampled experiment works, where its own are far from stable.

The published gains hold in continuous time alone: sampled on the bare links they diverge within a
few periods. What works is the arm as it would be built, of the preset ``realistic``, with that
preset's gains of the same laws.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from slidetune.robot.advice.torque_need import required_torque
from slidetune.robot.arm.known import SHIPPED
from slidetune.robot.errors import SlidetuneError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.merge_patch import difference
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.experiment.presets import SHIPPED_FOLDER, read_preset
from slidetune.robot.laws import own_versions
from slidetune.robot.margins.margin import Margin, loop_radius

PRESET = "realistic"
"""The shipped preset whose arm and gains are offered."""


@dataclass(frozen=True)
class SampledArm:
    """A change that makes a sampled experiment work.

    Attributes:
        lanes: those that are unstable as things are, and end in no limit cycle that is known.
        message: what is wrong and what the change sets.
        patch: the merge patch, whole: one edit.
    """

    lanes: tuple[str, ...]
    message: str
    patch: dict[str, Any]


def sampled_arm(packed: Packed) -> SampledArm | None:
    """Return the change that makes a sampled experiment work, where some lane of it can't.

    It is offered only where every lane's loop holds with it and the motors are strong enough for
    the motion. ``None`` elsewhere, where no lane is that unstable, where the arm is that one
    already or another one than the shipped one, and where a law fails.

    Args:
        packed: the experiment as numbers.
    """
    experiment = packed.experiment
    if experiment.simulation.mode != "sampled" or experiment.robot.model != SHIPPED:
        return None
    versions = tuple(own_versions(experiment.lanes).items())
    return _offer(experiment.model_dump_json(), versions)


@lru_cache(maxsize=8)
def _offer(text: str, _: tuple[tuple[str, str], ...]) -> SampledArm | None:
    experiment = Experiment.from_document(json.loads(text))
    try:
        source = read_preset(SHIPPED_FOLDER / f"{PRESET}.yaml")
    except SlidetuneError:
        return None
    # What the arm carries is no part of it.
    robot = source.robot.model_copy(update={"payload": experiment.robot.payload})
    if robot == experiment.robot:
        return None
    packed = pack(experiment)
    wild = tuple(name for name in experiment.lanes if _is_wild(packed, name))
    if not wild:
        return None
    gains = {name: _gains(experiment, name, source) for name in wild}
    if not all(gains.values()):
        return None
    for simulation in _simulations(experiment, source):
        patch: dict[str, Any] = {
            "robot": robot.model_dump(mode="json"),
            "lanes": gains,
            "simulation": simulation,
        }
        try:
            better = experiment.patched(patch)
        except SlidetuneError:
            continue  # such as more steps than a run may have
        if _works(pack(better)):
            change = difference(experiment.document(), better.document())
            return SampledArm(wild, _message(experiment, wild, simulation), change)
    return None


def _judged(packed: Packed, name: str) -> Margin | None:
    """Return how a lane's loop stands; ``None`` where its law fails, which that lane tells."""
    try:
        return loop_radius(packed, name)
    except Exception:
        return None


def _is_wild(packed: Packed, name: str) -> bool:
    margin = _judged(packed, name)
    return margin is not None and not margin.holds and not margin.bounded


def _works(packed: Packed) -> bool:
    limit = packed.experiment.robot.torque_limit
    if limit is not None and not bool(np.all(required_torque(packed) <= limit)):
        return False
    margins = [_judged(packed, name) for name in packed.experiment.lanes]
    return all(margin is not None and margin.holds for margin in margins)


def _simulations(experiment: Experiment, source: Experiment) -> Iterator[dict[str, Any]]:
    """Yield what to set of the simulation: nothing, or rate and delay that the gains are for."""
    yield {}
    rate, delay = source.simulation.control_rate, source.simulation.input_delay
    if (rate, delay) != (experiment.simulation.control_rate, experiment.simulation.input_delay):
        yield {"control_rate": rate, "input_delay": delay}


def _gains(experiment: Experiment, name: str, source: Experiment) -> dict[str, Any]:
    """Return the source's numbers for a lane's gains: those of its law, or one that has them.

    Choices such as the switching function, and switches, stay as they are, and so does the rate of
    an observer: that is one of the disturbance.
    """
    lane = experiment.lanes[name]
    wanted = [key for key, value in lane if isinstance(value, float | tuple)]
    wanted = [key for key in wanted if key != "observer_rate"]
    same = [one for one in source.lanes.values() if one.law == lane.law]
    able = [one for one in source.lanes.values() if all(hasattr(one, key) for key in wanted)]
    if not same and not able:
        return {}
    values = (same or able)[0].model_dump(mode="json")
    return {key: values[key] for key in wanted}


def _message(experiment: Experiment, wild: tuple[str, ...], simulation: dict[str, Any]) -> str:
    every = len(wild) == len(experiment.lanes)
    which = "every lane" if every else ", ".join(wild)
    verb = "is" if every or len(wild) == 1 else "are"
    at = ""
    if simulation:
        rate, delay = simulation["control_rate"], 1e3 * simulation["input_delay"]
        at = f", at {rate:g} Hz with a delay of {delay:g} ms"
    return (
        f"Sampled at {experiment.simulation.control_rate:g} Hz, {which} {verb} unstable on this "
        f"arm. The arm of the preset {PRESET}, with its own link inertias, rotor inertia, friction "
        f"and torque limits, is stable with that preset's gains{at}."
    )
