"""How close a sampled loop is to divergence, and what would take it further away."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin

from robot.disturbance import LIMIT, SENSOR
from robot.dynamics import dynamics
from robot.experiment import Simulation
from robot.laws import LAWS
from robot.packed import Packed
from robot.quantity import JOINTS
from robot.trajectory import QUINTIC, reference
from robot.wiring import wire
from robot.workspace import FLAGS, GAIN, QD, RECORD_COLUMNS, S_V, SHAPE, WORK_ROWS, Q, V

Array = np.ndarray

MARGIN_LIMIT = 2.0
"""An undelayed sampled loop with linear gains diverges above it (measured: 1.994 to 2.000)."""
_FASTEST = 9900.0
"""Greatest control rate in [Hz] that a note proposes (*ours*: the field takes 10 kHz)."""
_WIDEST = 10.0
"""Greatest boundary layer in [rad/s] that a note proposes: the field's own bound."""
_POSES = 12


def evaluate(packed: Packed, name: str, q: Array, v: Array, trajectory: Array) -> Array:
    """Return a workspace in which a lane's law has been evaluated at (q, v) and t = 0.

    Args:
        packed: the experiment as numbers.
        name: the lane.
        q: joint angles in [rad]. Shape (6,).
        v: joint velocities in [rad/s]. Shape (6,).
        trajectory: desired motion, as of ``pack_trajectory``.
    """
    law = LAWS[packed.experiment.lanes[name].law]
    work = np.zeros((WORK_ROWS, JOINTS))
    work[Q], work[V] = q, v
    believed = dynamics(packed.nominal or packed.model, work[Q], work[V])
    believed.refill()
    world = packed.world.copy()
    # What the law asks for, of the true state, before the joint gives what it can.
    world[SENSOR, :2], world[LIMIT] = 0.0, np.inf
    record = np.zeros((1, RECORD_COLUMNS))
    gains = packed.gains[name]
    wiring = wire(believed, believed, gains, world, trajectory, work, record)
    law.sample(0.0, 0, 0, wiring)
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
    work = evaluate(packed, name, q, np.zeros(JOINTS), hold)
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


def _poses(packed: Packed) -> list[Array]:
    """Return joint angles along the desired trajectory in [rad]. Shapes (6,)."""
    work = np.zeros((WORK_ROWS, JOINTS))
    poses = []
    for t in np.linspace(0.0, packed.experiment.simulation.horizon, _POSES):
        reference(t, packed.trajectory, work)
        poses.append(work[QD].copy())
    return poses


def worst_margin(packed: Packed, name: str) -> float:
    """Return the largest sampling margin along the desired trajectory."""
    return max(sampling_margin(packed, name, pose) for pose in _poses(packed))


def with_layer(packed: Packed, name: str, factor: float) -> Packed:
    """Return the experiment with a lane's boundary layer that many times as wide.

    Args:
        packed: the experiment as numbers.
        name: a lane that switches.
        factor: infinity takes all slope from tanh and from saturation.
    """
    lane = packed.experiment.lanes[name]
    width = tuple(np.broadcast_to(np.multiply(lane.epsilon, factor), JOINTS).tolist())
    gains = lane.model_copy(update={"epsilon": width}).pack()
    return replace(packed, gains={**packed.gains, name: gains})


def sufficient_layer(packed: Packed, name: str) -> float | list[float] | None:
    r"""Return the narrowest boundary layer in [rad/s] at which a sampled loop is stable.

    Every joint's is widened alike; :math:`\gamma` falls with :math:`k_1 + k_2/\epsilon`.

    Args:
        packed: the experiment as numbers.
        name: a lane that switches by tanh or saturation.

    Returns:
        One number or six, as the lane has it; ``None`` where :math:`k_1` is half of the trouble
        or too much alone, or where it would take more than 10 rad/s.
    """
    lane, limit = packed.experiment.lanes[name], margin_limit(packed.experiment.simulation)
    pose = max(_poses(packed), key=lambda q: sampling_margin(packed, name, q))
    present = sampling_margin(packed, name, pose)
    alone = sampling_margin(with_layer(packed, name, np.inf), name, pose)
    if alone > min(0.9 * limit, 0.5 * present):
        return None
    # Eigenvalues of a sum lie below the sum of the eigenvalues: two bounds for a bisection.
    low = max(1.0, (present - alone) / limit)
    high = max(low, present / (limit - alone))
    while high / low > 1.01:
        middle = float(np.sqrt(low * high))
        narrow = sampling_margin(with_layer(packed, name, middle), name, pose) >= limit
        low, high = (middle, high) if narrow else (low, middle)
    return _proposed(packed, name, high, lane.epsilon)


def _proposed(
    packed: Packed, name: str, factor: float, present: float | tuple[float, ...]
) -> float | list[float] | None:
    """Return the widened layer in numbers of two digits, if it holds at every pose."""
    limit = margin_limit(packed.experiment.simulation)
    for slack in (1.0, 1.02, 1.1, 1.5):
        wide = slack * factor
        if worst_margin(with_layer(packed, name, wide), name) < limit:
            widened = [_rounded_up(e * wide) for e in np.atleast_1d(present)]
            listed = widened if isinstance(present, tuple) else widened[0]
            return listed if max(widened) <= _WIDEST else None
    return None


def _rounded_up(value: float) -> float:
    """Return the next number of two digits that isn't smaller."""
    unit = 10.0 ** (np.floor(np.log10(value)) - 1.0)
    return float(f"{np.ceil(value / unit - 1e-9) * unit:.2g}")
