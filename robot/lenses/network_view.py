"""The network lens: the Gaussians over what they were asked, the weights, and what was learnt."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slidetune.robot.experiment.packed import Packed
from slidetune.robot.laws.terms.network import NetworkGains
from slidetune.robot.lenses import observer_view
from slidetune.robot.lenses.observer_view import ObserverView
from slidetune.robot.lenses.probe import Probe
from slidetune.robot.lenses.screen import every_few
from slidetune.robot.loop.response import thinned
from slidetune.robot.loop.simulate import LaneRun

Array = np.ndarray

ANSWER = 0.1
"""Least output with which a Gaussian counts as answering an input (*ours*)."""
TORQUE_ROWS = 500
"""Rows at which the needed torque is evaluated (*ours*)."""
BINS = 40
"""Bars of the histogram of visited inputs (*ours*)."""
STILL = 1e-9
"""Span of an input in [rad] below which it stands still (*ours*)."""


@dataclass(frozen=True)
class NetworkJoint:
    """One joint's network.

    Attributes:
        width: width of its Gaussians in [rad].
        low: least input visited in [rad].
        high: greatest input visited in [rad].
        visits: share of the run in each of the bins between ``low`` and ``high``. Shape (40,).
        coverage: share of the run in which some Gaussian answers with more than 0.1.
        spread: by how much the answer of the most sensitive Gaussian changes over the inputs
            visited, 0 to 1; near 0 the network can't tell one input from another.
        effective_nodes: how many of the ten act independently of each other, 1 to 10.
        weights: weights at the end in [N m]. Shape (10,).
        norm: norm of the weights over time in [N m]. Shape (n,).
        f: output in [N m]. Shape (m,).
        needed: torque that an exact model would have needed in [N m]. Shape (m,).
        learnt: share of the needed torque (as root mean square over the second half of the run)
            that the network carries; 1 is all, 0 none, below 0 worse than none.
        needed_rms: that root mean square of the needed torque in [N m].
        missing_rms: the same of what the network leaves to the reaching law in [N m].
    """

    width: float
    low: float
    high: float
    visits: Array
    coverage: float
    spread: float
    effective_nodes: float
    weights: Array
    norm: Array
    f: Array
    needed: Array
    learnt: float | None
    needed_rms: float
    missing_rms: float


@dataclass(frozen=True)
class NetworkView:
    """What the network lens shows.

    Attributes:
        input: what the Gaussians look at: ``error``, ``angle`` or ``desired``.
        centers: centres of the Gaussians in [rad]. Shape (10,).
        joints: the six joints.
        norm_time: time of the norms in [s]. Shape (n,).
        torque_time: time of f and of the needed torque in [s]. Shape (m,).
    """

    input: str
    centers: Array
    joints: tuple[NetworkJoint, ...]
    norm_time: Array
    torque_time: Array


def visited_inputs(gains: NetworkGains, run: LaneRun) -> Array:
    """Return what the network of each joint was asked in [rad] (without sensor noise).

    Shape (n, 6).
    """
    inputs: dict[str, Array] = {"error": run.e, "angle": run.q, "desired": run.q + run.e}
    return inputs[gains.network_input]


def hidden_outputs(inputs: Array, centers: Array, width: float) -> Array:
    r"""Return the outputs of the Gaussians (Eq. 19).

    .. math:: h_j = \exp\frac{-(x - c_j)^2}{2 b^2}

    Args:
        inputs: inputs of one joint in [rad]. Shape (n,).
        centers: centres in [rad]. Shape (10,).
        width: width b in [rad].

    Returns:
        Shape (n, 10).
    """
    distance = (inputs[:, None] - centers) / width
    return np.asarray(np.exp(-0.5 * distance * distance))


def effective_nodes(hidden: Array) -> float:
    r"""Return how many Gaussians act independently over the inputs visited.

    .. math:: \frac{(\sum_i \sigma_i^2)^2}{\sum_i \sigma_i^4}

    with the singular values of the hidden outputs: 1 where all rise and fall together, and the
    number of nodes where each answers other inputs, as often and as strongly.

    Args:
        hidden: hidden outputs over the run. Shape (n, 10).
    """
    power = np.clip(np.linalg.eigvalsh(hidden.T @ hidden), 0.0, None)
    largest = float(power.max())
    if largest == 0.0:
        return 0.0
    # Of Gaussians far from all inputs even the squares may be no number any more.
    share = power / largest
    return float(share.sum()) ** 2 / float(np.square(share).sum())


def _needed(packed: Packed, name: str, run: LaneRun, chosen: Array) -> Array:
    probe = Probe(packed, name)
    rows = [probe.needed_torque(float(run.time[i]), run.q[i], run.v[i]) for i in chosen]
    return np.array(rows)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def look(
    packed: Packed, name: str, run: LaneRun, quiet: LaneRun | None = None
) -> NetworkView | ObserverView | None:
    """Look at a lane's run through the network lens.

    Args:
        packed: the experiment as numbers.
        name: the lane.
        run: what it did.
        quiet: what it did without sensor noise; not looked at.

    Returns:
        What its observer saw where the law has no network; ``None`` where it has neither.
    """
    gains = packed.experiment.lanes[name]
    if not isinstance(gains, NetworkGains):
        return observer_view.look(packed, name, run)
    rows = max(1, int(np.isfinite(run.q[:, 0]).sum()))
    inputs = visited_inputs(gains, run)[:rows]
    centers, widths = (
        gains.centers(),
        np.broadcast_to(np.asarray(gains.width, float), packed.joints),
    )
    norm_time, norms = thinned(run.time[:rows], run.weights[:rows])
    chosen = every_few(rows, TORQUE_ROWS)
    needed, f = _needed(packed, name, run, chosen), run.f[chosen]
    late = chosen >= rows // 2
    joints = []
    for j in range(packed.joints):
        x = inputs[:, j]
        hidden = hidden_outputs(x, centers, float(widths[j]))
        moves = float(np.ptp(x)) > STILL
        counts = np.histogram(x, BINS, (x.min(), x.max()))[0] if moves else np.ones(1)
        asked, missing = _rms(needed[late, j]), _rms(needed[late, j] - f[late, j])
        joints.append(
            NetworkJoint(
                width=float(widths[j]),
                low=float(x.min()),
                high=float(x.max()),
                visits=counts / counts.sum(),
                coverage=float(np.mean(hidden.max(axis=1) > ANSWER)),
                spread=float(np.max(np.ptp(hidden, axis=0))),
                effective_nodes=effective_nodes(hidden),
                weights=run.final_weights[:, j],
                norm=norms[j],
                f=f[:, j],
                needed=needed[:, j],
                learnt=1.0 - missing / asked if asked > 1e-9 else None,
                needed_rms=asked,
                missing_rms=missing,
            )
        )
    return NetworkView(gains.network_input, centers, tuple(joints), norm_time, run.time[chosen])
