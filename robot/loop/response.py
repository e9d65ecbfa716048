"""The whole response of a lane in a form that is small enough to be sent at every slider move."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.loop.simulate import LaneRun, simulate

Array = np.ndarray

QUICK_STEP = 0.002
"""Step while a slider is being dragged in [s] (*ours*); its error is not estimated."""
QUICK_SUBSTEPS = 2
"""Steps of the arm a control period while a slider is being dragged (*ours*)."""
BUCKETS = 400
"""Pieces into which the horizon is cut; each keeps its least and its greatest value (*ours*)."""
PATH_POINTS = 200
"""Points of the flange path (*ours*)."""

CHANNELS = (
    *(f"e{j}" for j in range(1, JOINTS + 1)),
    *(f"tau{j}" for j in range(1, JOINTS + 1)),
    *(f"S{j}" for j in range(1, JOINTS + 1)),
    "flange_error",
)
"""Columns of a response: error [rad], torque [N m], sliding variable [rad/s], flange error [m]."""


@dataclass(frozen=True)
class Response:
    """One lane's whole response, thinned out.

    Attributes:
        time: two instants a bucket in [s]. Shape (n,).
        columns: values of ``CHANNELS``, least and greatest of each bucket in the order in which
            they came; NaN after the lane left its bounds. Shape (channels, n).
        path: flange positions in [m]. Shape (m, 3).
        metrics: figures of the whole run, as plain JSON values.
        frozen: when, which joint and why it left its bounds, or ``None``.
        accuracy: how good all of this is, as plain JSON values; see ``Accuracy``.
    """

    time: Array
    columns: Array
    path: Array
    metrics: dict[str, Any]
    frozen: dict[str, Any] | None
    accuracy: dict[str, Any]


def quickened(experiment: Experiment) -> Experiment:
    """Return the experiment with the coarser steps that are good enough while dragging."""
    simulation = experiment.simulation
    if simulation.mode == "sampled":
        substeps = min(simulation.plant_substeps, QUICK_SUBSTEPS)
        return experiment.patched({"simulation": {"plant_substeps": substeps}})
    step = max(simulation.step, QUICK_STEP)
    return experiment.patched({"simulation": {"step": step}})


def only_lane(experiment: Experiment, lane: str) -> Experiment:
    """Return the experiment with one of its lanes alone.

    Raises:
        KeyError: if it has no such lane.
    """
    return experiment.model_copy(update={"lanes": {lane: experiment.lanes[lane]}})


def thinned(time: Array, columns: Array, buckets: int = BUCKETS) -> tuple[Array, Array]:
    """Keep the least and the greatest value of each piece of time, so that chattering shows.

    Args:
        time: evenly spaced time in [s]. Shape (n,).
        columns: values. Shape (n, channels).
        buckets: how many pieces.

    Returns:
        Time, shape (2 * buckets + 2,), and values, shape (channels, 2 * buckets + 2): the first
        row, each piece's extremes in the order in which they came, the last row; all rows as they
        are where there are no more than that.
    """
    rows = len(time)
    if rows <= 2 * buckets + 2:
        return time, columns.T.copy()
    edges = np.linspace(0, rows, buckets + 1).astype(int)
    starts, sizes = edges[:-1], np.diff(edges)
    # Pieces of one row more than others: the shorter repeat their last.
    within = np.minimum(np.arange(sizes.max()), sizes[:, None] - 1)
    pieces = columns[starts[:, None] + within]
    low, high = pieces.argmin(axis=1), pieces.argmax(axis=1)
    early, late = np.minimum(low, high), np.maximum(low, high)
    values = np.empty((2 * buckets + 2, columns.shape[1]))
    values[1:-1:2] = np.take_along_axis(pieces, early[:, None, :], axis=1)[:, 0]
    values[2:-1:2] = np.take_along_axis(pieces, late[:, None, :], axis=1)[:, 0]
    values[0], values[-1] = columns[0], columns[-1]
    places = starts[:, None] + np.array([0.25, 0.75]) * (sizes[:, None] - 1)
    period = (time[-1] - time[0]) / (rows - 1)
    instants = np.concatenate([time[:1], time[0] + period * places.ravel(), time[-1:]])
    return instants, values.T.copy()


def _columns(run: LaneRun) -> Array:
    distance = np.linalg.norm(run.flange - run.flange_desired, axis=1)
    return np.column_stack([run.e, run.tau, run.S, distance])


def lane_response(
    experiment: Experiment,
    lane: str,
    estimate: bool = True,
    cancelled: Callable[[], bool] | None = None,
) -> Response:
    """Run one lane of an experiment over its horizon.

    Args:
        experiment: what to run; see ``quickened``.
        lane: which lane.
        estimate: whether its error is estimated, which takes half as much again.
        cancelled: asked now and then; the run stops when it says yes.

    Raises:
        CancelledError: if ``cancelled`` said yes.
        InvalidExperimentError: if the arm can't follow the trajectory.
    """
    run = simulate(only_lane(experiment, lane), cancelled=cancelled, estimate=estimate)
    result = run.lanes[lane]
    time, columns = thinned(run.time, _columns(result))
    frozen = None if result.freeze is None else result.freeze.document()
    finite = result.flange[np.isfinite(result.flange[:, 0])]
    stride = max(1, len(finite) // PATH_POINTS)
    figures, accuracy = result.metrics.document(), result.accuracy.document()
    return Response(time, columns, finite[::stride], figures, frozen, accuracy)
