"""The experiment that comes with an arm: composed, tried, and made weaker until it holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import pi
from typing import Any

import numpy as np

from slidetune.robot.arm.known import SHIPPED, KnownArm, arm_named
from slidetune.robot.arm.section import Robot
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.fields.quantity import bounds
from slidetune.robot.fields.units import unit_of_joints
from slidetune.robot.fields.written_value import written
from slidetune.robot.first_experiment.gains import GAMMA, RULED_LAWS, Gains, first_gains, scale_of
from slidetune.robot.first_experiment.motion import OMEGA, Swing, first_motion
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.margins.margin import loop_margin

FIRST_LAWS = ("rbfnn_nftsm", "nftsm", "computed_torque")
"""Laws of the first experiment (*ours*): one that learns the arm, two that know it."""
RATES = (1000.0, 2000.0, 4000.0, 8000.0)
"""Control rates in [Hz] that are tried (*ours*): small and light arms fall faster than others."""
HALVINGS = 3
"""How often the sampling margin is halved at most (*ours*)."""
SETTLED = 2.0
"""From when on the error of a trial counts, in [s] (*ours*)."""
_TRIAL = SETTLED + 2.0 * pi / OMEGA
"""A trial's length in [s]: one whole period."""
TRACKED = 0.1
"""Part of the amplitude that the error may be then (*ours*)."""
_RESERVE = 0.5
"""Part of the greatest stable γ that γ may be (*ours*)."""


@dataclass(frozen=True)
class First:
    """An experiment that comes with an arm.

    Attributes:
        experiment: the experiment.
        remarks: what can't be as it should, in sentences.
    """

    experiment: Experiment
    remarks: tuple[str, ...] = ()


def first_experiment(model: str, laws: Sequence[str] = FIRST_LAWS) -> First:
    """Return an experiment that works with an arm; of the shipped one it is the paper's.

    Args:
        model: name of the arm.
        laws: names of laws that ship with the program, a lane each.

    Raises:
        ValueError: if no arm has that name.
    """
    if model == SHIPPED:
        return First(load_preset("paper"))
    arm = arm_named(model)
    swing = first_motion(arm)
    remarks = _weak_joints(arm, swing)
    limit = None if remarks else _torque_limit(arm)
    document = {
        "title": written(f"{arm.title}, first experiment")[:120],
        "robot": {"model": arm.name, "torque_limit": limit},
        "trajectory": swing.trajectory(),
        "disturbance": {"constant": scale_of(swing, RATES[0]).disturbance.tolist()},
    }
    for rate in RATES:
        document["simulation"] = {"mode": "sampled", "control_rate": rate}
        found = {LAWS[law].title: _held_lane(document, law, swing, rate) for law in laws}
        if all(lane is not None for lane in found.values()):
            break
    lanes = {}
    for law, (title, lane) in zip(laws, found.items(), strict=True):
        lanes[title] = lane or first_gains(law, scale_of(swing, rate))
        if lane is None:
            remarks.append(f"{title} doesn't track the motion to a tenth with the gains it has.")
    described = {**document, "lanes": lanes, "description": _description(remarks)}
    return First(Experiment.from_document(described), tuple(remarks))


def first_lane(model: str, law: str, rate: float = RATES[0]) -> Gains:
    """Return a lane of a law with gains of an arm's size, untried.

    Args:
        model: name of the arm.
        law: name of a law.
        rate: control rate in [Hz].

    Returns:
        Plain JSON values, for a patch; the law alone where its defaults are what there is: for the
        arm that ships, and for a law of one's own.
    """
    if model == SHIPPED or law not in RULED_LAWS:
        return {"law": law}
    return first_gains(law, scale_of(_swing(model), rate))


@lru_cache(maxsize=8)
def _swing(model: str) -> Swing:
    """Keep the last ones: each takes some tenths of a second."""
    return first_motion(arm_named(model))


def _held_lane(document: dict[str, Any], law: str, swing: Swing, rate: float) -> Gains | None:
    """Return a lane at the greatest sampling margin that holds, ``None`` where none does."""
    for halving in range(HALVINGS + 1):
        lane = first_gains(law, scale_of(swing, rate, GAMMA / 2**halving))
        experiment = Experiment.from_document({**document, "lanes": {"lane": lane}})
        if _holds(experiment, swing, rate):
            return lane
    return None


def _holds(experiment: Experiment, swing: Swing, rate: float) -> bool:
    """Whether a lane has half its greatest stable γ as reserve, and tracks within its limits."""
    margin = loop_margin(pack(experiment), "lane")
    if not margin.holds:
        return False
    if margin.gamma is not None and margin.limit is not None:
        reserve = margin.gamma <= min(1.0, _RESERVE * margin.limit)
        if not reserve:
            return False
    run = simulate(experiment.patched({"simulation": {"horizon": _TRIAL}})).lanes["lane"]
    if run.freeze is not None:
        return False
    error = np.abs(run.e[round(SETTLED * rate) :]).max(axis=0)
    limit = experiment.robot.torque_limit
    free = limit is None or bool(np.all(np.abs(run.tau).max(axis=0) < np.array(limit)))
    return free and bool(np.all(error <= TRACKED * swing.amplitude))


def _torque_limit(arm: KnownArm) -> list[float] | None:
    """Return the arm's effort limits as the section ``robot`` takes them; ``None`` without any."""
    low, high = bounds(Robot, "torque_limit")
    effort = np.array(arm.effort)
    return np.clip(effort, low, high).tolist() if np.isfinite(effort).any() else None


def _weak_joints(arm: KnownArm, swing: Swing) -> list[str]:
    """Say which joints can't even hold what they carry."""
    unit = [unit_of_joints("N·m", [slides]) for slides in arm.slides]
    return [
        f"Joint {written(name)} needs {need:.3g} {unit[joint]} for the motion, more than its "
        f"effort limit of {effort:.3g} {unit[joint]}: the experiment has no torque limits. Check "
        "the effort limits and the masses of the description."
        for joint, (name, need, effort) in enumerate(
            zip(arm.joint_names, swing.torque.tolist(), arm.effort, strict=True)
        )
        if not need < effort
    ]


def _description(remarks: Sequence[str]) -> str:
    text = (
        "Made for this arm: sines around a pose within its limits, a disturbance of a tenth of the "
        "torque that they take, and gains scaled from its inertia and the control rate, so that a "
        "sampled loop keeps half its stability margin."
    )
    return " ".join([text, *remarks])[:4000]
