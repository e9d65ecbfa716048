"""How a control period is cut into steps of the arm, for its linear map."""

from __future__ import annotations

from dataclasses import dataclass

from slidetune.robot.experiment.simulation import Simulation

_LONGEST = 8
"""Whole periods of delay that are about as many as it takes (*ours*)."""


@dataclass(frozen=True)
class Timing:
    """How a control period is cut, in steps of the arm.

    Attributes:
        step: step of the arm in [s].
        steps: steps of the arm in a period.
        delay: steps of the arm, or parts, from a measurement to its torque.
        periods: control periods that this one stands for.
    """

    step: float
    steps: int
    delay: float
    periods: float = 1.0

    @property
    def period(self) -> float:
        """Length of the period in [s]."""
        return self.step * self.steps


def timing(simulation: Simulation) -> Timing:
    """Return the timing of a sampled loop; a long delay is cut into some eight longer periods.

    A delay of n periods takes 6n states. Where it is long, the loop loses its stability slowly
    against a period, so that longer periods do: a hold delays by half of its length, which the
    delay then lacks, and what is left is of second order (0.3 % of a gain).
    """
    step = 1.0 / (simulation.control_rate * simulation.plant_substeps)
    short, (whole, part) = simulation.plant_substeps, simulation.delay
    half = max(0, round(0.5 * short * (whole / _LONGEST - 1.0)))
    long = short + 2 * half
    return Timing(step, long, whole * short + part - half, long / short)
