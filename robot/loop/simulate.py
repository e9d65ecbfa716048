"""A whole run of an experiment, without a clock."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from slidetune.robot.arm.arm import PLACE_COLUMNS, flange_positions
from slidetune.robot.environment.layout import LAG
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.integrator.cutting import cutting_of_whole_run
from slidetune.robot.integrator.horizon import STOPPED
from slidetune.robot.integrator.implicit_step import MAX_VELOCITY
from slidetune.robot.integrator.law_call import RAISED, checked
from slidetune.robot.kernels.workspace import (
    CAPPED,
    CUT,
    LEFT,
    NODES,
    R_Q,
    R_S,
    R_V,
    RECORD,
    UNSOLVED,
    W,
)
from slidetune.robot.laws import law_of
from slidetune.robot.loop.accuracy import (
    LOOSER,
    Accuracy,
    damped_growth,
    difference,
    judge,
    second_run,
)
from slidetune.robot.loop.decisions import first_doubt, swings_apart, turning_points
from slidetune.robot.loop.horizon import bind_rows, stepped_rows
from slidetune.robot.loop.lane import Freeze, Lane
from slidetune.robot.loop.metrics import Metrics, measure_lane
from slidetune.robot.loop.record_memory import record_of
from slidetune.robot.margins.layer import layer_of
from slidetune.robot.margins.unsampled import fastest_growth
from slidetune.robot.motion.along import desired_motion
from slidetune.robot.shown import Shown

Array = np.ndarray
Tell = Callable[[float], None]

_TOLD = 100
"""How often a run tells its progress (*ours*)."""


@dataclass(frozen=True)
class LaneRun:
    """What one lane did; row ``i`` holds at ``run.time[i]``, before step ``i``.

    Rows after a lane left its bounds are NaN.

    Attributes:
        q: joint angles in [rad]. Shape (n, 6).
        v: joint velocities in [rad/s]. Shape (n, 6).
        tau: torques in [N m]. Shape (n, 6).
        S: sliding variables in [rad/s]. Shape (n, 6).
        f: network outputs in [N m]. Shape (n, 6).
        weights: norms of the network's weights in [N m]. Shape (n, 6).
        final_weights: the weights at the end in [N m], node by node. Shape (10, 6).
        e: errors ``q_d - q`` in [rad]. Shape (n, 6).
        de: velocity errors in [rad/s]. Shape (n, 6).
        flange: flange positions in [m]. Shape (n, 3).
        flange_desired: desired ones in [m]. Shape (n, 3).
        layer: within which S counts as reached in [rad/s], 0 for a law that has no reaching law.
            Shape (6,).
        high_frequency: above which torque counts as chattering in [Hz].
        freeze: why it stopped, or ``None``.
        time: time in [s], that of the run. Shape (n,).
        accuracy: how good all of this is.
    """

    q: Array
    v: Array
    tau: Array
    S: Array
    f: Array
    weights: Array
    final_weights: Array
    e: Array
    de: Array
    flange: Array
    flange_desired: Array
    layer: Array
    high_frequency: float
    freeze: Freeze | None
    time: Array = field(repr=False)
    accuracy: Accuracy = field(default_factory=Accuracy)

    @property
    def metrics(self) -> Metrics:
        """Figures over the whole run."""
        return self.metrics_since(0.0)

    def metrics_since(self, start: float) -> Metrics:
        """Return the figures from ``start`` [s] to where the lane ended; NaN if it ended before."""
        # Both are true from one row on, or up to one: a slice is no copy.
        first = int(np.searchsorted(self.time, start))
        ended = np.isnan(self.q[first:, 0])
        rows = slice(first, first + int(ended.argmax()) if ended.any() else len(self.time))
        names = ("e", "de", "tau", "S", "flange", "flange_desired")
        columns = {name: getattr(self, name)[rows] for name in names}
        diverged = None if self.freeze is None else self.freeze.time
        return measure_lane(self.time[rows], columns, self.layer, self.high_frequency, diverged)


@dataclass(frozen=True)
class Run(Shown):
    """The results of an experiment.

    Attributes:
        experiment: what was run.
        time: time in [s]. Shape (n,).
        q_d: desired angles in [rad]. Shape (n, 6).
        v_d: desired velocities in [rad/s]. Shape (n, 6).
        lanes: what each lane did.
    """

    experiment: Experiment
    time: Array
    q_d: Array
    v_d: Array
    lanes: dict[str, LaneRun]


class CancelledError(Exception):
    """A run that was told to stop."""


def stop_flag() -> Array:
    """Return what stops a run once another thread has set its only number. Shape (1,)."""
    return np.zeros(1, np.int64)


class DesiredMotion(NamedTuple):
    """Where the arm should be at every row; the arrays are not to be changed.

    Attributes:
        time: time in [s]. Shape (n,).
        q_d: desired angles in [rad]. Shape (n, 6).
        v_d: desired velocities in [rad/s]. Shape (n, 6).
        flange: desired flange positions in [m]. Shape (n, 3).
    """

    time: Array
    q_d: Array
    v_d: Array
    flange: Array


@lru_cache(maxsize=4)
def _whole_motion(trajectory: bytes, places: bytes, rows: int, period: float) -> DesiredMotion:
    """Keep the last ones: a hand on a slider asks for runs of one trajectory."""
    time = np.arange(rows) * period
    numbers = np.frombuffer(places).reshape(-1, PLACE_COLUMNS)
    q_d, v_d = desired_motion(np.frombuffer(trajectory).copy(), time, len(numbers) - 1)
    motion = DesiredMotion(time, q_d, v_d, flange_positions(q_d, numbers))
    for array in motion:
        array.flags.writeable = False
    return motion


def _run_lane(name: str, packed: Packed, tolerance: float, stop: Array, tell: Tell | None) -> Lane:
    """Make all rows of one lane, or until it leaves its bounds."""
    simulation = packed.experiment.simulation
    count = simulation.rows
    cutting = cutting_of_whole_run(count, tolerance)
    lane = Lane(name, packed, record_of(count, packed.joints), cutting, stepped=not packed.compiled)
    make = bind_rows(lane, packed) or stepped_rows(lane, packed)
    rows, at_once = np.zeros(2, np.int64), count if tell is None else count // _TOLD + 1
    while rows[0] < count:
        rows[1] = min(rows[0] + at_once, count)
        try:
            joint = checked(make(rows, stop))
        except Exception as error:
            lane.fail(packed, int(rows[0]) * simulation.row_period, int(rows[0]), error)
            joint = RAISED
        if joint == STOPPED:
            raise CancelledError
        if joint:
            if joint > 0:
                lane.stop(packed, int(rows[0]) * simulation.row_period, joint, int(rows[0]))
            lane.record[rows[0] + 1 :] = np.nan
            return lane
        if tell is not None:
            tell(rows[0] / count)
    return lane


def _accuracy(
    lane: Lane, packed: Packed, other: Packed | None, stop: Array, tell: Tell | None
) -> Accuracy:
    """Judge a lane that has run, by a run of ``other`` where there is one."""
    unconverged, left, capped = lane.work[[UNSOLVED, LEFT, CAPPED], 0]
    error, damped, fastest, apart, doubt = None, 0.0, 0.0, 0.0, None
    if other is not None:
        damped = _damped_growth(lane, packed)
        fastest = float(np.nanmax(np.abs(lane.record[:, R_V])))
        _, stride, share = second_run(packed.experiment)
        second = _run_lane(lane.name, other, LOOSER, stop, tell)
        rows = lane.record[::stride, R_Q]
        common = min(len(rows), len(second.record))
        error = share * difference(rows[:common], second.record[:common, R_Q])
        if packed.experiment.simulation.mode == "sampled":
            S, others = lane.record[:common, R_S], second.record[:common, R_S]
            apart = swings_apart(S, others)
            points = turning_points(packed.experiment.lanes[lane.name])
            doubt = None if points is None else first_doubt(points, S, others, share)
        if (lane.freeze is None) != (second.freeze is None):
            # One left its bounds and the other did not: by then neither is to be trusted.
            error = max(error, packed.experiment.simulation.row_period * MAX_VELOCITY)
        # A step that wasn't solved leaves a velocity, both runs alike; at worst it stays.
        error = float(error + left * packed.experiment.simulation.horizon)
    counts = int(unconverged), float(left), int(capped)
    by_steps = other is not None and _observes_by_steps(lane, packed)
    return judge(packed.experiment, error, *counts, damped, fastest, by_steps, apart, doubt)


def _observes_by_steps(lane: Lane, packed: Packed) -> bool:
    """Tell whether time-delay estimation takes the step for its delay, behind a lag."""
    gains, continuous = packed.experiment.lanes[lane.name], packed.experiment.simulation.hold == 0.0
    late = continuous and bool(np.any(packed.environment[LAG]))
    return late and getattr(gains, "observer", "none") == "time_delay"


def _damped_growth(lane: Lane, packed: Packed) -> float:
    """Return the growth that a lane's steps hide: only a loop with a lag has some so fast."""
    simulation = packed.experiment.simulation
    few = lane.work[CUT, 0] < 0.5 * simulation.rows
    lagging = simulation.mode == "continuous" and bool(np.any(packed.environment[LAG]))
    if not lagging or not few or lane.freeze is not None:
        return 0.0
    return damped_growth(simulation, fastest_growth(packed, lane.name))


def _lane_run(lane: Lane, packed: Packed, motion: DesiredMotion, good: Accuracy) -> LaneRun:
    record = lane.record
    columns = {name: record[:, i] for i, name in enumerate(RECORD)}
    law = law_of(packed.experiment.lanes[lane.name])
    # In place: a whole run writes a lot of memory, and fresh pages cost more than the numbers.
    e, de = columns.pop("q_d"), columns.pop("v_d")
    e -= columns["q"]
    de -= columns["v"]
    return LaneRun(
        **columns,
        final_weights=lane.work[W : W + NODES] * law.network,
        e=e,
        de=de,
        flange=flange_positions(columns["q"], packed.places),
        flange_desired=motion.flange,
        layer=layer_of(packed, lane.name),
        high_frequency=packed.experiment.simulation.high_frequency,
        freeze=lane.freeze,
        time=motion.time,
        accuracy=good,
    )


def simulate(
    experiment: Experiment,
    progress: Tell | None = None,
    stop: Array | None = None,
    estimate: bool = True,
) -> Run:
    """Run an experiment over its horizon: no clock, no thread.

    Other threads go on meanwhile: a lane's rows are made in one call that needs no interpreter.

    Args:
        experiment: what to run.
        progress: called with the share done, 0 to 1, now and then.
        stop: what ``stop_flag`` returned; once another thread has set it, the run stops.
        estimate: whether each lane's error is estimated, which takes half as much again.

    Returns:
        All columns at every step, both ends included.

    Raises:
        InvalidExperimentError: if the arm can't follow the trajectory.
        CancelledError: if ``stop`` was set.
    """
    packed, other = pack(experiment), None
    if estimate:
        other = pack(second_run(experiment)[0])
    simulation, flag = experiment.simulation, stop_flag() if stop is None else stop
    trajectory = packed.trajectory.tobytes()
    motion = _whole_motion(
        trajectory, packed.places.tobytes(), simulation.rows, simulation.row_period
    )
    lanes: dict[str, LaneRun] = {}
    passes = (2 if estimate else 1) * len(experiment.lanes)
    made = 0

    def tell(share: float) -> None:
        if progress is not None:
            progress((made + share) / passes)

    told = None if progress is None else tell
    tell(0.0)
    for name in experiment.lanes:
        lane = _run_lane(name, packed, 1.0, flag, told)
        made += 1
        good = _accuracy(lane, packed, other, flag, told)
        made += 1 if estimate else 0
        lanes[name] = _lane_run(lane, packed, motion, good)
    tell(0.0)
    return Run(experiment, motion.time, motion.q_d, motion.v_d, lanes)
