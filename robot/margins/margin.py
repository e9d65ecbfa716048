"""How close a sampled loop is to instability, and what would take it further away.

The condition is that of the whole loop: the spectral radius of one control period's linear map is
below 1. Gamma is the textbook's number, which sees the reaching law alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.dynamics import dynamics
from slidetune.robot.environment.layout import LIMIT, SENSOR_Q, SENSOR_V
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.experiment.simulation import Simulation
from slidetune.robot.integrator.kernel_arrays import kernel_table
from slidetune.robot.integrator.law_call import checked
from slidetune.robot.integrator.stages import sample
from slidetune.robot.kernels.for_joints import for_joints
from slidetune.robot.kernels.workspace import (
    GAIN,
    PERIOD,
    QD,
    REACH,
    RECORD,
    S_V,
    SHAPE,
    SHAPED,
    WORK_ROWS,
    Q,
    V,
)
from slidetune.robot.laws import law_of
from slidetune.robot.margins.instants import instants
from slidetune.robot.margins.period_map import MARGINAL, Around, PeriodMap, calm
from slidetune.robot.motion.trajectory import QUINTIC, reference

Array = np.ndarray

MARGIN_LIMIT = 2.0
"""An undelayed sampled loop with linear gains diverges above it (measured: 1.994 to 2.000)."""
_FACTORS = 2.0 ** np.arange(1, 31)
"""By how much reaching gains are multiplied or divided in search of the limit (*ours*)."""
_MUCH = 10
"""How many of these are tried where weaker gains do not help (*ours*): a thousandfold."""
_DIFFERENCE = 1e-9
"""Velocity in [rad/s] by which the slope of the implicit sign is taken (*ours*)."""
_WEAKER = np.geomspace(1.0, 1e-4, 13)
"""Shares of the layer's slope that an oscillation of growing amplitude feels (*ours*)."""


def evaluate(packed: Packed, name: str, q: Array, v: Array, trajectory: Array) -> Array:
    """Return a workspace in which a lane's law has been evaluated at (q, v) and t = 0.

    Args:
        packed: the experiment as numbers.
        name: the lane.
        q: joint angles in [rad]. Shape (6,).
        v: joint velocities in [rad/s]. Shape (6,).
        trajectory: desired motion, as of ``pack_trajectory``.
    """
    law = law_of(packed.experiment.lanes[name])
    work = np.zeros((WORK_ROWS, packed.joints))
    work[Q], work[V] = q, v
    work[PERIOD, 0] = packed.experiment.simulation.hold
    nominal = dynamics(packed.nominal or packed.model, work[Q], work[V])
    nominal.refill()
    environment = packed.environment.copy()
    # What the law asks for, of the true state, before the joint gives what it can.
    environment[[SENSOR_Q, SENSOR_V], 0], environment[LIMIT] = 0.0, np.inf
    record = np.zeros((1, len(RECORD), packed.joints))
    gains = packed.gains[name]
    arrays = (gains, environment, trajectory, work, record)
    checked(
        for_joints(sample, packed.joints)(
            0.0, 0, 0, kernel_table(nominal, nominal, *arrays, **law.kernels)
        )
    )
    return work


def sampling_margin(packed: Packed, name: str, q: Array) -> float:
    r"""Return how close a sampled loop is to divergence.

    .. math:: \gamma = \lambda_{max}(T D M^{-1}), \qquad
        D = (k_1 + k_2/\epsilon)\,\partial S/\partial\dot e

    Args:
        packed: the experiment as numbers.
        name: the lane.
        q: joint angles in [rad]. Shape (6,).

    Returns:
        The margin [-] at the sample period T of ``control_rate``. A loop that is nothing but a
        damper diverges above ``margin_limit``; any loop becomes unstable at ``Margin.limit``.
    """
    q = np.ascontiguousarray(q)
    hold = np.concatenate([[QUINTIC, 1.0], q, q])
    work = evaluate(packed, name, q, np.zeros(packed.joints), hold)
    damping = np.diag(work[GAIN] * work[S_V])
    if work[SHAPED, 0]:
        damping = work[SHAPE : SHAPE + packed.joints] @ damping
    elif switches(packed, name, "implicit"):
        damping = _coupled_damping(packed, name, q, hold)
    M = pin.crba(packed.model, packed.model.createData(), q)
    period = 1.0 / packed.experiment.simulation.control_rate
    return float(np.abs(np.linalg.eigvals(period * damping @ np.linalg.inv(M))).max())


def _coupled_damping(packed: Packed, name: str, q: Array, hold: Array) -> Array:
    """Return the damping of a reaching law that couples the joints in [N m s/rad], at rest."""
    ends = [
        evaluate(packed, name, q, velocity, hold)[REACH].copy()
        for velocity in _DIFFERENCE * np.vstack([np.eye(packed.joints), -np.eye(packed.joints)])
    ]
    ahead, behind = np.reshape(ends, (2, packed.joints, packed.joints))
    return np.asarray((behind - ahead).T / (2.0 * _DIFFERENCE))


def margin_limit(simulation: Simulation) -> float:
    r"""Return the sampling margin above which linear gains diverge, given the input delay.

    With a delay of n + f control periods the velocity error obeys

    .. math:: v_{k+1} = v_k - \gamma\,[(1 - f)\,v_{k-n} + f\,v_{k-n-1}]

    whose roots leave the unit circle at 2 without a delay, at 1 with one period, and at
    :math:`2\sin(\pi/(4n+2))` with n of them.

    Args:
        simulation: control rate and input delay.
    """
    whole, part = simulation.delay
    late = part / simulation.plant_substeps
    angle = np.linspace(0.0, np.pi / (2 * whole + 1), 4001)[1:]
    mean = (1.0 - late) * np.exp(1j * angle) + late
    phase = (whole + 1.5) * angle - np.angle(mean)
    first = int(np.argmax(phase >= 0.5 * np.pi - 1e-9))
    return float(2.0 * np.sin(0.5 * angle[first]) / np.abs(mean[first]))


@dataclass(frozen=True)
class Margin:
    """How a sampled loop stands, at the worst instant of its desired motion.

    Attributes:
        radius: spectral radius of one control period within the boundary layer [-]; ``None`` for
            sign(S), which has no layer.
        bounded: whether what leaves the layer comes to a limit cycle instead of growing on.
        gamma: the sampling margin [-]; ``None`` where the slope of the reaching law depends on how
            far S is from 0 (power), or has no end (sign).
        limit: gamma at which this loop becomes unstable when its reaching gains grow in proportion.
            Above gamma in a loop that is not stable it says from where on stronger gains hold it;
            0 where no factor does, ``None`` where there is no gamma.
    """

    radius: float | None
    bounded: bool
    gamma: float | None
    limit: float | None

    @property
    def stable(self) -> bool:
        """Whether a small deviation dies out."""
        return self.radius is not None and self.radius <= 1.0 + MARGINAL

    @property
    def holds(self) -> bool:
        """Whether it is stable, or chatters on its surface without end, as sign(S) does."""
        return self.stable or (self.radius is None and self.bounded)

    def document(self) -> dict[str, float | bool | None]:
        """Return it as plain JSON values."""
        return {
            "stable": self.stable,
            "radius": self.radius,
            "bounded": self.bounded,
            "gamma": self.gamma,
            "gamma_limit": self.limit,
        }


def switches(packed: Packed, name: str, switching: str) -> bool:
    """Tell whether a lane has that switching function."""
    return getattr(packed.experiment.lanes[name], "switching", "") == switching


def _has_gamma(packed: Packed, name: str) -> bool:
    lane = packed.experiment.lanes[name]
    return not switches(packed, name, "sign") and getattr(lane, "reaching", "") != "power"


def _outside(packed: Packed, name: str) -> Array | None:
    """Return a lane's gains without a layer: what is left of the reaching law is proportional."""
    lane = packed.experiment.lanes[name]
    if not hasattr(lane, "epsilon"):
        return None
    flat = {"switching": "tanh", "epsilon": np.inf}
    # There the proportional part is implicit, too.
    flat = {"k2": 0.0} if switches(packed, name, "implicit") else flat
    gains: Array = lane.model_copy(update=flat).pack(packed.joints)
    return gains


def period_map(packed: Packed, name: str, time: float) -> PeriodMap:
    """Return what one control period does to a small deviation from the desired motion.

    Args:
        packed: the experiment as numbers.
        name: the lane; one that switches by sign has no layer, and only its proportional part.
        time: when, in [s].
    """
    outside, quiet = _outside(packed, name), calm(packed)
    if switches(packed, name, "sign") and outside is not None:
        quiet = replace(quiet, gains={**quiet.gains, name: outside})
    return Around(quiet, name, time).map(outside)


def worst_instant(packed: Packed, name: str) -> tuple[float, PeriodMap]:
    """Return when along the desired motion the loop is closest to instability, and its map."""
    maps = [(time, period_map(packed, name, time)) for time in instants(packed).tolist()]
    return max(maps, key=lambda found: found[1].radius())


def loop_margin(packed: Packed, name: str) -> Margin:
    """Return how a lane's sampled loop stands, at the worst instant of its desired motion.

    Args:
        packed: the experiment as numbers.
        name: the lane.
    """
    maps = [period_map(packed, name, time) for time in instants(packed).tolist()]
    # The worst first: where a gain does not do, it is mostly there that it does not.
    maps.sort(key=lambda found: found.radius(), reverse=True)
    if not _has_gamma(packed, name):
        return _margin(packed, name, maps[0], None, None)
    gamma = worst_margin(packed, name)
    return _margin(packed, name, maps[0], gamma, gamma * _growth_to_instability(maps))


def loop_radius(packed: Packed, name: str) -> Margin:
    """Return what ``loop_margin`` does but for gamma and its limit, which take longer."""
    return _margin(packed, name, worst_instant(packed, name)[1], None, None)


def margin_at(packed: Packed, name: str, time: float) -> Margin:
    """Return how a lane's sampled loop stands at one instant of its desired motion, in [s]."""
    found = period_map(packed, name, time)
    if not _has_gamma(packed, name):
        return _margin(packed, name, found, None, None)
    gamma = sampling_margin(packed, name, _pose(packed, time))
    return _margin(packed, name, found, gamma, gamma * _growth_to_instability([found]))


def _margin(
    packed: Packed, name: str, found: PeriodMap, gamma: float | None, limit: float | None
) -> Margin:
    radius = found.radius()
    bounded = any(found.stable(switching=share) for share in (*_WEAKER, 0.0))
    if switches(packed, name, "sign"):
        # It always oscillates. Whether that has an end is up to the rest and to a torque of k2.
        return Margin(None, bounded or _is_held(packed, name), None, None)
    return Margin(radius, bounded, gamma, limit)


def _is_held(packed: Packed, name: str) -> bool:
    """Tell whether some slope of the switching term, which sign passes through, would hold."""
    wide = with_lane(packed, name, switching="tanh", epsilon=1.0)
    _, found = worst_instant(wide, name)
    shares = np.geomspace(1e-4, 1e4, 25)
    return any(found.stable(switching=share) for share in shares)


def _pose(packed: Packed, time: float) -> Array:
    work = np.zeros((WORK_ROWS, packed.joints))
    for_joints(reference, packed.joints)(time, packed.trajectory, work)
    pose: Array = work[QD].copy()
    return pose


def _growth_to_instability(maps: list[PeriodMap]) -> float:
    """Return by how much all reaching gains may be multiplied until a loop becomes unstable.

    Of a loop that is not stable it is the factor below, or else above 1 that makes it so, where
    the gains are too weak; 0 where none does.
    """

    def holds(factor: float) -> bool:
        return all(found.stable(factor, factor) for found in maps)

    if holds(1.0):
        upward = next((factor for factor in _FACTORS if not holds(factor)), None)
        return float(_FACTORS[-1]) if upward is None else _between(holds, 0.5 * upward, upward)
    downward = next((1.0 / factor for factor in _FACTORS if holds(1.0 / factor)), None)
    if downward is not None:
        return _between(holds, downward, 2.0 * downward)
    upward = next((factor for factor in _FACTORS[:_MUCH] if holds(factor)), None)
    return 0.0 if upward is None else _between(holds, upward, 0.5 * upward)


def _between(holds: Callable[[float], bool], good: float, bad: float) -> float:
    """Return where a factor begins to hold, to a thousandth, on its good side."""
    while abs(good - bad) > 1e-3 * good:
        middle = float(np.sqrt(good * bad))
        good, bad = (middle, bad) if holds(middle) else (good, middle)
    return good


def is_stable(packed: Packed, name: str) -> bool:
    """Tell whether a lane's sampled loop lets small deviations die out, all along its motion."""
    times = instants(packed).tolist()
    return not switches(packed, name, "sign") and all(
        period_map(packed, name, time).stable() for time in times
    )


def with_lane(packed: Packed, name: str, **gains: Any) -> Packed:
    """Return the experiment with other gains of one lane."""
    return replaced(packed, name, packed.experiment.lanes[name].model_copy(update=gains))


def replaced(packed: Packed, name: str, lane: Any) -> Packed:
    """Return the experiment with another lane in the place of one."""
    lanes = {**packed.experiment.lanes, name: lane}
    experiment = packed.experiment.model_copy(update={"lanes": lanes})
    gains = {**packed.gains, name: lane.pack(packed.joints)}
    return replace(packed, experiment=experiment, gains=gains)


def at_rate(packed: Packed, rate: float) -> Packed:
    """Return the experiment at another control rate in [Hz]."""
    simulation = packed.experiment.simulation.model_copy(update={"control_rate": rate})
    return replace(
        packed, experiment=packed.experiment.model_copy(update={"simulation": simulation})
    )


def _poses(packed: Packed) -> list[Array]:
    """Return joint angles along the desired trajectory in [rad]. Shapes (6,)."""
    return [_pose(packed, time) for time in instants(packed).tolist()]


def worst_margin(packed: Packed, name: str) -> float:
    """Return the largest sampling margin along the desired trajectory."""
    return max(sampling_margin(packed, name, pose) for pose in _poses(packed))
