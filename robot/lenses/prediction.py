"""The prediction lens: how each joint should chatter by harmonic balance, beside how it does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slidetune.robot.environment.layout import COULOMB, LIMIT
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.lenses.swing import QUARTILE, Swing, swing_of
from slidetune.robot.loop.simulate import LaneRun
from slidetune.robot.margins.describing_function import describing_function
from slidetune.robot.margins.harmonic_balance import LimitCycle, limit_cycles
from slidetune.robot.margins.silence import silent_layer
from slidetune.robot.margins.switching_loop import SwitchingLoop, switches, switching_loop
from slidetune.robot.motion.trajectory import HoldTrajectory

Array = np.ndarray

_INSTANTS = 7
"""Instants at which the balance is made, over the part of the run that is measured (*ours*)."""
_MEASURED = 0.5
"""Share of the run, its end, in which the swing is measured (*ours*)."""
_CURVE = 90
"""Points of a Nyquist curve (*ours*)."""
_LINE = 40
"""Points of the line -1/N(A) (*ours*)."""
_FAINT = 0.05
"""Share of the layer below which an amplitude counts as silence (*ours*)."""
_LEAST = 1e-6
"""Amplitude in [rad/s] below which there is silence under sign in sampled mode (*ours*)."""
COARSE = 0.88
"""Share of the predicted frequency: where the slowest is less, it is where the samples fall that
decides (*ours*)."""


@dataclass(frozen=True)
class PredictedJoint:
    """One joint's limit cycle, as it should be and as it is.

    Attributes:
        kappa: how fast its own switching moves S in [rad/s^2].
        frequency: predicted in [Hz], ``None`` where the balance has no solution.
        slowest: the same if sampling made every switch as late as it can.
        fastest: the same if every switch came at once.
        coarse: whether it is where the samples fall that decides between these two.
        amplitude: predicted of S in [rad/s], 0 where it should be silent; as in ``Swing`` it is
            greater in a quarter of the time.
        alone: the same if no other joint switched.
        threshold: boundary layer in [rad/s] from which on it is silent, the others within theirs;
            ``None`` where there is no limit cycle, or none silences it.
        locked: numbers of the joints that swing with it, itself among them.
        load: mean of sw that holds it on its surface.
        curve: the Nyquist curve in [rad/s]: real parts, imaginary parts. Shape (2, n).
        curve_frequency: frequencies along it in [Hz]. Shape (n,).
        crossing: where it meets -1/N(A), left of 0, in [rad/s].
        line: amplitudes A in [rad/s], and 1/N(A) there, whose negative is on the real axis. Shape
            (2, m).
        measured_frequency: of S in the run in [Hz], ``None`` where it is silent.
        measured_amplitude: of S in the run in [rad/s], ``None`` where it is silent.
        limited: share of the time at the torque limit.
        sticking: share of the time in which it swings to and fro against Coulomb friction.
    """

    kappa: float
    frequency: float | None
    slowest: float | None
    fastest: float | None
    coarse: bool
    amplitude: float | None
    alone: float | None
    threshold: float | None
    locked: tuple[int, ...]
    load: float
    curve: Array
    curve_frequency: Array
    crossing: float | None
    line: Array
    measured_frequency: float | None
    measured_amplitude: float | None
    limited: float
    sticking: float


@dataclass(frozen=True)
class PredictionView:
    """What the prediction lens shows.

    Attributes:
        switching: the switching function.
        joints: the six joints.
        layer: present boundary layers in [rad/s]; 0 under sign. Shape (6,).
        threshold: one boundary layer in [rad/s] that silences all joints, ``None`` where none does.
        epsilon: the lane's ``epsilon`` with which it would be silent: a value for all joints, or a
            list where the lane has one; a little wider, in two digits.
        since: from when on the run was measured in [s].
    """

    switching: str
    joints: tuple[PredictedJoint, ...]
    layer: Array
    threshold: float | None
    epsilon: float | list[float] | None
    since: float


@dataclass(frozen=True)
class _Instant:
    time: float
    loop: SwitchingLoop
    cycles: tuple[LimitCycle | None, ...]


def look(
    packed: Packed, name: str, run: LaneRun, quiet: LaneRun | None = None
) -> PredictionView | None:
    """Look at a lane's run through the prediction lens; ``None`` where nothing switches.

    Args:
        packed: the experiment as numbers.
        name: the lane.
        run: what it did.
        quiet: what it did without sensor noise, where there is any: that is what is measured.
    """
    if not switches(packed, name):
        return None
    run = quiet or run
    lane = packed.experiment.lanes[name]
    layer = np.broadcast_to(np.asarray(lane.epsilon, dtype=float), JOINTS)
    switching: str = lane.switching
    rows = max(1, int(np.isfinite(run.q[:, 0]).sum()))
    first = int(rows * (1.0 - _MEASURED))
    held = isinstance(packed.experiment.trajectory, HoldTrajectory)
    instants = []
    for time in np.linspace(run.time[first], run.time[rows - 1], 1 if held else _INSTANTS).tolist():
        loop = switching_loop(packed, name, time)
        instants.append(_Instant(time, loop, limit_cycles(loop, switching, layer)))
    thresholds = _thresholds(packed, name, instants)
    common = _common_threshold(packed, name, instants)
    joints = tuple(
        _joint(packed, run, slice(first, rows), joint, instants, switching, layer, thresholds)
        for joint in range(JOINTS)
    )
    return PredictionView(
        switching=switching,
        joints=joints,
        layer=np.zeros(JOINTS) if switching == "sign" else layer,
        threshold=common,
        epsilon=_epsilon(lane.epsilon, common, thresholds),
        since=float(run.time[first]),
    )


def _worst(instants: list[_Instant], joint: int) -> _Instant | None:
    """Return the instant at which a joint needs the widest layer."""
    swinging = [one for one in instants if one.cycles[joint] is not None]
    return max(swinging, key=lambda one: one.cycles[joint].crossing, default=None)  # type: ignore[union-attr]


def _crossings(instant: _Instant) -> Array:
    return np.array([0.0 if one is None else one.crossing for one in instant.cycles])


def _thresholds(packed: Packed, name: str, instants: list[_Instant]) -> list[float | None]:
    """Return the layer that silences each joint, those that lock widened together."""
    found: dict[tuple[float, tuple[int, ...]], Array | None] = {}
    thresholds: list[float | None] = []
    for joint in range(JOINTS):
        worst = _worst(instants, joint)
        cycle = None if worst is None else worst.cycles[joint]
        if worst is None or cycle is None:
            thresholds.append(None)
            continue
        key = worst.time, cycle.locked
        if key not in found:
            found[key] = silent_layer(packed, name, _crossings(worst), *key[:1], cycle.locked)
        layers = found[key]
        thresholds.append(None if layers is None else float(layers[joint]))
    return thresholds


def _common_threshold(packed: Packed, name: str, instants: list[_Instant]) -> float | None:
    """Return the one layer that silences all joints, at the worst instant."""
    if not any(cycle is not None for one in instants for cycle in one.cycles):
        return None
    widest = 0.0
    for one in instants:
        layers = silent_layer(packed, name, np.ones(JOINTS), one.time)
        if layers is None:
            return None
        widest = max(widest, float(layers[0]))
    return widest


def _wider(value: float) -> float:
    """Return a value rounded up to two digits, by a hundredth at least."""
    digits = 1 - int(np.floor(np.log10(value)))
    return float(round(np.ceil(1.01 * value * 10.0**digits) / 10.0**digits, digits))


def _epsilon(
    present: float | list[float], common: float | None, thresholds: list[float | None]
) -> float | list[float] | None:
    if common is None:
        return None
    if not isinstance(present, list | tuple):
        return _wider(common)
    pairs = zip(present, thresholds, strict=True)
    return [float(now) if found is None else _wider(found) for now, found in pairs]


def _joint(
    packed: Packed,
    run: LaneRun,
    rows: slice,
    joint: int,
    instants: list[_Instant],
    switching: str,
    layer: Array,
    thresholds: list[float | None],
) -> PredictedJoint:
    cycles = [one.cycles[joint] for one in instants]
    known = [cycle for cycle in cycles if cycle is not None]
    worst = _worst(instants, joint)
    cycle = None if worst is None else worst.cycles[joint]
    curve, frequency = np.empty((2, 0)), np.empty(0)
    if worst is not None and cycle is not None:
        omega = np.geomspace(0.3 * cycle.omega, min(8.0 * cycle.omega, worst.loop.fastest), _CURVE)
        found = cycle.curve(worst.loop, joint, omega)
        curve, frequency = np.array([found.real, found.imag]), omega / (2.0 * np.pi)

    def usual(values: list[float], share: float = 0.5) -> float | None:
        return float(np.quantile(values, share)) if values else None

    least = _least(packed, switching, float(layer[joint]), float(run.layer[joint]))
    swing = swing_of(run.S[rows, joint], packed.experiment.simulation.row_period, least)
    amplitude = usual([one.amplitude for one in known], QUARTILE)
    limited, sticking = _obstacles(packed, run, rows, joint, swing)
    turns = 2.0 * np.pi
    return PredictedJoint(
        kappa=float(np.median([one.loop.kappa[joint] for one in instants])),
        frequency=usual([one.omega / turns for one in known]),
        slowest=usual([one.slowest / turns for one in known]),
        fastest=usual([one.fastest / turns for one in known]),
        coarse=any(one.slowest < COARSE * one.omega for one in known),
        amplitude=None if amplitude is None else amplitude * (amplitude > least),
        alone=usual([one.alone for one in known], QUARTILE),
        threshold=thresholds[joint],
        locked=() if cycle is None else tuple(other + 1 for other in cycle.locked),
        load=float(max((one.loop.load[joint] for one in instants), key=abs)),
        curve=curve,
        curve_frequency=frequency,
        crossing=None if cycle is None else cycle.crossing,
        line=_line(switching, float(layer[joint]), 0.0 if cycle is None else cycle.crossing),
        measured_frequency=None if swing is None else swing.frequency,
        measured_amplitude=None if swing is None else swing.amplitude,
        limited=limited,
        sticking=sticking,
    )


def _line(switching: str, layer: float, crossing: float) -> Array:
    """Return amplitudes and 1/N(A), from a small swing to past the crossing. Shape (2, m)."""
    start, end = (
        (1e-2 * crossing, 2.0 * crossing)
        if switching == "sign"
        else (0.05 * layer, 3.0 * max(crossing, layer))
    )
    if end <= 0.0:
        return np.empty((2, 0))
    amplitudes = np.geomspace(start, end, _LINE)
    layers = np.full(_LINE, layer)
    return np.array([amplitudes, 1.0 / describing_function(switching, amplitudes, layers)])


def _least(packed: Packed, switching: str, layer: float, reached: float) -> float:
    """Return the amplitude in [rad/s] that is not yet a swing."""
    if switching != "sign":
        return _FAINT * layer
    return reached if packed.experiment.simulation.mode == "continuous" else _LEAST


def _obstacles(
    packed: Packed, run: LaneRun, rows: slice, joint: int, swing: Swing | None
) -> tuple[float, float]:
    """Return the shares of the time at the torque limit and against Coulomb friction."""
    limit = packed.environment[LIMIT, joint]
    limited = float(np.mean(np.abs(run.tau[rows, joint]) >= limit * (1.0 - 1e-9)))
    if swing is None or packed.environment[COULOMB, joint] == 0.0:
        return limited, 0.0
    v = run.v[rows, joint]
    v_d = v + run.de[rows, joint]
    turning = np.abs(v_d) < 0.5 * np.percentile(np.abs(run.de[rows, joint]), 95.0)
    return limited, float(np.mean(turning))
