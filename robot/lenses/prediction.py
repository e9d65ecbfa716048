"""The prediction lens: how each joint should chatter by harmonic balance, beside how it does."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from slidetune.robot.environment.layout import COULOMB, LIMIT
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.fields.quantity import bounds
from slidetune.robot.lenses.adapted_gain import adapted_gain
from slidetune.robot.lenses.instants import (
    Instant,
    along,
    balance_at,
    common_threshold,
    thresholds_of,
    worst_of,
)
from slidetune.robot.lenses.nyquist import balance_line, nyquist_curve
from slidetune.robot.lenses.swing import QUARTILE, Swing, swing_of
from slidetune.robot.loop.simulate import LaneRun
from slidetune.robot.margins.clearance import clearance_of
from slidetune.robot.margins.plain_lane import switches

Array = np.ndarray

MEASURED = 0.5
"""Share of the run, its end, in which the swing is measured (*ours*)."""
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
        amplitude: predicted of S in [rad/s], 0 where it should be silent, ``None`` where it swings
            farther and farther; as in ``Swing`` it is greater in a quarter of the time.
        alone: the same if no other joint switched.
        layer: its boundary layer at that instant in [rad/s]: epsilon, that of the implicit sign, or
            0 where it has none.
        threshold: boundary layer in [rad/s] from which on tanh is silent, the others within theirs;
            ``None`` where there is no limit cycle, none silences it, or it has none.
        locked: numbers of the joints that swing with it, itself among them.
        load: mean of sw that holds it on its surface; of super-twisting, share of z_max.
        gain: k2 at the worst instant, which an adaptive law changes, in its unit.
        curve: the Nyquist curve in [rad/s], of super-twisting in [s]: real parts, imaginary parts.
            Shape (2, n).
        curve_frequency: frequencies along it in [Hz]. Shape (n,).
        crossing: where it meets -1/N(A), real and imaginary part, ``None`` where it does not.
        clearance: angle in [rad] that it keeps from -1/N(A) where it does not meet it; ``None``
            where it does, and where it nowhere is as long as the layer is wide.
        nearest: frequency at which it comes so near in [Hz].
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
    clearance: float | None
    nearest: float | None
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
            list where the lane has one; a little wider, in two digits. ``None`` where it may not
            be so wide.
        since: from when on the run was measured in [s].
    """

    switching: str
    joints: tuple[PredictedJoint, ...]
    adaptive: bool
    threshold: float | None
    epsilon: float | list[float] | None
    since: float


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
    first = int(rows * (1.0 - MEASURED))
    adapted = adapted_gain(packed, name, run)
    instants = [
        balance_at(packed, name, float(run.time[row]), None if adapted is None else adapted[row])
        for row in along(packed, first, rows - 1, still=adapted is None)
    ]
    thresholds = thresholds_of(name, instants)
    common = common_threshold(name, instants)
    joints = tuple(
        _joint(packed, name, run, slice(first, rows), joint, instants, thresholds)
        for joint in range(packed.joints)
    )
    return PredictionView(
        switching=getattr(lane, "switching", "twisting"),
        joints=joints,
        adaptive=adapted is not None,
        threshold=common,
        epsilon=_epsilon(lane, common, thresholds),
        since=float(run.time[first]),
    )


def _wider(value: float) -> float:
    """Return a value rounded up to two digits, by a hundredth at least."""
    digits = 1 - int(np.floor(np.log10(value)))
    return float(round(np.ceil(1.01 * value * 10.0**digits) / 10.0**digits, digits))


def _epsilon(
    lane: Any, common: float | None, thresholds: list[float | None]
) -> float | list[float] | None:
    present = getattr(lane, "epsilon", None)
    if common is None or present is None:
        return None
    least, most = bounds(type(lane), "epsilon")
    if common > most:
        return None
    if not isinstance(present, list | tuple):
        return min(_wider(common), most)
    pairs = zip(present, thresholds, strict=True)
    wide = (float(now) if found is None else _wider(found) for now, found in pairs)
    return [min(max(one, least), most) for one in wide]


def _joint(
    packed: Packed,
    name: str,
    run: LaneRun,
    rows: slice,
    joint: int,
    instants: list[Instant],
    thresholds: list[float | None],
) -> PredictedJoint:
    cycles = [one.cycles[joint] for one in instants]
    known = [cycle for cycle in cycles if cycle is not None]
    worst = worst_of(instants, joint)
    cycle = None if worst is None else worst.cycles[joint]
    shown = worst or instants[0]
    layer = float(shown.term.layer[joint]) if shown.term.has_layer else 0.0
    meets, clearance = None, None
    omega, found = nyquist_curve(shown.loop, joint, cycle)
    if cycle is None and not shown.term.twisting:
        clearance = clearance_of(omega, found, layer)
    if worst is not None and cycle is not None:
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
    if cycle is not None and thresholds[joint] is None and not shown.term.twisting:
        amplitude = None  # no slope of a layer holds it: it has no limit cycle to come to
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
        curve=np.array([found.real, found.imag]),
        curve_frequency=omega / turns,
        crossing=meets,
        clearance=None if clearance is None else clearance.angle,
        nearest=None if clearance is None else clearance.omega / turns,
        line=balance_line(shown.loop, shown.term, joint, cycle, found),
        measured_frequency=None if swing is None else swing.frequency,
        measured_amplitude=None if swing is None else swing.amplitude,
        limited=limited,
        sticking=sticking,
    )


def _gain(plain: Packed, name: str, joint: int) -> float:
    k2 = np.asarray(plain.experiment.lanes[name].k2, float)
    return float(np.broadcast_to(k2, plain.joints)[joint])


def _load(packed: Packed, name: str, instant: Instant, joint: int) -> float:
    """Return what of its torque a switching term needs to hold a joint on its surface."""
    load = float(instant.loop.load[joint])
    if not instant.term.twisting:
        return load
    z_max = np.asarray(packed.experiment.lanes[name].z_max, float)
    bound = np.broadcast_to(z_max, packed.joints)[joint]
    return load / float(bound) if bound > 0.0 else float(np.sign(load))


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
