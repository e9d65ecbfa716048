"""Under which conditions gains were tuned, how they did in them, and what nobody tried."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from math import isfinite
from typing import Any

import numpy as np

from slidetune.robot.advice.advice import advice_on
from slidetune.robot.arm.known import arm_named
from slidetune.robot.arm.known_arm import digest_of
from slidetune.robot.environment.layout import COULOMB, LAG, LIMIT, SENSOR_Q, SENSOR_V, VISCOUS
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.fields.quantity import Section
from slidetune.robot.handover.choices import choices_of
from slidetune.robot.laws import law_of
from slidetune.robot.lenses.threshold import threshold_of
from slidetune.robot.loop.response import only_lane
from slidetune.robot.loop.simulate import LaneRun, simulate
from slidetune.robot.loop.verdict import judge_goals, said
from slidetune.robot.margins.margin import loop_margin
from slidetune.robot.study.results import robustness_result, worst_result
from slidetune.robot.study.robustness import Draw
from slidetune.robot.version import __version__

Document = dict[str, Any]


def conditions_of(
    experiment: Experiment,
    sampled: Experiment,
    name: str,
    draws: Sequence[Draw] = (),
    tried: Sequence[Draw] = (),
) -> Document:
    """Return the conditions of a lane as plain JSON values.

    Args:
        experiment: what was tuned.
        sampled: what ``sampled_experiment`` made of it: the loop that is handed over.
        name: the lane.
        draws: of ``robustness``, of the sampled experiment; none where nothing was drawn.
        tried: of ``worst_case`` in the same way.
    """
    packed, run = pack(sampled), simulate(sampled).lanes[name]
    lane, as_tuned = sampled.lanes[name], None
    if experiment.simulation.mode == "continuous":
        as_tuned = _outcome(experiment, simulate(only_lane(experiment, name)).lanes[name])
    margin = loop_margin(packed, name)
    outcome = _outcome(sampled, run)
    document = {
        "slidetune": __version__,
        "lane": name,
        "law": law_of(lane).name,
        "control": _control(experiment, sampled),
        "drives": _drives(packed),
        "arm": _arm(packed),
        "environment": sampled.disturbance.model_dump(mode="json"),
        "motion": sampled.trajectory.model_dump(mode="json"),
        "initial_velocity": sampled.simulation.initial_velocity,
        "initial_error": _each(sampled.simulation.initial_error, packed.joints),
        "margin": margin.document(),
        **threshold_of(sampled, name),
        "advice": [{"level": one.level, "message": one.message} for one in advice_on(packed, name)],
        "outcome": outcome,
        "outcome_as_tuned": as_tuned,
        "robustness": _robustness(sampled, draws, tried),
    }
    document["warnings"] = list(_warnings(document, margin.holds))
    document["not_covered"] = list(_not_covered(packed, lane, document))
    return document


def _each(values: Any, joints: int) -> list[float | None]:
    """Return a number a joint; ``None`` where it has no end."""
    spread = np.broadcast_to(np.asarray(values, dtype=float), joints).tolist()
    return [value if isfinite(value) else None for value in spread]


def _control(experiment: Experiment, sampled: Experiment) -> Document:
    simulation = sampled.simulation
    return {
        "rate": simulation.control_rate,
        "period": simulation.hold,
        "input_delay": simulation.input_delay,
        "tuned_mode": experiment.simulation.mode,
        "tuned_step": experiment.simulation.arm_step,
        "horizon": simulation.horizon,
    }


def _drives(packed: Packed) -> Document:
    environment = packed.environment
    return {
        "torque_limit": _each(environment[LIMIT], packed.joints),
        "lag": _each(environment[LAG], packed.joints),
        "lag_order": packed.experiment.robot.lag_order,
    }


def _arm(packed: Packed) -> Document:
    robot, environment = packed.experiment.robot, packed.environment
    known = arm_named(robot.model)
    nominal = packed.nominal or packed.model
    return {
        "model": robot.model,
        "title": known.title,
        "joints": list(known.joint_names),
        "tip": known.tip,
        "digest": digest_of(packed.model, known.tip),
        "inertials": robot.inertials,
        "inertia_scale": robot.inertia_scale,
        "armature": _each(robot.armature, packed.joints),
        "viscous_friction": _each(environment[VISCOUS], packed.joints),
        "coulomb_friction": _each(environment[COULOMB], packed.joints),
        "payload": robot.payload.model_dump(mode="json"),
        "nominal": {
            "digest": digest_of(nominal, known.tip),
            "scale": packed.experiment.disturbance.nominal_mismatch,
            "knows_payload": robot.payload.known,
        },
    }


def _outcome(experiment: Experiment, run: LaneRun) -> Document:
    """Return figures and goals of a run over its whole horizon."""
    goals, metrics = experiment.goals, run.metrics
    verdict, slides = judge_goals(goals, run, metrics), arm_named(experiment.robot.model).slides
    return {
        "figures": metrics.document(),
        "accuracy": run.accuracy.document(),
        "frozen": None if run.freeze is None else asdict(run.freeze),
        "goals": {
            name: {
                "said": said(goal, slides),
                "priority": goal.priority,
                "ratio": verdict.ratios[name],
                "kept": (ratio := verdict.ratios[name]) is not None and ratio <= 1.0,
            }
            for name, goal in goals.items()
        },
        "kept": verdict.kept,
        "met": verdict.met,
    }


def _robustness(
    experiment: Experiment, draws: Sequence[Draw], tried: Sequence[Draw]
) -> Document | None:
    if not draws:
        return None
    uncertainty = experiment.uncertainty
    return {
        "draws": len(draws),
        "seed": uncertainty.seed,
        "uncertain": {name: list(getattr(uncertainty, name)) for name in uncertainty.uncertain},
        **robustness_result(draws),
        "tried_for_worst": len(tried),
        **worst_result(tried),
    }


def _warnings(document: Document, holds: bool) -> Iterator[str]:
    """Yield what speaks against closing the loop at all, and every doubtful number."""
    control, outcome = document["control"], document["outcome"]
    if outcome["frozen"] is not None:
        yield f"The simulated loop did not last: {outcome['frozen']['cause']}"
    elif not holds:
        yield (
            f"At {control['rate']:g} Hz the loop is not stable by its margin, though the run came "
            "to its end."
        )
    if control["tuned_mode"] == "continuous":
        yield (
            "The experiment is in continuous mode, whose controller has no control rate. What is "
            f"handed over runs at {control['rate']:g} Hz, and all figures here are of that sampled "
            "loop; tune the gains in sampled mode at the rate, with the delay and the lag of your "
            "drives, before you use them."
        )
    if any(not goal["kept"] for goal in outcome["goals"].values()):
        yield "The simulated loop misses a goal of its experiment: see the table of goals."
    robustness = document["robustness"]
    if robustness is not None and robustness["kept"] < 1.0:
        yield (
            f"In {1.0 - robustness['kept']:.1%} of the draws the loop misses a hard goal or leaves "
            "its bounds."
        )
    yield from (one["message"] for one in document["advice"] if one["level"] == "warning")


def _not_covered(packed: Packed, lane: Section, document: Document) -> Iterator[str]:
    """Yield what the simulation left out, and what it held at one value."""
    experiment, environment = packed.experiment, packed.environment
    if document["robustness"] is None:
        why = (
            "it was not asked for"
            if experiment.uncertainty.uncertain
            else "the experiment has no section `uncertainty`"
        )
        yield (
            f"No robustness: {why}. Payload, inertia, friction, delay and lag were held at the "
            "values above."
        )
    yield "Any other motion, payload, pose or rate than those above."
    yield "Elasticity and backlash of joints and links: both are rigid in the simulation."
    yield "A period that is not exactly constant, and a lost or late sample."
    if experiment.simulation.input_delay == 0.0:
        yield "Time that measuring, computing and the bus take: the input delay is 0."
    if not environment[LAG].any():
        yield "A lag of the drives: they deliver the torque at once."
    if not np.isfinite(environment[LIMIT]).all():
        yield "The drives' torque limits: not every joint has one."
    if not environment[[SENSOR_Q, SENSOR_V], 0].any():
        yield "Noise and quantisation of the measured positions and velocities: there is none."
    elif "model" in choices_of(lane) or "terminal" in choices_of(lane):
        yield "Noise of the measurement other than white; a filter of the velocity adds a delay."
    if not environment[[VISCOUS, COULOMB]].any():
        yield "Friction: there is none in the simulated joints."
    else:
        yield "Stiction, and friction that depends on load or temperature."
    if "model" in choices_of(lane):
        yield (
            "Another model in your controller: M and h have to be those of the nominal model above."
        )
    yield "Contact with people or things; the figures say nothing of safety."
