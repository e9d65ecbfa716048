"""The prediction lens: how each joint should chatter by harmonic balance, beside how it does."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from slidetune.robot.environment.layout import COULOMB, LIMIT
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.lenses.adapted_gain import adapted_gain
from slidetune.robot.lenses.swing import QUARTILE, Swing, swing_of
from slidetune.robot.loop.simulate import LaneRun
from slidetune.robot.margins.harmonic_balance import LimitCycle, limit_cycles
from slidetune.robot.margins.margin import period_map
from slidetune.robot.margins.plain_lane import as_plain, switches
from slidetune.robot.margins.silence import silent_layer
from slidetune.robot.margins.switching_loop import SwitchingLoop, switching_loop
from slidetune.robot.margins.switching_term import SwitchingTerm
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
"""Amplitude in [rad/s] below which there is silence without a layer in sampled mode (*ours*)."""
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
        layer: its boundary layer at that instant in [rad/s]: epsilon, that of the implicit sign, or
            0 where it has none.
        threshold: boundary layer in [rad/s] from which on it is silent, the others within theirs;
            ``None`` where there is no limit cycle, none silences it, or it has none.
        locked: numbers of the joints that swing with it, itself among them.
        load: mean of sw that holds it on its surface; of super-twisting, share of z_max.
        gain: k2 at the worst instant, which an adaptive law changes, in its unit.
        curve: the Nyquist curve in [rad/s], of super-twisting in [s]: real parts, imaginary parts.
            Shape (2, n).
        curve_frequency: frequencies along it in [Hz]. Shape (n,).
        crossing: where it meets -1/N(A), real and imaginary part, ``None`` where it does not.
        line: amplitudes A in [rad/s], and -1/N(A) there, real and imaginary parts. Shape (3, m).
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
    layer: float
    threshold: float | None
    locked: tuple[int, ...]
    load: float
    gain: float
    curve: Array
    curve_frequency: Array
    crossing: tuple[float, float] | None
    line: Array
    measured_frequency: float | None
    measured_amplitude: float | None
    limited: float
    sticking: float


@dataclass(frozen=True)
class PredictionView:
    """What the prediction lens shows.

    Attributes:
        switching: the switching function, or ``twisting``.
        joints: the six joints.
        adaptive: whether its k2 is one that changes.
        threshold: one boundary layer in [rad/s] that silences all joints, ``None`` where none does.
        epsilon: the lane's ``epsilon`` with which it would be silent: a value for all joints, or a
            list where the lane has one; a little wider, in two digits.
        since: from when on the run was measured in [s].
    """

    switching: str
    joints: tuple[PredictedJoint, ...]
    adaptive: bool
    threshold: float | None
    epsilon: float | list[float] | None
    since: float


@dataclass(frozen=True)
class _Instant:
    time: float
    plain: Packed
    term: SwitchingTerm
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
    rows = max(1, int(np.isfinite(run.q[:, 0]).sum()))
    first = int(rows * (1.0 - _MEASURED))
    adapted = adapted_gain(packed, name, run)
    held = isinstance(packed.experiment.trajectory, HoldTrajectory) and adapted is None
    instants = []
    for row in np.linspace(first, rows - 1, 1 if held else _INSTANTS).astype(int).tolist():
        time = float(run.time[row])
        plain, term = as_plain(packed, name, time, None if adapted is None else adapted[row])
        loop = switching_loop(plain, name, time)
        cycles = limit_cycles(loop, term)
        if getattr(lane, "switching", "") == "implicit" and _is_silent(packed, name, time):
            cycles = tuple(one and replace(one, amplitude=0.0) for one in cycles)
        instants.append(_Instant(time, plain, term, loop, cycles))
    thresholds = _thresholds(name, instants)
    common = _common_threshold(name, instants)
    joints = tuple(
        _joint(packed, name, run, slice(first, rows), joint, instants, thresholds)
        for joint in range(JOINTS)
    )
    return PredictionView(
        switching=getattr(lane, "switching", "twisting"),
        joints=joints,
        adaptive=adapted is not None,
        threshold=common,
        epsilon=_epsilon(getattr(lane, "epsilon", None), common, thresholds),
        since=float(run.time[first]),
    )


def _is_silent(packed: Packed, name: str, time: float) -> bool:
    """Tell whether the implicit sign holds a sampled loop, its joints coupled as they are."""
    sampled = packed.experiment.simulation.mode == "sampled"
    return sampled and period_map(packed, name, time).stable()


def _worst(instants: list[_Instant], joint: int) -> _Instant | None:
    """Return the instant at which a joint needs the widest layer."""
    swinging = [one for one in instants if one.cycles[joint] is not None]
    return max(swinging, key=lambda one: one.cycles[joint].crossing, default=None)  # type: ignore[union-attr]


def _crossings(instant: _Instant) -> Array:
    return np.array([0.0 if one is None else one.crossing for one in instant.cycles])


def _thresholds(name: str, instants: list[_Instant]) -> list[float | None]:
    """Return the layer that silences each joint, those that lock widened together."""
    found: dict[tuple[float, tuple[int, ...]], Array | None] = {}
    thresholds: list[float | None] = []
    for joint in range(JOINTS):
        worst = _worst(instants, joint)
        cycle = None if worst is None else worst.cycles[joint]
        if worst is None or cycle is None or worst.term.twisting:
            thresholds.append(None)
            continue
        key = worst.time, cycle.locked
        if key not in found:
            found[key] = silent_layer(worst.plain, name, _crossings(worst), *key)
        layers = found[key]
        thresholds.append(None if layers is None else float(layers[joint]))
    return thresholds


def _common_threshold(name: str, instants: list[_Instant]) -> float | None:
    """Return the one layer that silences all joints, at the worst instant."""
    if instants[0].term.twisting or not any(
        cycle is not None for one in instants for cycle in one.cycles
    ):
        return None
    widest = 0.0
    for one in instants:
        layers = silent_layer(one.plain, name, np.ones(JOINTS), one.time)
        if layers is None:
            return None
        widest = max(widest, float(layers[0]))
    return widest


def _wider(value: float) -> float:
    """Return a value rounded up to two digits, by a hundredth at least."""
    digits = 1 - int(np.floor(np.log10(value)))
    return float(round(np.ceil(1.01 * value * 10.0**digits) / 10.0**digits, digits))


def _epsilon(
    present: float | list[float] | None, common: float | None, thresholds: list[float | None]
) -> float | list[float] | None:
    if common is None or present is None:
        return None
    if not isinstance(present, list | tuple):
        return _wider(common)
    pairs = zip(present, thresholds, strict=True)
    return [float(now) if found is None else _wider(found) for now, found in pairs]


def _joint(
    packed: Packed,
    name: str,
    run: LaneRun,
    rows: slice,
    joint: int,
    instants: list[_Instant],
    thresholds: list[float | None],
) -> PredictedJoint:
    cycles = [one.cycles[joint] for one in instants]
    known = [cycle for cycle in cycles if cycle is not None]
    worst = _worst(instants, joint)
    cycle = None if worst is None else worst.cycles[joint]
    shown = worst or instants[0]
    layer = float(shown.term.layer[joint]) if shown.term.has_layer else 0.0
    curve, frequency, meets = np.empty((2, 0)), np.empty(0), None
    if worst is not None and cycle is not None:
        omega = np.geomspace(0.3 * cycle.omega, min(8.0 * cycle.omega, worst.loop.fastest), _CURVE)
        found = cycle.curve(worst.loop, joint, omega)
        curve, frequency = np.array([found.real, found.imag]), omega / (2.0 * np.pi)
        point = cycle.curve(worst.loop, joint, np.array([cycle.omega]))[0]
        # A switching function leaves a swing where it was: on the real axis, but for what is lost
        # in finding where.
        meets = (
            (float(point.real), float(point.imag))
            if worst.term.twisting
            else (-cycle.crossing, 0.0)
        )

    def usual(values: list[float], share: float = 0.5) -> float | None:
        return float(np.quantile(values, share)) if values else None

    least = _least(packed, layer, float(run.layer[joint]))
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
        layer=layer,
        threshold=thresholds[joint],
        locked=() if cycle is None else tuple(other + 1 for other in cycle.locked),
        load=max((_load(packed, name, one, joint) for one in instants), key=abs),
        gain=_gain(shown.plain, name, joint),
        curve=curve,
        curve_frequency=frequency,
        crossing=meets,
        line=np.empty((3, 0)) if cycle is None else _line(shown, joint, layer, cycle),
        measured_frequency=None if swing is None else swing.frequency,
        measured_amplitude=None if swing is None else swing.amplitude,
        limited=limited,
        sticking=sticking,
    )


def _gain(plain: Packed, name: str, joint: int) -> float:
    return float(np.broadcast_to(np.asarray(plain.experiment.lanes[name].k2, float), JOINTS)[joint])


def _load(packed: Packed, name: str, instant: _Instant, joint: int) -> float:
    """Return what of its torque a switching term needs to hold a joint on its surface."""
    load = float(instant.loop.load[joint])
    if not instant.term.twisting:
        return load
    bound = np.broadcast_to(np.asarray(packed.experiment.lanes[name].z_max, float), JOINTS)[joint]
    return load / float(bound) if bound > 0.0 else float(np.sign(load))


def _line(instant: _Instant, joint: int, layer: float, cycle: LimitCycle) -> Array:
    """Return amplitudes and -1/N(A), from a small swing to past the crossing. Shape (3, m)."""
    if instant.term.twisting:
        amplitudes = np.geomspace(1e-2, 4.0, _LINE) * cycle.amplitude
    elif layer == 0.0:
        amplitudes = np.geomspace(1e-2, 2.0, _LINE) * cycle.crossing
    else:
        amplitudes = np.geomspace(0.05 * layer, 3.0 * max(cycle.crossing, layer), _LINE)
    one, hold = instant.term.of([joint]), instant.loop.hold
    passed = [one.describing_function(np.array([A]), cycle.omega, hold)[0] for A in amplitudes]
    back = -1.0 / np.array(passed)
    return np.array([amplitudes, back.real, back.imag])


def _least(packed: Packed, layer: float, reached: float) -> float:
    """Return the amplitude in [rad/s] that is not yet a swing."""
    if layer > 0.0:
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
