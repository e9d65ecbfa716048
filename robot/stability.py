"""What is wrong with these numbers, before running them: margins, time constants, torques."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import pinocchio as pin

from robot.disturbance import LIMIT, SENSOR
from robot.experiment import MAX_STEPS, Simulation
from robot.laws import LAWS
from robot.packed import Packed
from robot.quantity import JOINTS
from robot.trajectory import QUINTIC, reference
from robot.workspace import (
    FLAGS,
    GAIN,
    QD,
    RECORD_COLUMNS,
    S_V,
    SHAPE,
    TAU,
    VD,
    WORK_ROWS,
    Q,
    V,
)

Array = np.ndarray

MARGIN_LIMIT = 2.0
"""An undelayed sampled loop with linear gains diverges above it (measured: 1.994 to 2.000)."""
_FASTEST = 9900.0
"""Greatest control rate in [Hz] that a note proposes (*ours*: the field takes 10 kHz)."""
_POSES = 12


@dataclass(frozen=True)
class Note:
    """One remark on a lane's numbers.

    Attributes:
        level: ``warning`` where trouble is to be expected, ``info`` where something is surprising.
        path: the field it concerns, dotted from the experiment.
        message: the number, the rule and the way out.
        patch: a merge patch that sets the nearest good value, or ``None``.
    """

    level: Literal["info", "warning"]
    path: str
    message: str
    patch: dict[str, Any] | None = None


def _evaluate(packed: Packed, name: str, q: Array, v: Array, trajectory: Array) -> Array:
    """Return a workspace in which a lane's law has been evaluated at (q, v) and t = 0."""
    law = LAWS[packed.experiment.lanes[name].law]
    work = np.zeros((WORK_ROWS, JOINTS))
    work[Q], work[V] = q, v
    model = packed.nominal or packed.model
    data = model.createData()
    M = pin.crba(model, data, q).copy()
    nle = pin.nonLinearEffects(model, data, q, v).copy()
    record = np.zeros((1, RECORD_COLUMNS))
    world = packed.world.copy()
    # What the law asks for, of the true state, before the joint gives what it can.
    world[SENSOR, :2], world[LIMIT] = 0.0, np.inf
    law.sample(0.0, 0.0, 0, 0, M, nle, packed.gains[name], world, trajectory, work, record)
    return work


def sampling_margin(packed: Packed, name: str, q: Array) -> float:
    r"""Return how close a sampled loop is to divergence.

    .. math:: \gamma = \lambda_{max}(T D (M + A)^{-1}), \qquad
        D = (k_1 + k_2/\epsilon)\,\partial S/\partial\dot e

    Args:
        packed: the experiment as numbers.
        name: the lane.
        q: joint angles in [rad]. Shape (6,).

    Returns:
        The margin [-] at the sample period T of ``control_rate``; above ``margin_limit`` the loop
        diverges.
    """
    q = np.ascontiguousarray(q)
    hold = np.concatenate([[QUINTIC, 1.0], q, q])
    work = _evaluate(packed, name, q, np.zeros(JOINTS), hold)
    damping = np.diag(work[GAIN] * work[S_V])
    if work[FLAGS, 0]:
        damping = work[SHAPE : SHAPE + JOINTS] @ damping
    M = pin.crba(packed.model, packed.model.createData(), q)
    period = 1.0 / packed.experiment.simulation.control_rate
    return float(np.abs(np.linalg.eigvals(period * damping @ np.linalg.inv(M))).max())


def margin_limit(simulation: Simulation) -> float:
    r"""Return the sampling margin above which linear gains diverge, given the input delay.

    With a delay of n + f control periods the velocity error obeys

    .. math:: v_{k+1} = v_k - \gamma\,[(1 - f)\,v_{k-n} + f\,v_{k-n-1}]

    whose roots leave the unit circle at 2 without a delay, at 1 with one period, and at
    :math:`2\sin(\pi/(4n+2))` with n of them.

    Args:
        simulation: control rate, input delay, and the steps of the arm to which it is rounded.
    """
    whole, part = simulation.delay
    late = part / simulation.plant_substeps
    angle = np.linspace(0.0, np.pi / (2 * whole + 1), 4001)[1:]
    mean = (1.0 - late) * np.exp(1j * angle) + late
    phase = (whole + 1.5) * angle - np.angle(mean)
    first = int(np.argmax(phase >= 0.5 * np.pi - 1e-9))
    return float(2.0 * np.sin(0.5 * angle[first]) / np.abs(mean[first]))


def sufficient_rate(simulation: Simulation, gamma: float) -> float | None:
    """Return a control rate in [Hz] at which linear gains are stable, or ``None``.

    A delay in seconds takes more periods at a higher rate, so that there may be none.

    Args:
        simulation: what is used now.
        gamma: sampling margin at the control rate used now.
    """
    rate = simulation.control_rate
    if gamma * rate * simulation.input_delay >= 0.5 * np.pi:
        return None
    while rate <= _FASTEST:
        # Half a percent above the border, in whole hertz, which is what a screen shows.
        candidate = float(np.ceil(1.005 * rate))
        trial = simulation.model_copy(update={"control_rate": candidate})
        if gamma * simulation.control_rate / candidate < margin_limit(trial):
            return candidate
        rate = max(1.05 * rate, gamma * simulation.control_rate / MARGIN_LIMIT)
    return None


def worst_margin(packed: Packed, name: str) -> float:
    """Return the largest sampling margin along the desired trajectory."""
    horizon = packed.experiment.simulation.horizon
    work = np.zeros((WORK_ROWS, JOINTS))
    margins = []
    for t in np.linspace(0.0, horizon, _POSES):
        reference(t, packed.trajectory, work)
        margins.append(sampling_margin(packed, name, work[QD].copy()))
    return max(margins)


def initial_torque(packed: Packed, name: str) -> Array:
    """Return the torque that a lane's law asks for at the very start in [N m]. Shape (6,)."""
    simulation = packed.experiment.simulation
    work = np.zeros((WORK_ROWS, JOINTS))
    reference(0.0, packed.trajectory, work)
    q = work[QD] - np.asarray(simulation.initial_error)
    v = work[VD] if simulation.initial_velocity == "desired" else np.zeros(JOINTS)
    torque: Array = _evaluate(packed, name, q, v, packed.trajectory)[TAU]
    return torque.copy()


def _sampling(packed: Packed, name: str) -> Iterator[Note]:
    simulation = packed.experiment.simulation
    if simulation.mode != "sampled":
        return
    gamma, limit = worst_margin(packed, name), margin_limit(simulation)
    if gamma <= limit:
        return
    rate = sufficient_rate(simulation, gamma)
    fits = rate is not None and simulation.horizon * rate <= MAX_STEPS
    late = " with this input delay" if simulation.input_delay else ""
    yield Note(
        "warning",
        "simulation.control_rate",
        f"γ = {gamma:.3g}, a sampled loop{late} needs less than {limit:.3g}: expect divergence or "
        f"a limit cycle. It would take {_way_out(rate, gamma / limit, bool(late))}.",
        {"simulation": {"control_rate": rate}} if fits else None,
    )


def _way_out(rate: float | None, excess: float, late: bool) -> str:
    faster = f"{rate:.3g} Hz, " if rate is not None else ""
    sooner = ", or a shorter delay" if late else ""
    return f"{faster}gains {excess:.3g} times lower, more armature{sooner}"


def _surface(packed: Packed, name: str) -> Iterator[Note]:
    lane, horizon = packed.experiment.lanes[name], packed.experiment.simulation.horizon
    if not hasattr(lane, "nu"):
        return
    constant = float(np.max(np.divide(lane.c, lane.nu)))
    if constant <= horizon:
        return
    nearest = float(f"{np.max(lane.c) * 3.0 / horizon:.2g}")
    yield Note(
        "info",
        f"lanes.{name}.nu",
        f"On the surface the error dies with c/ν = {constant:.3g} s, longer than the horizon of "
        f"{horizon:g} s: it hardly converges. Try ν = {nearest:g} 1/s.",
        {"lanes": {name: {"nu": min(nearest, 100.0)}}},
    )


def _torque(packed: Packed, name: str) -> Iterator[Note]:
    robot, simulation = packed.experiment.robot, packed.experiment.simulation
    if robot.torque_limit is None:
        return
    torque = np.abs(initial_torque(packed, name))
    limit = np.broadcast_to(np.asarray(robot.torque_limit, dtype=float), JOINTS)
    joint = int(np.argmax(torque / limit))
    if torque[joint] > limit[joint]:
        yield Note(
            "info",
            "robot.torque_limit",
            f"At the start joint {joint + 1} asks for {torque[joint]:.3g} N·m of the "
            f"{limit[joint]:.3g} N·m it has: the loop begins in saturation.",
        )
    light = np.min(robot.armature) < 0.01
    if simulation.mode == "continuous" and light and simulation.step > 0.0001:
        yield Note(
            "warning",
            "robot.armature",
            "Torque limits on wrists without armature need a step of 0.1 ms or less: add "
            "armature or shorten the step.",
            {"simulation": {"step": 0.0001}} if simulation.horizon <= 0.0001 * MAX_STEPS else None,
        )


def _network(packed: Packed, name: str) -> Iterator[Note]:
    lane = packed.experiment.lanes[name]
    if hasattr(lane, "width") and np.min(lane.width) < 0.35 * 2.0 * lane.center_span / 9.0:
        spacing = 2.0 * lane.center_span / 9.0
        yield Note(
            "info",
            f"lanes.{name}.width",
            f"The Gaussians are narrower than the gaps between their centres ({spacing:.3g} rad): "
            "between two of them the network is blind.",
            {"lanes": {name: {"width": float(f"{spacing:.2g}")}}},
        )


def notes(packed: Packed, name: str) -> list[Note]:
    """Return all remarks on one lane's numbers; an empty list says that nothing is amiss."""
    checks = (_sampling, _surface, _torque, _network)
    return [note for check in checks for note in check(packed, name)]
