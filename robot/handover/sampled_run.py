"""The sampled loop that a controller is handed over for, and what it sees and asks for in it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from slidetune.robot.arm.dynamics import dynamics
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.experiment.simulation import Simulation
from slidetune.robot.fields.quantity import bounds
from slidetune.robot.kernels.workspace import AD, MEASURED_Q, MEASURED_V, QD, RECORD, TAU, VD
from slidetune.robot.laws import law_of
from slidetune.robot.loop.lane import Lane
from slidetune.robot.loop.response import only_lane

Array = np.ndarray

PERIODS = 1000
"""Control periods of the vectors (*ours*)."""
LARGEST = 1e12
"""Torque in [N m] from which on a loop counts as lost, as in a run (*ours*)."""


def sampled_experiment(experiment: Experiment, name: str) -> Experiment:
    """Return one lane of an experiment with a controller that runs once a control period.

    A sampled experiment is that already. One in continuous mode has no control rate: its lane is
    sampled at the integrator's step, or at the highest rate there is where that is slower. What
    acts in sampled mode alone, input delay and sensor noise, stays off, as in the experiment.

    Args:
        experiment: the experiment.
        name: the lane.
    """
    alone = only_lane(experiment, name)
    simulation = alone.simulation
    if simulation.mode == "sampled":
        return alone
    rate = min(1.0 / simulation.step, bounds(Simulation, "control_rate")[1])
    sampled = {"mode": "sampled", "control_rate": rate, "input_delay": 0.0}
    quiet = {"sensor_noise": {"position": 0.0, "velocity": 0.0}}
    return alone.patched({"simulation": sampled, "disturbance": quiet})


@dataclass(frozen=True)
class Vectors:
    """What a controller saw and asked for in consecutive control periods, from the first one on.

    Attributes:
        time: time in [s]. Shape (m,).
        q: measured angles in [rad]. Shape (m, n).
        v: measured velocities in [rad/s]. Shape (m, n).
        q_d: desired angles in [rad]. Shape (m, n).
        v_d: desired velocities in [rad/s]. Shape (m, n).
        a_d: desired accelerations in [rad/s^2]. Shape (m, n).
        M: inertia of the nominal arm in [kg m^2]. Shape (m, n, n).
        h: C v + G of the nominal arm in [N m]. Shape (m, n).
        tau: torques within their limits in [N m]. Shape (m, n).
        model_based: whether the law takes a_d, M and h.
    """

    time: Array
    q: Array
    v: Array
    q_d: Array
    v_d: Array
    a_d: Array
    M: Array
    h: Array
    tau: Array
    model_based: bool

    def csv_lines(self) -> Iterator[str]:
        """Yield a line with the names of the columns, then one a period."""
        names = ("q", "v", "q_d", "v_d")
        groups: list[tuple[str, Array]] = [(name, getattr(self, name)) for name in names]
        joints = range(1, self.q.shape[1] + 1)
        heads = [f"{name}{j}" for name in names for j in joints]
        if self.model_based:
            groups += [("a_d", self.a_d), ("M", self.M), ("h", self.h)]
            heads += [f"a_d{j}" for j in joints]
            heads += [f"M{i}_{j}" for i in joints for j in joints]
            heads += [f"h{j}" for j in joints]
        heads += [f"tau{j}" for j in joints]
        rows = np.hstack(
            [
                self.time[:, None],
                *(array.reshape(len(self.time), -1) for _, array in groups),
                self.tau,
            ]
        )
        yield ",".join(["t", *heads]) + "\n"
        for row in rows.tolist():
            yield ",".join(map(repr, row)) + "\n"


def vectors_of(packed: Packed, name: str, periods: int = PERIODS) -> Vectors:
    """Step a lane's closed loop and keep what its controller saw and asked for.

    Args:
        packed: a sampled experiment as numbers.
        name: the lane.
        periods: how many control periods; fewer where the lane leaves its bounds before.
    """
    lane = Lane(name, packed, np.zeros((2, len(RECORD), packed.joints)))
    angles, velocities = np.zeros(packed.joints), np.zeros(packed.joints)
    nominal = dynamics(packed.nominal or packed.model, angles, velocities)
    period = packed.experiment.simulation.row_period
    seen: list[list[Array]] = []
    for number in range(periods):
        bad = lane.step(number * period, number, number % 2)
        if not np.all(np.abs(lane.work[TAU]) < LARGEST):
            break
        angles[:], velocities[:] = lane.work[MEASURED_Q], lane.work[MEASURED_V]
        nominal.refill()
        rows = [lane.work[row] for row in (MEASURED_Q, MEASURED_V, QD, VD, AD)]
        seen.append([one.copy() for one in (*rows, nominal.inertia, nominal.bias, lane.work[TAU])])
        if bad:
            break
    q, v, q_d, v_d, a_d, M, h, tau = (np.array([one[index] for one in seen]) for index in range(8))
    model_based = law_of(packed.experiment.lanes[name]).model_based
    return Vectors(np.arange(len(seen)) * period, q, v, q_d, v_d, a_d, M, h, tau, model_based)
