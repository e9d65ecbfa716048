"""The harmonic balance of a lane at several instants, and the layers that silence it at all."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from slidetune.robot.experiment.packed import Packed
from slidetune.robot.margins.harmonic_balance import LimitCycle, limit_cycles, swing_frequencies
from slidetune.robot.margins.margin import period_map, with_lane
from slidetune.robot.margins.plain_lane import as_plain
from slidetune.robot.margins.silence import silent_layer
from slidetune.robot.margins.switching_loop import SwitchingLoop, switching_loop
from slidetune.robot.margins.switching_term import SwitchingTerm
from slidetune.robot.motion.trajectory import HoldTrajectory

Array = np.ndarray

_INSTANTS = 7
"""Instants at which the balance is made, over the part of a run that is looked at (*ours*)."""


@dataclass(frozen=True)
class Instant:
    """The balance at one instant.

    Attributes:
        time: when along the desired motion, in [s].
        plain: the lane as k1 S and k2 times its switching term.
        smooth: the same with tanh in its place, where that is something else.
        term: the switching term.
        loop: what it is closed over.
        cycles: the limit cycle of each joint.
    """

    time: float
    plain: Packed
    smooth: Packed
    term: SwitchingTerm
    loop: SwitchingLoop
    cycles: tuple[LimitCycle | None, ...]


def along(packed: Packed, first: int, last: int, *, still: bool) -> list[int]:
    """Return the rows at which the balance is made, one where the desired pose is held.

    Args:
        packed: the experiment as numbers.
        first: the first row.
        last: the last one.
        still: whether the gains stay what they are.
    """
    held = still and isinstance(packed.experiment.trajectory, HoldTrajectory)
    return [int(row) for row in np.linspace(first, last, 1 if held else _INSTANTS).astype(int)]


def balance_at(
    packed: Packed, name: str, time: float, gain: Array | None = None, *, how_far: bool = True
) -> Instant:
    """Return the balance at one instant.

    Args:
        packed: the experiment as numbers.
        name: the lane, one that switches.
        time: when along the desired motion, in [s].
        gain: the present k2 of a law that adapts it, in [rad/s^2]. Shape (6,).
        how_far: whether the amplitudes are wanted.
    """
    plain, term = as_plain(packed, name, time, gain)
    loop = switching_loop(plain, name, time)
    cycles = _lasting(plain, name, time, loop, limit_cycles(loop, term, how_far=how_far))
    smooth = _smooth(packed, plain, name, time, gain)
    if smooth is not plain and _is_silent(packed, name, time):
        cycles = tuple(one and replace(one, amplitude=0.0) for one in cycles)
    return Instant(time, plain, smooth, term, loop, cycles)


def _lasting(
    plain: Packed,
    name: str,
    time: float,
    loop: SwitchingLoop,
    cycles: tuple[LimitCycle | None, ...],
) -> tuple[LimitCycle | None, ...]:
    """Return the limit cycles but for those of a loop that k1 alone makes stable.

    Such a loop, with a network for example, crosses the axis without k1, and has left it with k1.
    """
    turned = [
        one is not None and one.curve(loop, joint, np.array([one.omega]))[0].real > 0.0
        for joint, one in enumerate(cycles)
    ]
    if not any(turned) or silent_layer(plain, name, np.ones(plain.joints), time) is None:
        return cycles
    return tuple(None if gone else one for gone, one in zip(turned, cycles, strict=True))


def silent_from(packed: Packed, name: str, time: float) -> tuple[float | None, bool]:
    """Return the one layer with which tanh silences all joints at one instant.

    Without the limit cycles themselves, which take ten times as long.

    Args:
        packed: the experiment as numbers.
        name: the lane, one that switches and has a layer.
        time: when along the desired motion, in [s].

    Returns:
        The layer in [rad/s], ``None`` where none does; and whether there is a limit cycle at all.
    """
    plain, term = as_plain(packed, name, time)
    loop = switching_loop(plain, name, time)
    omega = swing_frequencies(loop, term)
    swinging = np.flatnonzero(np.isfinite(omega))
    smooth = _smooth(packed, plain, name, time)
    layers = silent_layer(smooth, name, np.ones(smooth.joints), time)
    own = loop.response(omega[swinging])[np.arange(len(swinging)), swinging, swinging]
    if layers is None:
        return None, len(own) > 0
    # What k1 alone has made stable has none, as in `_lasting`.
    return float(layers[0]), bool(np.any(own.real <= 0.0))


def _smooth(
    packed: Packed, plain: Packed, name: str, time: float, gain: Array | None = None
) -> Packed:
    """Return a plain lane with tanh in place of an implicit sign, whose gains are others."""
    if getattr(packed.experiment.lanes[name], "switching", "") != "implicit":
        return plain
    return as_plain(with_lane(packed, name, switching="tanh"), name, time, gain)[0]


def _is_silent(packed: Packed, name: str, time: float) -> bool:
    """Tell whether the implicit sign holds a sampled loop, its joints coupled as they are."""
    sampled = packed.experiment.simulation.mode == "sampled"
    return sampled and period_map(packed, name, time).stable()


def worst_of(instants: list[Instant], joint: int) -> Instant | None:
    """Return the instant at which a joint needs the widest layer, ``None`` if it swings at none."""
    swinging = [one for one in instants if one.cycles[joint] is not None]
    return max(swinging, key=lambda one: one.cycles[joint].crossing, default=None)  # type: ignore[union-attr]


def _crossings(instant: Instant) -> Array:
    return np.array([0.0 if one is None else one.crossing for one in instant.cycles])


def thresholds_of(name: str, instants: list[Instant]) -> list[float | None]:
    """Return the layer in [rad/s] with which tanh silences each joint, those that lock together.

    ``None`` where there is no limit cycle, none silences it, or the law has no layer.
    """
    found: dict[tuple[float, tuple[int, ...]], Array | None] = {}
    thresholds: list[float | None] = []
    for joint in range(len(instants[0].cycles)):
        worst = worst_of(instants, joint)
        cycle = None if worst is None else worst.cycles[joint]
        if worst is None or cycle is None or worst.term.twisting:
            thresholds.append(None)
            continue
        key = worst.time, cycle.locked
        if key not in found:
            found[key] = silent_layer(worst.smooth, name, _crossings(worst), *key)
        layers = found[key]
        thresholds.append(None if layers is None else float(layers[joint]))
    return thresholds


def common_threshold(name: str, instants: list[Instant]) -> float | None:
    """Return the one layer in [rad/s] with which tanh silences all joints, at the worst instant.

    ``None`` as for ``thresholds_of``.
    """
    if instants[0].term.twisting or not any(
        cycle is not None for one in instants for cycle in one.cycles
    ):
        return None
    widest = 0.0
    for one in instants:
        layers = silent_layer(one.smooth, name, np.ones(len(one.cycles)), one.time)
        if layers is None:
            return None
        widest = max(widest, float(layers[0]))
    return widest
