"""What one control period does to a small deviation: the whole sampled loop as a linear map.

Taken by differences over the very kernels that run: the law's ``sample`` with its network, and the
arm's ``plant_step`` under the hold, with the delay line put together exactly.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from slidetune.robot.arm.dynamics import dynamics
from slidetune.robot.environment.external_torque import external_torque
from slidetune.robot.environment.layout import (
    BITS,
    COULOMB,
    LAG,
    LAGS,
    LIMIT,
    LIMITS,
    RUBS,
    SENSOR_Q,
    SENSOR_V,
    TWO_LAGS,
)
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.integrator.kernel_arrays import kernel_table
from slidetune.robot.integrator.law_call import checked
from slidetune.robot.integrator.stages import plant_step, sample
from slidetune.robot.kernels.for_joints import for_joints
from slidetune.robot.kernels.workspace import (
    AD,
    APPLIED,
    CURRENT,
    CURVE,
    CURVE_ROWS,
    HIDDEN,
    LEARNING,
    NODES,
    PERIOD,
    QD,
    REACH,
    RECORD,
    S_E,
    S_V,
    SHAPE,
    SHAPED,
    TAU,
    VD,
    WORK_ROWS,
    F,
    Q,
    S,
    V,
    W,
)
from slidetune.robot.laws import law_of
from slidetune.robot.margins.drives import Drives
from slidetune.robot.margins.observer_state import (
    begin_observer,
    remembered_rows,
    remembered_torque,
)
from slidetune.robot.margins.timing import Timing, timing
from slidetune.robot.motion.trajectory import reference

Array = np.ndarray

ANGLE, VELOCITY, TORQUE = 1e-6, 1e-6, 1e-2
"""Differences by which the arm's map is taken in [rad], [rad/s] and [N m] (*ours*)."""
MARGINAL = 1e-6
"""By how much a spectral radius may be above 1 (*ours*): a state that nothing moves, such as an
angle that nothing pulls back, stands at 1, and differences know it no better."""
UNSAMPLED = 1e7
"""Control rate in [Hz] that stands for continuous time (*ours*)."""
INSTANT = 2e-5
"""Time in [s] over which growth is told there (*ours*): differences can't tell 0.05 1/s from none,
which is ``MARGINAL`` in that time."""
WITHIN = 1e-3
"""Share of the boundary layer by which the law's map is taken (*ours*)."""


@dataclass(frozen=True)
class PeriodMap:
    r"""One control period around the desired motion.

    .. math:: x_{k+1} = A x_k + B_0 u_{k-n} + B_1 u_{k-n-1}, \qquad u_k = (C + P + R)\,x_k

    x: deviations of angle, velocity, of the torques of drives with a lag, of the weights along the
    hidden outputs, and of what a law and its observer remember, to which K u_k is added; u: the
    commanded torque.

    Attributes:
        own: A: arm and learning without the torque. Shape (m, m).
        late: B_0: torque over the rest of the period. Shape (m, 6).
        early: B_1: torque over its beginning, where the delay is not whole. Shape (m, 6).
        kept: K: torque that an observer remembers, before any delay. Shape (m, 6).
        rest: C: torque but for the reaching law. Shape (6, m).
        proportional: P: the reaching law outside of its layer. Shape (6, m).
        switching: R: what the layer adds. Shape (6, m).
        delay: n: whole periods of delay.
        timing: the period, which is a longer one under a long delay.
    """

    own: Array
    late: Array
    early: Array
    kept: Array
    rest: Array
    proportional: Array
    switching: Array
    delay: int
    timing: Timing

    @property
    def continuous(self) -> bool:
        """Whether its period is so short that it stands for continuous time."""
        return self.timing.period * UNSAMPLED < 1.0 + 1e-6

    def mode(self, proportional: float = 1.0, switching: float = 1.0) -> complex:
        """Return the mode in [1/s] that grows fastest in continuous time, or dies out last."""
        values = np.linalg.eigvals(self._whole(proportional, switching))
        rates = (values - 1.0) / self.timing.period
        return complex(rates[np.argmax(rates.real)])

    def radius(self, proportional: float = 1.0, switching: float = 1.0) -> float:
        """Return the spectral radius, with the two parts of the reaching law so many times.

        In continuous time it is that of ``INSTANT``: a period so short turns a swing so little
        that what the hold adds to its growth would count, which goes with the period.
        """
        if self.continuous:
            growth = self.mode(proportional, switching).real * INSTANT
            return float(np.exp(min(growth, 700.0)))
        largest = float(np.abs(np.linalg.eigvals(self._whole(proportional, switching))).max())
        return float(largest ** (1.0 / self.timing.periods))

    def _whole(self, proportional: float, switching: float) -> Array:
        """Return the matrix of a period over the state and the torques on their way."""
        torque, line = self._torque(proportional, switching), self._line
        A: Array = self.own + self.kept @ torque
        size, joints = len(A), self.late.shape[1]
        if self.delay == 0:
            A = A + self.late @ torque
        if line == 0:
            return A
        whole = np.zeros((size + line * joints, size + line * joints))
        whole[:size, :size] = A
        whole[size : size + joints, :size] = torque
        whole[size + joints :, size:-joints] = np.eye((line - 1) * joints)
        for back, share in ((self.delay, self.late), (self.delay + 1, self.early)):
            if 1 <= back <= line:
                first = size + (back - 1) * joints
                whole[:size, first : first + joints] = share
        return whole

    def stable(self, proportional: float = 1.0, switching: float = 1.0) -> bool:
        """Tell whether small deviations die out."""
        return self.radius(proportional, switching) <= 1.0 + MARGINAL

    @property
    def _line(self) -> int:
        """How many torques are on their way."""
        return self.delay + bool(np.any(self.early))

    def _torque(self, proportional: float, switching: float) -> Array:
        slopes: Array = self.rest + proportional * self.proportional + switching * self.switching
        return slopes


def calm(packed: Packed) -> Packed:
    """Return the experiment without what is no part of a linear map.

    Torque limits, noise of the sensors and Coulomb friction, whose slope at rest would feign a
    damping that a moving joint does not have.
    """
    environment = packed.environment.copy()
    environment[[SENSOR_Q, SENSOR_V], 0] = environment[COULOMB] = 0.0
    environment[LIMIT] = np.inf
    environment[BITS, 0] = int(environment[BITS, 0]) & ~(LIMITS | RUBS)
    return replace(packed, environment=environment)


class Around:
    """A lane's control period around the desired motion at one time."""

    def __init__(self, packed: Packed, name: str, time: float, cut: Timing | None = None) -> None:
        """Stand on the desired motion, the weights at what holds it.

        Args:
            packed: the experiment as numbers, calm.
            name: the lane.
            time: when, in [s].
            cut: how its period is cut; by default as ``timing`` says.
        """
        lane = packed.experiment.lanes[name]
        self._packed, self._time, self._lane = packed, time, lane
        self._joints, kernels = packed.joints, (reference, sample, plant_step, external_torque)
        made = (for_joints(one, packed.joints) for one in kernels)
        motion, self._look, self._move, self._torque_at = made
        self._law, self._gains = law_of(lane).used_by(lane), packed.gains[name].copy()
        self.work = work = np.zeros((WORK_ROWS, self._joints))
        motion(time, packed.trajectory, work)
        self.q, self.v = work[QD].copy(), work[VD].copy()
        self._truth = dynamics(packed.model, work[CURRENT + Q], work[CURRENT + V])
        nominal = packed.nominal or packed.model
        self._nominal = dynamics(nominal, work[CURRENT + Q], work[CURRENT + V])
        self.timing = cut = cut or timing(packed.experiment.simulation)
        bits = int(packed.environment[BITS, 0])
        self._lags = 2 if bits & TWO_LAGS else 1 if bits & LAGS else 0
        self._arm_size = (2 + self._lags) * self._joints
        work[PERIOD, 0] = cut.period
        rest = (self._gains, packed.environment, packed.trajectory, work)
        record = np.zeros((1, len(RECORD), self._joints))
        self._control = kernel_table(
            self._truth, self._nominal, *rest, record, **self._law.kernels, period=cut.period
        )
        self._arm = kernel_table(self._truth, self._truth, *rest, record, step=cut.step)
        self._weights = np.zeros((NODES, self._joints))
        self._memory = remembered_rows(law_of(lane), lane)
        self.load = self._needed_torque()
        self._ask(self.q, self.v)
        if self._law.memory:
            self._weights = work[CURRENT + W : CURRENT + W + NODES].copy()  # as it has begun
        hidden, learns = work[HIDDEN : HIDDEN + NODES].copy(), work[LEARNING] > 0.0
        length = np.linalg.norm(hidden, axis=0) if self._law.network else np.ones(self._joints)
        if getattr(lane, "observer", "none") != "none":
            begin_observer(law_of(lane), cut.period, self._nominal.inertia, work, self._weights)
        # A joint whose network is blind here, or learns nothing, has no state in it.
        known = learns & (length > 1e-9) if self._law.network else np.zeros(self._joints, bool)
        self.learning: Array = np.flatnonzero(known)
        self._along = np.divide(hidden, length, out=np.zeros_like(hidden), where=length > 1e-9)
        if len(self.learning):
            held = np.zeros(self._joints)
            held[self.learning] = (self.load / np.maximum(length, 1e-9))[self.learning]
            self._weights = self._along * held

    def _needed_torque(self) -> Array:
        """Return the torque that keeps the arm on the desired motion in [N m]. Shape (6,)."""
        work = self.work
        work[CURRENT + Q], work[CURRENT + V] = self.q, self.v
        self._truth.refill()
        self._torque_at(self._time, self.timing.period, CURRENT, self._packed.environment, work)
        M = np.triu(self._truth.inertia.T)
        M = M + np.triu(M, 1).T
        needed: Array = M @ work[AD] + self._truth.bias + work[F]
        return needed

    def _ask(self, q: Array, v: Array) -> None:
        """Let the law look at a state; the weights are put back to where they stand."""
        work = self.work
        work[CURVE : CURVE + CURVE_ROWS] = 0.0
        work[CURRENT + Q], work[CURRENT + V] = q, v
        work[CURRENT + W : CURRENT + W + NODES] = self._weights
        self._nominal.refill()
        checked(self._look(self._time, 0, 0, self._control))

    def steepest(self) -> Array:
        """Return the velocity error in [rad/s] at which the reaching law is steepest. Shape (6,).

        That is on the surface but for power reaching, whose slope there is none, or without end.
        """
        error = np.zeros(self._joints)
        if getattr(self._lane, "reaching", "") != "power":
            return error
        wanted = self._steepest_sliding()
        for _ in range(60):
            self._ask(self.q, self.v - error)
            missing = wanted - self.work[S]
            if np.abs(missing).max() < 1e-12:
                break
            error = error + missing / self.work[S_V]
        return error

    def _steepest_sliding(self) -> Array:
        r"""Return where :math:`|S|^\alpha\,\mathrm{sw}(S/\epsilon)` is steepest in [rad/s]."""
        lane = self._lane
        layer = np.broadcast_to(np.asarray(lane.epsilon, dtype=float), self._joints)
        if lane.switching == "saturation":
            return layer * (1.0 - 2.0 * WITHIN)
        x = np.geomspace(1e-3, 1e3, 4001)
        value = x**lane.alpha * np.tanh(x)
        return layer * float(x[np.argmax(np.gradient(value, x))])

    def _law_map(self, error: Array) -> tuple[Array, Array, Array]:
        """Return slopes of learning, of the rest of the torque and of its reaching law."""
        first, held, known = self._arm_size, self._weights, self._arm_size + len(self.learning)
        joints = self._joints
        size = known + len(self._memory) * joints
        learning, rest, reach = (np.zeros((rows, size)) for rows in (size, joints, joints))
        start = self.v - error
        self._ask(self.q, start)
        layer = self._layer()
        s_e, s_v = self.work[S_E].copy(), self.work[S_V].copy()
        swing = getattr(self._lane, "swing", 0.0)
        own = len(self._law.states) * joints
        by = np.concatenate(
            [
                np.maximum(
                    np.minimum(ANGLE, WITHIN * layer / np.maximum(s_e, 1e-9)),
                    swing / np.maximum(s_e, 1e-9),
                ),
                np.maximum(np.minimum(VELOCITY, WITHIN * layer / s_v), swing / s_v),
                np.full(known - 2 * joints, TORQUE),
                # A law's own is of the kind of S, an observer's a torque.
                np.tile(np.minimum(VELOCITY, WITHIN * layer), len(self._law.states)),
                np.full(size - known - own, TORQUE),
            ]
        )
        for column in (*range(2 * joints), *range(first, size)):  # no law sees what a drive gives
            found = []
            for side in (by[column], -by[column]):
                q, v = self.q.copy(), start.copy()
                self._weights = held
                if column < joints:
                    q[column] += side
                elif column < 2 * joints:
                    v[column - joints] += side
                elif column >= known:
                    row, joint = divmod(column - known, joints)
                    self._weights = held.copy()
                    self._weights[self._memory[row], joint] += side
                else:
                    joint = self.learning[column - first]
                    self._weights = held.copy()
                    self._weights[:, joint] += side * self._along[:, joint]
                self._ask(q, v)
                found.append(self._answer(held))
            torque, reached, weights = (
                (high - low) / (2.0 * by[column]) for high, low in zip(*found, strict=True)
            )
            rest[:, column], reach[:, column] = torque - reached, reached
            learning[first:, column] = weights
        self._weights = held
        return learning, rest, reach

    def _layer(self) -> Array:
        """Return within which S of a joint alone leaves the law linear in [rad/s]. Shape (6,)."""
        lane, period = self._lane, self.timing.period
        if getattr(lane, "switching", "") != "implicit":
            return np.broadcast_to(np.asarray(getattr(lane, "epsilon", 1.0)), self._joints)
        k2 = np.broadcast_to(np.asarray(lane.k2), self._joints)
        k2 = np.where(k2 > 0.0, k2, np.inf)
        if getattr(lane, "inertia_shaped", False):
            return np.asarray(period * k2)
        per_torque = self.work[S_V] / np.maximum(np.abs(self._nominal.inertia), 1e-12)
        return np.asarray(period * (k2[:, None] * per_torque).min(axis=0))

    def _answer(self, held: Array) -> tuple[Array, Array, Array]:
        """Return torque, reaching torque, and weights along the hidden outputs or memory."""
        work = self.work
        reached = work[REACH].copy()
        if work[SHAPED, 0] != 0.0:
            reached = work[SHAPE : SHAPE + self._joints] @ reached
        moved = ((work[CURRENT + W : CURRENT + W + NODES] - held) * self._along).sum(axis=0)
        memory = work[CURRENT + W + self._memory].ravel()
        return work[TAU].copy(), reached, np.concatenate([moved[self.learning], memory])

    def _arm_step(self) -> Array:
        """Return slopes of angle and velocity after one step over themselves and the torque."""
        work, start = self.work, np.concatenate([self.q, self.v, self.load])
        by = np.repeat([ANGLE, VELOCITY, TORQUE], self._joints)
        columns = np.empty((3 * self._joints, 2 * self._joints))
        for column, change in enumerate(np.diag(by)):
            ends = []
            for moved in (start + change, start - change):
                work[[CURRENT + Q, CURRENT + V, APPLIED]] = moved.reshape(3, self._joints)
                self._truth.refill()
                self._move(self._time, self._arm)
                ends.append(work[[CURRENT + Q, CURRENT + V]].ravel())
            columns[column] = (ends[0] - ends[1]) / (2.0 * by[column])
        return np.asarray(columns.T)

    def map(self, outside: Array | None = None) -> PeriodMap:
        """Return the linear map of one control period.

        Args:
            outside: gains of the same law without its layer, or ``None`` where it has none.
        """
        whole, part = divmod(self.timing.delay, self.timing.steps)
        error = self.steepest()
        learning, rest, reach = self._law_map(error)
        proportional = reach
        if outside is not None:
            within = self._gains.copy()
            self._gains[:] = outside
            _, _, proportional = self._law_map(error)
            self._gains[:] = within
        size, both = len(learning), slice(0, self._arm_size)
        own, early, late = learning, np.zeros((size, self._joints)), np.zeros((size, self._joints))
        kept = remembered_torque(self._lane, size, self._joints)
        own = own - kept @ (rest + reach)
        drives = Drives(self._packed.environment[LAG], self._lags)
        found = drives.period(self._arm_step(), self.timing.step, self.timing.steps, part)
        plant, early[both], late[both] = found
        own[both, both] += plant
        switching = reach - proportional
        law = rest, proportional, switching
        return PeriodMap(own, late, early, kept, *law, int(whole), self.timing)
