"""A log of the real arm as a lane: its error, torque and figures like those of simulated ones."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from slidetune.robot.arm.arm import flange_positions
from slidetune.robot.arm.known import arm_named
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.logs.pieces import in_gaps, pieces_of, pooled
from slidetune.robot.logs.shift import Shift, find_shift, motion_of
from slidetune.robot.loop.metrics import Metrics, measure_lane, no_figures
from slidetune.robot.motion.along import desired_motion
from slidetune.robot.recordings.recording import Recording
from slidetune.robot.recordings.refused import RecordingError
from slidetune.robot.recordings.turns import TURN, turns_said, whole_turns

Array = np.ndarray
Against = Literal["auto", "experiment", "log"]

_UNEVEN = 0.2
"""Share by which steps may differ without rows being made anew (*ours*)."""


@dataclass(frozen=True)
class MeasuredLane:
    """What a log says of the arm; row ``i`` holds at ``time[i]``.

    Attributes:
        name: of the log.
        time: the experiment's time in [s], evenly spaced but for the log's jitter. Shape (m,).
        q: joint angles in [rad], of the experiment's turn. Shape (m, n).
        v: joint velocities in [rad/s]. Shape (m, n).
        tau: torques in [N m], NaN where the log has none. Shape (m, n).
        e: errors ``q_d - q`` in [rad]. Shape (m, n).
        de: velocity errors in [rad/s]. Shape (m, n).
        q_d: desired angles in [rad]. Shape (m, n).
        v_d: desired velocities in [rad/s]. Shape (m, n).
        flange: flange positions of the experiment's arm in [m]. Shape (m, 3).
        flange_desired: desired ones in [m]. Shape (m, 3).
        known: whether a row is the log's, and not between the ends of a gap. Shape (m,).
        high_frequency: above which torque counts as chattering in [Hz].
        against: whose desired motion counts: the experiment's, or the log's own.
        shift: how it was found that log and experiment begin together.
        remarks: what was assumed, in words.
    """

    name: str
    time: Array
    q: Array
    v: Array
    tau: Array
    e: Array
    de: Array
    q_d: Array
    v_d: Array
    flange: Array
    flange_desired: Array
    known: Array
    high_frequency: float
    against: Literal["experiment", "log"]
    shift: Shift
    remarks: tuple[str, ...]

    @property
    def metrics(self) -> Metrics:
        """Figures over the whole log."""
        return self.metrics_between()

    def metrics_between(self, start: float = -np.inf, end: float = np.inf) -> Metrics:
        """Return the figures from ``start`` to ``end`` [s].

        Gaps are left out. They are NaN where the log has no rows; those of the torque where it has
        none.
        """
        slack = 1e-9
        first = int(np.searchsorted(self.time, start - slack))
        last = int(np.searchsorted(self.time, end + slack))
        found = pieces_of(self.known[first:last])
        pieces = [slice(first + piece.start, first + piece.stop) for piece in found]
        if not pieces:
            return no_figures(self.q.shape[1])
        parts = [self._metrics_of(piece) for piece in pieces]
        if len(parts) == 1:
            return parts[0]
        times = [self.time[piece] for piece in pieces]
        return pooled(parts, times, [self.e[piece] for piece in pieces])

    def _metrics_of(self, rows: slice) -> Metrics:
        time, joints = self.time[rows], self.q.shape[1]
        torque = np.ascontiguousarray(self.tau[rows])
        known = bool(np.isfinite(torque).all())
        names = ("e", "de", "flange", "flange_desired")
        columns = {name: np.ascontiguousarray(getattr(self, name)[rows]) for name in names}
        columns |= {"tau": torque if known else np.zeros_like(torque), "S": np.zeros_like(torque)}
        even = np.linspace(time[0], time[-1], len(time))
        figures = measure_lane(even, columns, np.zeros(joints), self.high_frequency)
        if known:
            return figures
        none = np.full(joints, np.nan)
        return replace(
            figures,
            chattering=np.nan,
            switches=none,
            high_frequency_torque=None,
            peak_torque=none,
            rms_torque=none,
        )


def measured_lane(
    recording: Recording, packed: Packed, shift: float | None = None, against: Against = "auto"
) -> MeasuredLane:
    """Return a log as a lane of an experiment.

    Args:
        recording: a log of the experiment's arm.
        packed: the experiment as numbers.
        shift: what is added to the log's time in [s]; found by cross-correlation where none is
            given: of the log's own desired motion where it has one, else of its angles.
        against: whose desired motion makes the error: ``auto`` takes the log's own where it has
            one.

    Raises:
        RecordingError: if the log has no measured angles or not the motion that is asked for, or
            no shift can be found.
    """
    if not recording.measured:
        raise RecordingError(f"{recording.name}: has no measured angles, only those asked for")
    if recording.q_d is None and against == "log":
        raise RecordingError(
            f"{recording.name}: has no desired angles of its own (q_d1 or target_q_0, say): "
            "compare it with the experiment's"
        )
    time, blocks, gone, remarks = _even(recording)
    arm = arm_named(packed.experiment.robot.model)
    turning = ~np.array(arm.slides)
    if shift is None:
        found, said = _found(recording, packed, turning)
        remarks += said
    else:
        motion = motion_of(packed)(recording.time + shift)[0]
        apart = whole_turns(_followed(recording) - motion, turning)
        found = Shift(shift, np.nan, (), apart)
    remarks += turns_said(found.turns, arm.joint_names, "the angle", "the experiment's")
    for name in blocks.keys() & {"q", "q_d"}:
        blocks[name] = blocks[name] - TURN * found.turns
    q, given_d = blocks["q"], blocks.get("q_d")
    if "v" not in blocks:
        remarks.append("velocities are differences of the angles: the log has none")
    v = blocks["v"] if "v" in blocks else np.gradient(q, time, axis=0)
    if given_d is not None and against != "experiment":
        q_d, whose = given_d, "log"
        v_d = blocks["v_d"] if "v_d" in blocks else np.gradient(q_d, time, axis=0)
    else:
        q_d, v_d = desired_motion(packed.trajectory, time + found.seconds, packed.joints)
        whose = "experiment"
    return MeasuredLane(
        name=recording.name,
        time=time + found.seconds,
        q=q,
        v=v,
        tau=blocks.get("tau", np.full_like(q, np.nan)),
        e=q_d - q,
        de=v_d - v,
        q_d=q_d,
        v_d=v_d,
        flange=flange_positions(q, packed.places),
        flange_desired=flange_positions(q_d, packed.places),
        known=~gone,
        high_frequency=packed.experiment.simulation.high_frequency,
        against="log" if whose == "log" else "experiment",
        shift=found,
        remarks=(*recording.remarks, *remarks),
    )


def _followed(recording: Recording) -> Array:
    """Return the angles that are compared with the experiment's motion: asked for, or measured."""
    return recording.q if recording.q_d is None else recording.q_d


def _found(recording: Recording, packed: Packed, turning: Array) -> tuple[Shift, list[str]]:
    own = recording.q_d is not None
    horizon = packed.experiment.simulation.horizon
    try:
        found = find_shift(
            recording.time, _followed(recording), motion_of(packed), horizon, turning
        )
    except RecordingError as error:
        raise error.within(recording.name) from error
    remarks = []
    if not own:
        remarks.append(
            "the shift makes the angles fit best: an arm that follows late looks better than it is"
        )
    if found.others:
        others = ", ".join(f"{other:.4g}" for other in found.others[:4])
        remarks.append(f"the motion repeats itself: a shift of {others} s fits as well")
    return found, remarks


def _even(recording: Recording) -> tuple[Array, dict[str, Array], Array, list[str]]:
    """Return times, all blocks at them, and which are in gaps; rows that are even stay as is."""
    time = recording.time
    names = ("q", "v", "tau", "q_d", "v_d")
    blocks = {n: b for n in names if (b := getattr(recording, n)) is not None}
    steps = np.diff(time)
    usual = float(np.median(steps))
    if np.abs(steps - usual).max() <= _UNEVEN * usual:
        return time, blocks, np.zeros(len(time), dtype=bool), []
    count = max(round(float(time[-1]) / usual), 1) + 1
    even = np.linspace(0.0, time[-1], count)
    made = {
        name: np.stack([np.interp(even, time, column) for column in block.T], axis=1)
        for name, block in blocks.items()
    }
    remarks = [f"uneven rows: lines between them at {1.0 / (even[1] - even[0]):.4g} Hz"]
    gone = in_gaps(even, time)
    if gone.any():
        remarks.append(
            f"curves cross gaps in lines; figures leave them out, {gone.mean():.0%} of the time"
        )
    return even, made, gone, remarks
