"""The whole response of a lane in a form that is small enough to be sent at every slider move."""

from __future__ import annotations

from dataclasses import dataclass
from math import isnan
from typing import Any

import numpy as np

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.loop.verdict import judge_goals

Array = np.ndarray

BUCKETS = 400
"""Pieces into which the horizon is cut; each keeps its least and its greatest value (*ours*)."""
PATH_POINTS = 200
"""Points of the flange path (*ours*)."""


def response_channels(joints: int) -> tuple[str, ...]:
    """Return the columns of a response.

    Error [rad], torque [N m], sliding variable [rad/s] of every joint, and flange error [m].
    """
    each = [f"{group}{j}" for group in ("e", "tau", "S") for j in range(1, joints + 1)]
    return (*each, "flange_error")


@dataclass(frozen=True)
class Response:
    """One lane's whole response, thinned out.

    Attributes:
        time: two instants a bucket in [s]. Shape (n,).
        columns: values of ``response_channels``, least and greatest of each bucket in the order in
            which they came; NaN after the lane left its bounds. Shape (channels, n).
        path: flange positions in [m]. Shape (m, 3).
        metrics: figures of the whole run, as plain JSON values.
        frozen: when, which joint and why it left its bounds, or ``None``.
        accuracy: how good all of this is, as plain JSON values; see ``Accuracy``.
        goals: how it keeps to the experiment's goals, as plain JSON values; see ``Verdict``.
    """

    time: Array
    columns: Array
    path: Array
    metrics: dict[str, Any]
    frozen: dict[str, Any] | None
    accuracy: dict[str, Any]
    goals: dict[str, Any]

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of its columns."""
        return response_channels(len(self.columns) // 3)


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
    values = np.empty((columns.shape[1], 2 * buckets + 2))
    values[:, 0], values[:, -1] = columns[0], columns[-1]
    _extremes(columns, edges, values[:, 1:-1])
    places = starts[:, None] + np.array([0.25, 0.75]) * (sizes[:, None] - 1)
    period = (time[-1] - time[0]) / (rows - 1)
    instants = np.concatenate([time[:1], time[0] + period * places.ravel(), time[-1:]])
    return instants, values


@kernel
def _extremes(columns, edges, out):  # type: ignore[no-untyped-def]
    """Write each bucket's least and greatest value of every column, or its first NaN, twice."""
    for bucket in range(len(edges) - 1):
        for column in range(columns.shape[1]):
            low = high = edges[bucket]
            for row in range(edges[bucket], edges[bucket + 1]):
                value = columns[row, column]
                if isnan(value):
                    low = high = row
                    break
                if value < columns[low, column]:
                    low = row
                if value > columns[high, column]:
                    high = row
            out[column, 2 * bucket] = columns[min(low, high), column]
            out[column, 2 * bucket + 1] = columns[max(low, high), column]


def lane_response(
    experiment: Experiment, lane: str, estimate: bool = True, stop: Array | None = None
) -> Response:
    """Run one lane of an experiment over its horizon.

    Args:
        experiment: what to run.
        lane: which lane.
        estimate: whether its error is estimated, which takes half as much again.
        stop: once another thread has set it, the run stops; see ``simulate``.

    Raises:
        CancelledError: if ``stop`` was set.
        InvalidExperimentError: if the arm can't follow the trajectory.
    """
    run = simulate(only_lane(experiment, lane), stop=stop, estimate=estimate)
    result = run.lanes[lane]
    distance = np.linalg.norm(result.flange - result.flange_desired, axis=1)[:, None]
    # One after the other: to put them side by side would take as much memory again.
    parts = [thinned(run.time, part) for part in (result.e, result.tau, result.S, distance)]
    time, columns = parts[0][0], np.concatenate([values for _, values in parts])
    frozen = None if result.freeze is None else result.freeze.document()
    finite = result.flange[np.isfinite(result.flange[:, 0])]
    stride = max(1, len(finite) // PATH_POINTS)
    metrics, accuracy = result.metrics, result.accuracy.document()
    goals = judge_goals(experiment.goals, result, metrics).document()
    # A copy: a view would keep every row of the run as long as the response is kept.
    path = finite[::stride].copy()
    return Response(time, columns, path, metrics.document(), frozen, accuracy, goals)
