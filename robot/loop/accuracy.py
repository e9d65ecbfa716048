"""How good the numbers of a run are: the error that is left in them, by a second, coarser run."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import ceil, log, log10
from typing import Any

import numpy as np

from slidetune.robot.arm.description.figures import MAX_JOINT_SPEED
from slidetune.robot.arm.known import SHIPPED, arm_named
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.simulation import MAX_STEPS, Simulation
from slidetune.robot.fields.quantity import bounds
from slidetune.robot.fields.units import in_units_of
from slidetune.robot.loop.decisions import APART, Doubt

Array = np.ndarray

GOOD = 1e-3
"""Error of an angle from which on a run says so in words in [rad] (*ours*)."""
LOOSER = 8.0
"""How many times its tolerance a step of the second run may be off: the error of a step falls with
the third power of its length, so that the second run is cut into pieces twice as long."""
ROUGH = 0.02
"""Share of rows that were not cut far enough from which on a run says so in words (*ours*)."""
MATTERS = 3.0
"""By what power of e a deviation grows over a run from which on it counts (*ours*)."""
WILD = 2.0 * MAX_JOINT_SPEED
"""Velocity in [rad/s] from which on a sampled motion is so wild that an error in it may grow to
many times what two runs differ by (*ours*): where it decides at one sample the sign of a torque."""
RESERVE = 1.05
"""By how much more than two runs differ a sampled run is said to be off (*ours*): its error falls
with the first power of the step, so that half of all runs would be a hair worse than told."""
SAFETY = 3.0
"""By how much finer than estimated the step is that a remark proposes (*ours*)."""


@dataclass(frozen=True)
class Accuracy:
    """How good a run is.

    Attributes:
        error_estimate: greatest error of any joint's angle over the run in [rad], estimated;
            ``None`` where nobody asked for it.
        unconverged: steps whose equation was not solved to its tolerance.
        capped: rows whose step was not cut as far as its own error asked.
        at_least: whether the error may be many times its estimate, as the remark says.
        remark: what is wrong and what would help, in words, or an empty text.
        patch: a merge patch that sets what would help, or ``None``.
    """

    error_estimate: float | None = None
    unconverged: int = 0
    capped: int = 0
    at_least: bool = False
    remark: str = ""
    patch: dict[str, Any] | None = None

    def document(self) -> dict[str, Any]:
        """Return it as plain JSON values."""
        return asdict(self)


def second_run(experiment: Experiment) -> tuple[Experiment, int, float]:
    """Return the experiment whose run tells the error of an experiment's own.

    In continuous mode it has twice the step. In sampled mode the arm has half as many steps, or
    twice as many where their number is odd; the input delay is the same.

    Returns:
        The experiment, to be run and not to be shown: its step may be past the field's bound; how
        many rows of the first run make one of the second; the error of the first run as a multiple
        of the difference, if it falls with the step (where it falls with its square, it is less).
    """
    simulation = experiment.simulation
    if simulation.mode == "continuous":
        # The plain scheme damps what it can't follow, in both runs: that hides half of its error.
        share = 1.0 if simulation.scheme == "extrapolated" else 2.0
        return _with(experiment, step=2.0 * simulation.step), 2, share
    substeps = simulation.plant_substeps
    if substeps % 2 == 0:
        return _with(experiment, plant_substeps=substeps // 2), 1, RESERVE
    return _with(experiment, plant_substeps=2 * substeps), 1, 2.0 * RESERVE


def _with(experiment: Experiment, **changes: Any) -> Experiment:
    simulation = experiment.simulation.model_copy(update=changes)
    return experiment.model_copy(update={"simulation": simulation})


def difference(q: Array, other: Array) -> float:
    """Return the greatest difference of two runs' angles in [rad], as long as both go on.

    Args:
        q: angles of one in [rad], NaN after it left its bounds. Shape (n, 6).
        other: angles of the other in [rad] at the same instants. Shape (n, 6).
    """
    apart = np.abs(q - other)
    both = np.isfinite(apart[:, 0])
    return float(apart[both].max()) if both.any() else 0.0


def damped_growth(simulation: Simulation, mode: complex) -> float:
    """Return the growth in [1/s] of a loop that its steps hide, else 0.

    An implicit step damps what it can't follow, and no estimate of its error sees that as long as
    the deviation is below the tolerance.

    Args:
        simulation: step and scheme.
        mode: the mode in [1/s] of the loop that grows fastest.
    """
    if mode.real < MATTERS / simulation.horizon:
        return 0.0
    z = simulation.step * mode
    gain = 1.0 / (1.0 - z)
    if simulation.scheme == "extrapolated":
        gain = 2.0 / (1.0 - 0.5 * z) ** 2 - gain
    grows = log(max(abs(gain), 1e-300)) / simulation.step
    return mode.real if grows < 0.5 * mode.real else 0.0


def judge(
    experiment: Experiment,
    error: float | None,
    unconverged: int,
    left: float,
    capped: int,
    damped: float = 0.0,
    fastest: float = 0.0,
    by_steps: bool = False,
    apart: float = 0.0,
    doubt: Doubt | None = None,
) -> Accuracy:
    """Return the accuracy of a lane, with words where it is not good.

    Args:
        experiment: what was run.
        error: greatest error of an angle in [rad], estimated, or ``None``.
        unconverged: steps whose equation was not solved to its tolerance.
        left: what those left of a velocity at most in [rad/s].
        capped: rows whose step was not cut as far as its own error asked.
        damped: growth in [1/s] that the steps may hide; see ``damped_growth``.
        fastest: greatest velocity of any joint in [rad/s].
        by_steps: whether an observer acts over one step, behind drives with a lag.
        apart: by what part of itself S differs between two sampled runs.
        doubt: the first decision by a sign that may be the other way round.
    """
    texts, patch = [], None
    sampled = experiment.simulation.mode == "sampled"
    wild = error is not None and error > 0.0 and sampled and fastest > WILD
    if unconverged:
        texts.append(
            f"{unconverged} {'step was' if unconverged == 1 else 'steps were'} not solved to "
            f"tolerance: the residual is up to {left:.1g} rad/s."
        )
    simulation, shipped = experiment.simulation, experiment.robot.model == SHIPPED
    rough = capped > ROUGH * simulation.horizon / simulation.row_period
    if rough:
        texts.append(
            f"{capped} rows were not subdivided as far as their local error requires: the error "
            "may be larger than estimated."
        )
    if damped:
        texts.append(
            "With this lag of the drives the loop is unstable: deviations grow by a factor "
            f"e^(t·{damped:.3g}/s). Steps of {1e3 * simulation.step:g} ms damp that: the loop may "
            "seem steadier than it is."
        )
    if by_steps:
        texts.append(
            "Time-delay estimation acts over one step in continuous mode: behind a lag of the "
            "drives its effect depends on the step, and the true error can be many times the "
            "estimate. Use the momentum observer, or sampled mode."
        )
    if error is not None and error > GOOD:
        texts.append(f"The estimated error of the angles is up to {error:.1g} rad.")
        words, patch = _finer(experiment.simulation, error)
        texts.append(words)
    if wild:
        rated = "where the arm is rated for" if shipped else "where arms are rated for about"
        texts.append(
            f"Joint velocities reach {fastest:.3g} rad/s, {rated} "
            f"{MAX_JOINT_SPEED:g}: in a motion like this small errors grow, and the true error can "
            "be many times the estimate."
        )
    if apart > APART:
        texts.append(
            "The loop swings by itself: runs of two step sizes are out of step, and S differs by "
            f"up to {100.0 * apart:.0f} % of itself. The true error can be many times the "
            "estimate; how far and how fast it swings is surer than where it is at an instant."
        )
    elif doubt is not None:
        time = doubt.row * experiment.simulation.row_period
        texts.append(
            f"At {time:.4g} s the law decides by a sign at joint {doubt.joint} that is within the "
            "error of S: the exact motion may go the other way from there, and the true error can "
            "be many times the estimate. More steps of the arm per control period show it."
        )
    slides = arm_named(experiment.robot.model).slides
    texts = [in_units_of(text, slides) for text in texts]
    known = None if error is None else float(error)
    doubtful = wild or by_steps or rough or damped > 0.0 or apart > APART or doubt is not None
    at_least = error is not None and doubtful
    return Accuracy(known, unconverged, capped, at_least, " ".join(texts), patch)


def _finer(simulation: Simulation, error: float) -> tuple[str, dict[str, Any] | None]:
    """Return what should bring the error below ``GOOD``, in words and as a patch."""
    if simulation.mode == "sampled":
        _, most = bounds(Simulation, "plant_substeps")
        factor = ceil(SAFETY * error / GOOD)
        substeps = simulation.plant_substeps * factor
        if substeps > most:
            return "No allowed number of steps of the arm is known to suffice.", None
        words = (
            f"{substeps} steps of the arm per control period should suffice; check the new "
            "estimate."
        )
        return words, {"simulation": {"plant_substeps": substeps}}
    order = 2.0 if simulation.scheme == "extrapolated" else 1.0
    step = _rounded_down(simulation.step / (SAFETY * error / GOOD) ** (1.0 / order))
    least, _ = bounds(Simulation, "step")
    if step < max(least, simulation.horizon / MAX_STEPS):
        return "No allowed step is known to suffice.", None
    words = f"A step of {1e3 * step:g} ms should suffice; check the new estimate."
    return words, {"simulation": {"step": step}}


def _rounded_down(value: float) -> float:
    """Return the number of two digits that is not greater."""
    unit = 10.0 ** (ceil(log10(value)) - 2)
    return float(f"{int(value / unit + 1e-9) * unit:.2g}")
