"""The sliding-mode lens: the (e, de) plane, the sliding curve and its layer, and V over time.

e = q_d - q and de = v_d - v, everywhere in this project.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from slidetune.robot.experiment.packed import Packed
from slidetune.robot.lenses.probe import Probe
from slidetune.robot.lenses.screen import evenly_along, every_few
from slidetune.robot.loop.response import thinned
from slidetune.robot.loop.simulate import LaneRun

Array = np.ndarray

PATH_POINTS = 600
"""Points of a joint's path in the plane (*ours*)."""
CURVE_POINTS = 121
"""Points of a joint's sliding curve; odd, so that one is the origin (*ours*)."""
ENERGY_ROWS = 20_000
"""Rows at which V is evaluated at most (*ours*)."""


@dataclass(frozen=True)
class SlidingJoint:
    """One joint in its plane.

    Attributes:
        time: time of the path's points in [s]. Shape (n,).
        e: error along the path in [rad]. Shape (n,).
        de: velocity error along the path in [rad/s]. Shape (n,).
        curve_e: error on the sliding curve S = 0 in [rad], NaN where S does not depend on e.
            Shape (m,).
        curve_de: velocity error there in [rad/s]. Shape (m,).
        layer: boundary layer in [rad/s], 0 where the law has none.
        layer_width: by how much the curves of S = layer lie beside that of S = 0 in [rad],
            ``None`` where there is no such curve.
        reaching_time: when S first came within the layer in [s], ``None`` for never.
        last_outside: when S last was outside the layer in [s], ``None`` for never.
        inside: share of the time within the layer.
        time_constant: with which a small error dies on the curve in [s], ``None`` where it stays.
    """

    time: Array
    e: Array
    de: Array
    curve_e: Array
    curve_de: Array
    layer: float
    layer_width: float | None
    reaching_time: float | None
    last_outside: float | None
    inside: float
    time_constant: float | None


@dataclass(frozen=True)
class SlidingView:
    """What the sliding-mode lens shows.

    Attributes:
        joints: the six joints.
        time: time of V in [s], two instants a bucket. Shape (k,).
        V: half of S^T M S. Shape (k,).
        V_rate: its derivative over time. Shape (k,).
        growing: share of the time in which V grows.
        outside: share of the time in which some S is outside its layer.
        turns: how often a second V turns between growing and falling.
        growing_outside: share of that time in which V grows; ``None`` where there is none.
        quiet_turns: turns a second in a run without sensor noise; ``None`` where there is none.
    """

    joints: tuple[SlidingJoint, ...]
    time: Array
    V: Array
    V_rate: Array
    growing: float
    outside: float
    turns: float
    growing_outside: float | None
    quiet_turns: float | None = None


def sliding_curve(packed: Packed, name: str, de: Array) -> Array:
    """Return the error at which S = 0, for given velocity errors (Eq. 5).

    S is linear in e, so that one evaluation of the law at e = 0 gives it.

    Args:
        packed: the experiment as numbers.
        name: the lane.
        de: velocity errors in [rad/s]. Shape (n, 6).

    Returns:
        Errors in [rad], NaN of a joint whose S does not depend on e. Shape (n, 6).
    """
    probe = Probe(packed, name)
    curve = np.empty_like(de)
    for row, rate in enumerate(de):
        S, S_E, _ = probe.surface(np.zeros_like(rate), rate)
        curve[row] = np.divide(-S, S_E, out=np.full_like(S, np.nan), where=S_E != 0.0)
    return curve


def energy(packed: Packed, q: Array, sliding: Array) -> Array:
    r"""Return how far the arm is from its sliding surfaces (first term of Eq. 23).

    .. math:: V = \tfrac12 S^T M(q) S

    Args:
        packed: the experiment as numbers; M is that of the true arm.
        q: joint angles in [rad]. Shape (n, 6).
        sliding: sliding variables in [rad/s]. Shape (n, 6).

    Returns:
        V in [J]. Shape (n,).
    """
    data, M = packed.model.createData(), np.empty((len(q), packed.joints, packed.joints))
    for row, angles in enumerate(q):
        M[row] = pin.crba(packed.model, data, angles)
    V: Array = 0.5 * np.einsum("ni,nij,nj->n", sliding, M, sliding)
    return V


def _spread(packed: Packed, name: str, run: LaneRun, rows: int) -> tuple[Array, Array, Array]:
    """Return velocity errors that reach beyond the run and the layer, and both slopes of S."""
    _, S_E, S_V = Probe(packed, name).surface(*np.zeros((2, packed.joints)))
    reach = 1.4 * np.max(np.abs(run.de[:rows]), axis=0)
    reach = np.maximum(np.maximum(reach, 1.6 * run.layer / S_V), 1e-9)
    # Denser about the origin, where the terminal term bends the curve.
    share = np.linspace(-1.0, 1.0, CURVE_POINTS)
    return (share * np.abs(share))[:, None] * reach, S_E, S_V


def _share(chosen: Array) -> float:
    return float(np.mean(chosen)) if len(chosen) else 0.0


def look(packed: Packed, name: str, run: LaneRun, quiet: LaneRun | None = None) -> SlidingView:
    """Look at a lane's run through the sliding-mode lens.

    Args:
        packed: the experiment as numbers.
        name: the lane.
        run: what it did.
        quiet: what it did without sensor noise, where there is any.
    """
    rows = max(1, int(np.isfinite(run.q[:, 0]).sum()))
    time, S = run.time[:rows], run.S[:rows]
    outside = np.abs(S) > run.layer
    curve_de, S_E, S_V = _spread(packed, name, run, rows)
    curve_e = sliding_curve(packed, name, curve_de)
    reaching = run.metrics.reaching_time
    joints = []
    for j in range(packed.joints):
        chosen = evenly_along(run.e[:rows, j], run.de[:rows, j], PATH_POINTS)
        left = np.flatnonzero(outside[:, j])
        joints.append(
            SlidingJoint(
                time=time[chosen],
                e=run.e[chosen, j],
                de=run.de[chosen, j],
                curve_e=curve_e[:, j],
                curve_de=curve_de[:, j],
                layer=float(run.layer[j]),
                layer_width=float(run.layer[j] / S_E[j]) if S_E[j] else None,
                reaching_time=reaching[j],
                last_outside=float(time[left[-1]]) if len(left) else None,
                inside=1.0 - _share(outside[:, j]),
                time_constant=float(S_V[j] / S_E[j]) if S_E[j] else None,
            )
        )
    growth = _growth(packed, run, rows, outside.any(axis=1))
    quiet_turns = None if quiet is None else _turns(packed, quiet)
    return SlidingView(tuple(joints), *growth, quiet_turns)


def _growth(
    packed: Packed, run: LaneRun, rows: int, outside: Array
) -> tuple[Array, Array, Array, float, float, float, float | None]:
    """Return what ``SlidingView`` says of V, in its order."""
    chosen, V, dV = _energy_over_time(packed, run, rows)
    time, grows, beyond = run.time[chosen], dV > 0.0, outside[chosen]
    instants, columns = thinned(time, np.column_stack([V, dV]))
    growing_outside = _share(grows[beyond]) if beyond.any() else None
    turns = _turns_of(time, grows)
    shares = _share(grows), _share(beyond), turns, growing_outside
    return instants, columns[0], columns[1], *shares


def _energy_over_time(packed: Packed, run: LaneRun, rows: int) -> tuple[Array, Array, Array]:
    """Return the rows looked at, V there and its derivative."""
    chosen = every_few(rows, ENERGY_ROWS)
    V = energy(packed, run.q[chosen], run.S[chosen])
    dV = np.gradient(V, run.time[chosen]) if len(V) > 1 else np.zeros(len(V))
    return chosen, V, dV


def _turns_of(time: Array, grows: Array) -> float:
    return float(np.count_nonzero(np.diff(grows)) / max(float(np.ptp(time)), 1e-9))


def _turns(packed: Packed, run: LaneRun) -> float:
    """Return how often a second V turns between growing and falling."""
    rows = max(1, int(np.isfinite(run.q[:, 0]).sum()))
    chosen, _, dV = _energy_over_time(packed, run, rows)
    return _turns_of(run.time[chosen], dV > 0.0)
