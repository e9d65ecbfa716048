"""Draws of what is not known exactly: the same experiment on another arm, under another load."""

from __future__ import annotations

from typing import Any

import numpy as np

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.quantity import Section
from slidetune.robot.goals.uncertainty import Uncertainty

Array = np.ndarray

QUANTITIES = tuple(name for name in Uncertainty.model_fields if name != "seed")
"""What can be uncertain. Each has its own place in every draw, so that a range more or less leaves
the others' draws as they are."""


def unit_draw(seed: int, index: int) -> Array:
    """Return where draw ``index`` lies within each of ``QUANTITIES``, 0 to 1. Shape (8,)."""
    return np.random.default_rng([seed, index]).random(len(QUANTITIES))


def drawn(experiment: Experiment, index: int) -> Experiment:
    """Return the experiment as draw ``index``, counted from 0, has it."""
    return placed(experiment, unit_draw(experiment.uncertainty.seed, index))


def placed(experiment: Experiment, share: Array) -> Experiment:
    """Return the experiment with its uncertain quantities at a place within their ranges.

    Args:
        experiment: whose ``uncertainty`` says what is uncertain.
        share: of ``QUANTITIES``, 0 the least value, 1 the greatest. Shape (8,).

    Raises:
        InvalidExperimentError: if that leads out of a field's bounds; see ``check_ranges``.
    """
    patch: dict[str, Any] = {}
    for name, value in values_at(experiment.uncertainty, share).items():
        merge(patch, _CHANGES[name](experiment, value))
    return experiment.patched(patch) if patch else experiment


def values_at(uncertainty: Uncertainty, share: Array) -> dict[str, float]:
    """Return what each uncertain quantity is at a place within the ranges, by name."""
    found = {}
    for name, part in zip(QUANTITIES, share, strict=True):
        ends = getattr(uncertainty, name)
        if ends is not None:
            found[name] = float(ends[0] + part * (ends[1] - ends[0]))
    return found


def merge(patch: dict[str, Any], more: dict[str, Any]) -> None:
    """Put another merge patch into one, both of which set values only."""
    for key, value in more.items():
        if isinstance(value, dict):
            merge(patch.setdefault(key, {}), value)
        else:
            patch[key] = value


def check_ranges(experiment: Experiment) -> None:
    """Refuse ranges that lead out of the bounds of what they change, before anything runs.

    Every field goes one way with its own quantity: the ends of the ranges are enough.

    Raises:
        InvalidExperimentError: naming every such field.
    """
    for end in (0.0, 1.0):
        placed(experiment, np.full(len(QUANTITIES), end))


def _times(section: Section, name: str, factor: float) -> Any:
    """Return a field's value times a factor."""
    return np.multiply(getattr(section, name), factor).tolist()


def _payload(_: Experiment, value: float) -> dict[str, Any]:
    return {"robot": {"payload": {"mass": value}}}


def _inertia(experiment: Experiment, value: float) -> dict[str, Any]:
    # The nominal model is scaled by both: it stays where it was.
    nominal = _times(experiment.disturbance, "nominal_mismatch", 1.0 / value)
    return {
        "robot": {"inertia_scale": _times(experiment.robot, "inertia_scale", value)},
        "disturbance": {"nominal_mismatch": nominal},
    }


def _viscous(experiment: Experiment, value: float) -> dict[str, Any]:
    return {"robot": {"viscous_friction": _times(experiment.robot, "viscous_friction", value)}}


def _coulomb(experiment: Experiment, value: float) -> dict[str, Any]:
    return {"robot": {"coulomb_friction": _times(experiment.robot, "coulomb_friction", value)}}


def _disturbance(experiment: Experiment, value: float) -> dict[str, Any]:
    torques = experiment.disturbance
    parts = {"sine": torques.sine, "pulse": torques.pulse, "noise": torques.noise}
    scaled = {name: {"amplitude": _times(part, "amplitude", value)} for name, part in parts.items()}
    return {"disturbance": {"constant": _times(torques, "constant", value), **scaled}}


def _noise(experiment: Experiment, value: float) -> dict[str, Any]:
    noise = experiment.disturbance.sensor_noise
    scaled = {name: _times(noise, name, value) for name in ("position", "velocity")}
    return {"disturbance": {"sensor_noise": scaled}}


def _delay(_: Experiment, value: float) -> dict[str, Any]:
    return {"simulation": {"input_delay": value}}


def _lag(_: Experiment, value: float) -> dict[str, Any]:
    return {"robot": {"lag": value}}


_CHANGES = {
    "payload": _payload,
    "inertia": _inertia,
    "viscous_friction": _viscous,
    "coulomb_friction": _coulomb,
    "disturbance": _disturbance,
    "sensor_noise": _noise,
    "input_delay": _delay,
    "lag": _lag,
}
