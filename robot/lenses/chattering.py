"""The chattering lens: where in frequency the torque lies, and how restless it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slidetune.robot.experiment.packed import Packed
from slidetune.robot.loop.figures import FIGURES
from slidetune.robot.loop.metrics import torque_spectrum, total_variation
from slidetune.robot.loop.simulate import LaneRun

Array = np.ndarray

SLICES = 220
"""Slices of the logarithmic frequency axis; each keeps its greatest value (*ours*)."""


@dataclass(frozen=True)
class ChatteringJoint:
    """One joint's torque.

    Attributes:
        density: amplitude density of its torque in [N m/sqrt(Hz)]. Shape (n,).
        variation: total variation of its torque a second in [N m/s].
        switches: reversals of its torque a second.
        above: effective torque above ``limit`` in [N m], ``None`` where it can't be told.
    """

    density: Array
    variation: float
    switches: float
    above: float | None


@dataclass(frozen=True)
class ChatteringView:
    """What the chattering lens shows; the figures of all joints are those of ``run.metrics``.

    Attributes:
        limit: frequency in [Hz] above which torque counts as chattering.
        frequency: frequencies of the densities in [Hz], without 0. Shape (n,).
        joints: the six joints.
        variation: total variation of all joints in [N m/s].
        switches: reversals of all joints' torques a second.
        above: effective torque above ``limit``, root sum of squares over the joints in [N m].
        mae: mean absolute error over all joints in [rad].
        max_error: greatest error in [rad].
        quiet: the same of a run without sensor noise, ``None`` where there is no such noise.
    """

    limit: float
    frequency: Array
    joints: tuple[ChatteringJoint, ...]
    variation: float
    switches: float
    above: float | None
    mae: float | None
    max_error: float | None
    quiet: ChatteringView | None = None


def _slices(frequency: Array, density: Array) -> tuple[Array, Array]:
    """Keep the greatest density of each slice of a decade, so that no peak is lost."""
    place = np.log(frequency / frequency[0]) / max(np.log(frequency[-1] / frequency[0]), 1e-12)
    starts = np.unique(np.searchsorted(place, np.linspace(0.0, 1.0, SLICES + 1)[:-1]))
    return frequency[starts], np.maximum.reduceat(density, starts, axis=0)


def look(packed: Packed, name: str, run: LaneRun, quiet: LaneRun | None = None) -> ChatteringView:
    """Look at a lane's run through the chattering lens.

    Args:
        packed: the experiment as numbers.
        name: the lane.
        run: what it did.
        quiet: what it did without sensor noise, where there is any.
    """
    rows = max(1, int(np.isfinite(run.q[:, 0]).sum()))
    period = packed.experiment.simulation.row_period
    torque, metrics = run.tau[:rows], run.metrics
    spectrum = torque_spectrum(torque, period, run.high_frequency)
    frequency, density = np.empty(0), np.empty((0, packed.joints))
    above: list[float | None] = [None] * packed.joints
    if spectrum is not None:
        frequency, power = spectrum
        high = power[frequency >= run.high_frequency].sum(axis=0) * frequency[1]
        above = np.sqrt(high).tolist()
        frequency, density = _slices(frequency[1:], np.sqrt(power[1:]))
    joints = tuple(
        ChatteringJoint(
            density=density[:, j],
            variation=total_variation(torque[:, j : j + 1], period),
            switches=float(metrics.switches[j]),
            above=above[j],
        )
        for j in range(packed.joints)
    )
    return ChatteringView(
        limit=run.high_frequency,
        frequency=frequency,
        joints=joints,
        variation=metrics.chattering,
        switches=float(metrics.switches.sum()),
        above=metrics.high_frequency_torque,
        mae=FIGURES["mae"].overall(metrics.mae),
        max_error=FIGURES["max_error"].overall(metrics.max_error),
        quiet=None if quiet is None else look(packed, name, quiet),
    )
