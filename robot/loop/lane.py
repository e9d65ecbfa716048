"""One lane: one closed loop with its state, its record and its reason to stand still."""

from __future__ import annotations

import logging
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np

from slidetune.robot.arm.known import arm_named
from slidetune.robot.environment.layout import LAG
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.experiment.simulation import Simulation
from slidetune.robot.fields.units import in_units_of
from slidetune.robot.integrator.cutting import BUCKETS, cutting_of
from slidetune.robot.integrator.implicit_step import MAX_ANGLE, MAX_VELOCITY
from slidetune.robot.kernels.for_joints import for_joints
from slidetune.robot.kernels.workspace import (
    CHANGE_Q,
    CHANGE_V,
    KNOWN,
    MEMORY_ROWS,
    NODES,
    PERIOD,
    PUSH,
    QD,
    R_Q,
    R_QD,
    R_V,
    R_VD,
    STATE_ROWS,
    TAU,
    VD,
    WORK_ROWS,
    Q,
    V,
    W,
)
from slidetune.robot.law_files.law_file import traceback_text
from slidetune.robot.laws import law_of
from slidetune.robot.laws.law import Law
from slidetune.robot.loop.steps import Step, begin_drives, bind_step, torques_on_the_way
from slidetune.robot.margins.margin import Margin, margin_at
from slidetune.robot.margins.unsampled import is_stable_unsampled
from slidetune.robot.motion.trajectory import reference

Array = np.ndarray

log = logging.getLogger("slidetune.lane")

CHANGES = slice(CHANGE_Q, KNOWN)
COUNTS = slice(KNOWN, CHANGE_Q + MEMORY_ROWS)
"""Rows of the workspace that a lane's next step depends on besides its state."""


@dataclass(frozen=True)
class Freeze:
    """Why a lane stands still.

    Attributes:
        time: when it left its bounds in [s].
        joint: which joint, from 1; ``None`` where the law itself failed.
        cause: what happened and what to do, in words.
        gamma: the sampling margin where that is the reason, else ``None``.
        radius: the spectral radius of one control period where that is the reason, else ``None``.
        trace: lines of the law's own file that led there, empty where there is none.
    """

    time: float
    joint: int | None
    cause: str
    gamma: float | None = None
    radius: float | None = None
    trace: str = ""

    def document(self) -> dict[str, Any]:
        """Return it as plain JSON values."""
        return asdict(self)


@dataclass(frozen=True)
class LaneState:
    """All that the next steps of a lane depend on besides the experiment.

    Attributes:
        state: angles, velocities, weights or memory of the law, torques of the drives.
            Shape (16, 6).
        changes: what the step before tells the next one of its error. Shape (2, n).
        counts: what it leaves besides, see ``KNOWN`` to ``CUT``. Shape (5,).
        torque: torque of the step before in [N m]. Shape (6,).
        row: the last recorded row, which a lane that stands still repeats. Shape (48,).
        commands: torques that wait for the input delay to pass in [N m], the oldest first.
            Shape (n, 6).
        buckets: how far the next steps may be cut; see ``BUCKETS``. Shape (3,).
        freeze: why it stands still, ``None`` while it runs.
        began: when it began from its initial state in [s].
        keeper: the law whose weights or memory the state holds.
    """

    state: Array
    changes: Array
    counts: Array
    torque: Array
    row: Array
    commands: Array
    buckets: Array
    freeze: Freeze | None
    began: float
    keeper: Law


_WHY = tuple(field.name for field in fields(Freeze))


class Lane:
    """One closed loop.

    Attributes:
        name: its name in the experiment.
        work: workspace of the kernels; ``robot.kernels.workspace`` names its rows.
        record: what the steps wrote, in the order of ``RECORD``. Shape (n, 48).
        freeze: why it stands still, ``None`` while it runs.
        began: when it began from its initial state in [s].
        commands: torques that wait for the input delay to pass in [N m]. Shape (n, 6).
        step: the bound step; see ``robot.loop.steps.Step``.
    """

    def __init__(
        self,
        name: str,
        packed: Packed,
        record: Array,
        cutting: Array | None = None,
        stepped: bool = True,
    ) -> None:
        """Stand at the beginning of the trajectory with empty weights.

        Args:
            name: its name in the experiment.
            packed: the experiment as numbers.
            record: rows to write. Shape (n, 48).
            cutting: what ``cutting_of`` returned; by default as far as in a live session.
            stepped: whether it is stepped; if not, its rows are made by ``bind_rows``, and it has
                no ``step``.
        """
        self.name, self._stepped = name, stepped
        self.record = record
        self.cutting = cutting_of() if cutting is None else cutting
        self.work = np.zeros((WORK_ROWS, packed.joints))
        self.freeze: Freeze | None = None
        self.restart(packed)

    def restart(self, packed: Packed, time: float = 0.0) -> None:
        """Go to the initial state on the trajectory: e and v as asked for t = 0, empty weights.

        Args:
            packed: the experiment as numbers.
            time: when, in [s].
        """
        simulation = packed.experiment.simulation
        self.began = time
        self.work[:] = 0.0
        for_joints(reference, packed.joints)(time, packed.trajectory, self.work)
        self.work[Q] = self.work[QD] - np.asarray(simulation.initial_error)
        if simulation.initial_velocity == "desired":
            self.work[V] = self.work[VD]
        self.freeze, self.commands = None, np.empty((0, packed.joints))
        self._keeper = law_of(packed.experiment.lanes[self.name])
        self.adopt(packed)

    def adopt(self, packed: Packed) -> None:
        """Take other gains, law, arm or trajectory from the next step on; the state goes on.

        What another law left as its memory is not this one's. Weights go on under another law with
        a network, and one that needs none leaves them as they are. A law whose observer is switched
        keeps its own memory; all others are of the moment: no law finds the one that it once left.
        """
        gains, before = packed.experiment.lanes[self.name], self._keeper
        law = law_of(gains).used_by(gains)
        if law.network or law.memory or before.memory:
            same = (law.lane, law.memory) == (before.lane, before.memory)
            if not same and not (law.network and before.network):
                kept = law_of(gains).memory if law.lane is before.lane else 0
                self.work[W + kept : W + NODES] = 0.0
            self._keeper = law
        self.commands = torques_on_the_way(packed, self.work, self.commands)
        begin_drives(packed, self.work)
        self.work[PERIOD, 0] = packed.experiment.simulation.hold
        if self._stepped:
            arrays = (packed.gains[self.name], self.work, self.record, self.commands)
            self.step: Step = bind_step(law, packed, *arrays, self.cutting)

    def continue_from(self, other: Lane, packed: Packed) -> None:
        """Take over another lane's state, torques on their way, past rows and freeze.

        What it counted stays its own.
        """
        self.work[:STATE_ROWS] = other.work[:STATE_ROWS]
        self.work[PUSH], self.work[TAU] = other.work[PUSH], other.work[TAU]
        self.work[[CHANGE_Q, CHANGE_V]] = other.work[[CHANGE_Q, CHANGE_V]]
        self.work[KNOWN, 0] = other.work[KNOWN, 0]
        self.cutting[BUCKETS] = other.cutting[BUCKETS]
        self.record[:] = other.record
        self._keeper = other._keeper
        self.freeze, self.commands, self.began = other.freeze, other.commands, other.began
        self.adopt(packed)

    def state(self, number: int) -> LaneState:
        """Return a copy of all that step ``number``, the next one, and those after it depend on."""
        return LaneState(
            state=self.work[:STATE_ROWS].copy(),
            changes=self.work[CHANGES].copy(),
            counts=self.work[COUNTS, 0].copy(),
            torque=self.work[TAU].copy(),
            row=self.record[(number - 1) % len(self.record)].copy(),
            commands=np.roll(self.commands, -number, axis=0),
            buckets=self.cutting[BUCKETS].copy(),
            freeze=self.freeze,
            began=self.began,
            keeper=self._keeper,
        )

    def restore(self, past: LaneState, packed: Packed, number: int) -> None:
        """Go back to where the lane was, with step ``number`` as the next one."""
        self.work[:STATE_ROWS], self.work[CHANGES] = past.state, past.changes
        self.work[COUNTS, 0] = past.counts
        self.work[TAU] = past.torque
        self.record[(number - 1) % len(self.record)] = past.row
        self.commands = np.roll(past.commands, number, axis=0)
        self.cutting[BUCKETS] = past.buckets
        self.freeze, self.began, self._keeper = past.freeze, past.began, past.keeper
        self.adopt(packed)

    def document(self) -> dict[str, Any]:
        """Return whether it runs, since when, and if not, why, as plain JSON values."""
        why = self.freeze.document() if self.freeze else {**dict.fromkeys(_WHY), "trace": ""}
        return {"status": "frozen" if self.freeze else "running", "began": self.began, **why}

    def hold(self, packed: Packed, time: float, row: int) -> None:
        """Record a frozen lane: its last finite row, and the desired motion that goes on."""
        for_joints(reference, packed.joints)(time, packed.trajectory, self.work)
        self.record[row] = self.record[row - 1]
        self.record[row, [R_QD, R_VD]] = self.work[[QD, VD]]

    def stop(self, packed: Packed, time: float, joint: int, row: int) -> None:
        """Freeze at the last finite state and say why.

        Args:
            packed: the experiment as numbers.
            time: time of the step that failed in [s].
            joint: which joint left its bounds, from 1.
            row: row of the record that the step wrote.
        """
        lost = np.isnan(self.work[TAU])
        self._mend(packed, time, row)
        if lost.any():
            joint = int(lost.argmax()) + 1
            cause = f"The law's torque at joint {joint} was not a number at {time:.3f} s."
            self.freeze = Freeze(time, joint, f"{cause} Choose other gains, then reset.")
            return
        slides = arm_named(packed.experiment.robot.model).slides[joint - 1]
        bounds = f"±{MAX_ANGLE:g} rad, ±{MAX_VELOCITY:g} rad/s"
        cause = f"Joint {joint} left its bounds ({in_units_of(bounds, [slides])}) at {time:.3f} s."
        simulation, lag = packed.experiment.simulation, bool(np.any(packed.environment[LAG]))
        if simulation.mode == "sampled":
            margin = margin_at(packed, self.name, time)
            if not margin.holds and is_stable_unsampled(packed, self.name, time):
                cause += _too_fast(simulation, lag, margin)
                self.freeze = Freeze(time, joint, cause, margin.gamma, margin.radius)
                return
        if (
            lag
            and not is_stable_unsampled(packed, self.name, time)
            and is_stable_unsampled(packed, self.name, time, lag=False)
        ):
            cause += " The gains are too high for this lag of the drives, at any control rate."
        cause += " Change the gains or reduce the disturbance, then reset."
        self.freeze = Freeze(time, joint, cause)

    def fail(self, packed: Packed, time: float, row: int, error: Exception) -> None:
        """Freeze because the law raised ``error``; the other arguments are those of ``stop``."""
        gains = packed.experiment.lanes[self.name]
        law, own = gains.law, bool(law_of(gains).version)
        log.error("Lane %s: the law %s failed at %.3f s.", self.name, law, time, exc_info=error)
        self.record[row] = np.nan
        self._mend(packed, time, row)
        text = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        trace = traceback_text(error)
        # Numba tells of an index beyond an array without the line.
        where = "" if trace or not own else " Compiled code names no line: look at its indices."
        remedy = "Mend its file, or reset." if own else "Choose another law, then reset."
        cause = f"The law {law} failed at {time:.3f} s: {text}.{where} {remedy}"
        self.freeze = Freeze(time, None, cause, trace=trace)

    def _mend(self, packed: Packed, time: float, row: int) -> None:
        """Put what is finite in the place of all that isn't, in the state and in the last row."""
        work, started = self.work, time > 0.0
        for_joints(reference, packed.joints)(time, packed.trajectory, work)
        known = self.record[row - 1].copy() if started else np.zeros(self.record.shape[1:])
        last = np.zeros((STATE_ROWS, packed.joints))
        last[Q], last[V] = known[[R_Q, R_V]] if started else work[[QD, VD]]
        _replace_broken(work[:STATE_ROWS], last)
        _replace_broken(work[TAU], np.zeros(packed.joints))
        known[[R_Q, R_V]] = work[[Q, V]]
        known[[R_QD, R_VD]] = work[[QD, VD]]
        _replace_broken(self.record[row], known)


def _replace_broken(values: Array, known: Array) -> None:
    broken = ~np.isfinite(values)
    values[broken] = known[broken]


def _too_fast(simulation: Simulation, lag: bool, margin: Margin) -> str:
    """Say in words what a sampled loop of that margin would take."""
    reasons = [f"{simulation.control_rate:g} Hz"]
    reasons += ["this input delay"] if simulation.input_delay else []
    reasons += ["this lag of the drives"] if lag else []
    cause = f" The gains are too high for {' and '.join(reasons)}"
    if margin.radius is None:
        return f"{cause}, even without sign(S). Lower them or raise the control rate, then reset."
    cause += f": deviations grow by a factor ρ = {margin.radius:.4g} per sample"
    if margin.gamma is not None:
        known = margin.limit is not None and 0.0 < margin.limit < margin.gamma
        limit = f", the limit of this loop is {margin.limit:.3g}" if known else ""
        cause += f" (γ = {margin.gamma:.3g}{limit})"
    return (
        f"{cause}. Lower the reaching gains (k₁, k₂/ε), the surface gains or the learning rate, "
        "add rotor inertia or raise the control rate, then reset."
    )
