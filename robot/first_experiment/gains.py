"""Gains of every law from an arm's own inertia and the control rate; docs/own-arm.md has the rule.

e = q_d - q, so that a positive sliding variable asks for a positive torque.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np

from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.fields.quantity import bounds
from slidetune.robot.first_experiment.motion import Swing, rounded_down
from slidetune.robot.kernels.workspace import NODES
from slidetune.robot.laws import LAWS
from slidetune.robot.laws.integral_smc import IntegralSmc
from slidetune.robot.laws.terms.switching import HELD, ReachingGains

Array = np.ndarray
Gains = dict[str, Any]

GAMMA = 0.8
"""Sampling margin that the gains are scaled to (*ours*): an undelayed damper diverges at 2."""
_FALLS = 1.5
"""How many times faster S falls than the error does on its surface, without a model (*ours*)."""
_PERIODS = 100.0
"""Control periods of the error's time constant at least (*ours*)."""
MOST_K1, MOST_K2 = bounds(ReachingGains, "k1")[1], bounds(ReachingGains, "k2")[1]
MOST_KD = bounds(IntegralSmc, "kd")[1]
DISTURBANCE = 0.1
"""Constant disturbance as part of the torque that a joint needs, as if the arm were so much heavier
(*ours*).
"""


@dataclass(frozen=True)
class Scale:
    """What gains are made of.

    Attributes:
        period: control period T in [s].
        gamma: sampling margin to reach [-].
        damping: D = (k1 + k2/ε) dS/d(de) of each joint in [N m s/rad]. Shape (n,).
        error_rate: rate λ at which the error decays on the surface in [1/s].
        free_rate: the same for laws without a model [1/s].
        disturbance: constant torque of each joint in [N m]. Shape (n,).
        torque: the greatest torque of the motion in [N m]. Shape (n,).
        push: the greatest acceleration that the disturbance causes in [rad/s^2]. Shape (n,).
    """

    period: float
    gamma: float
    damping: Array
    error_rate: float
    free_rate: float
    disturbance: Array
    torque: Array
    push: Array


def scale_of(swing: Swing, rate: float, gamma: float = GAMMA) -> Scale:
    r"""Return the size of gains for an arm that swings, by its own inertia.

    .. math:: D_j = s\,d_j, \quad s: \max_t \lambda_{max}(T D M^{-1}) = \gamma, \qquad
        \lambda = \frac{1}{100\,T}, \quad
        \lambda_{free} = \min\!\left(\lambda,\; \frac{r}{1.5}\right), \quad
        r = \min_t \lambda_{min}(M^{-1} D)

    Of :math:`d_j = \min_t 1/(M^{-1})_{jj}`, the inertia of a joint while the others are free,
    :math:`\max_t M_{jj}`, that while they are held, and their geometric mean, the one counts that
    makes r the greatest.

    Args:
        swing: the motion.
        rate: control rate 1/T in [Hz].
        gamma: sampling margin [-].
    """
    inverses = np.linalg.inv(swing.inertias)
    free = (1.0 / np.diagonal(inverses, axis1=1, axis2=2)).min(axis=0)
    held = np.diagonal(swing.inertias, axis1=1, axis2=2).max(axis=0)
    found = [_damped(one, inverses, gamma * rate) for one in (free, held, np.sqrt(free * held))]
    slowest, damping = max(found, key=lambda one: one[0])
    disturbance = _two_digits(np.clip(DISTURBANCE * swing.load, *bounds(Disturbance, "constant")))
    return Scale(
        1.0 / rate,
        gamma,
        damping,
        rate / _PERIODS,
        min(rate / _PERIODS, slowest / _FALLS),
        disturbance,
        swing.torque,
        np.abs(inverses @ disturbance).max(axis=0),
    )


def _damped(share: Array, inverses: Array, most: float) -> tuple[float, Array]:
    """Return the slowest rate at which S falls in [1/s], and D, where the fastest is ``most``."""
    rates = [_rates(share, inverse) for inverse in inverses]
    factor = most / max(float(rate.max()) for rate in rates)
    damping = np.minimum(factor * share, 2.0 * MOST_K1)
    return min(float(_rates(damping, inverse).min()) for inverse in inverses), damping


def _two_digits(values: Array) -> Array:
    return np.array([float(f"{value:.2g}") for value in values])


def _rates(damping: Array, inverse: Array) -> Array:
    """Return the eigenvalues of D M^-1, by the symmetric matrix that is similar to it."""
    root = np.sqrt(damping)
    found: Array = np.linalg.eigvalsh(root[:, None] * inverse * root)
    return found


def first_gains(law: str, scale: Scale) -> Gains:
    """Return a lane of a law, as plain JSON values.

    Args:
        law: name of a law that ships with the program.
        scale: of the arm, at its control rate.

    Raises:
        KeyError: for a law that has no rule.
    """
    lane = {"law": law, **_RULES[law](scale)}
    section = LAWS[law].lane
    return {key: _within(section, key, value) for key, value in lane.items()}


def _within(section: Any, key: str, value: Any) -> Any:
    """Return a value of a field within what it permits; equal ones of all joints as one."""
    if isinstance(value, str):
        return value
    low, high = bounds(section, key)
    values = np.clip(rounded_down(np.atleast_1d(np.asarray(value, dtype=float))), low, high)
    numbers = values.tolist()
    return numbers[0] if np.ndim(value) == 0 else numbers


def _reaching(damping: Array, reject: Array) -> Gains:
    """Return a reaching law, half of whose damping is its layer's: k1 = D/2, ε = 2 k2/D."""
    low, high = bounds(ReachingGains, "epsilon")
    k1 = np.minimum(0.5 * damping, MOST_K1)
    k2 = np.minimum(reject, MOST_K2)
    epsilon = np.clip(k2 / np.maximum(k1, 1e-12), low, high)
    # A layer has an end: where it would be wider, the switching term is what it can be.
    return {"k1": k1, "k2": np.minimum(k2, epsilon * k1), "epsilon": epsilon}


def _nftsm_surface(rate: float) -> Gains:
    return {"nu": rate, "c": 1.0, "mu": 0.1, "p": 5.0, "k": 3.0}


def _network(scale: Scale) -> Gains:
    """Return a network that is an integral of S, ten Gaussians of nearly 1, half as fast as e."""
    rate = 0.5 * scale.free_rate
    return {"learning_rate": scale.damping * rate / NODES, "width": 10.0}


def _model_free(scale: Scale) -> Gains:
    """Reject all torque of the motion: what the law doesn't know is a disturbance."""
    return {**_reaching(scale.damping, scale.torque + np.abs(scale.disturbance)), **_network(scale)}


def _model_based(scale: Scale) -> Gains:
    return _reaching(scale.damping, 2.0 * np.abs(scale.disturbance))


def _shaped(scale: Scale, share: float, reject: Array) -> Gains:
    """Return a reaching law behind M, whose damping is a share of γ/T."""
    damping = np.full(len(scale.push), share * scale.gamma / scale.period)
    return _reaching(damping, reject)


def _pd(scale: Scale) -> Gains:
    """Return a critically damped error equation with the damping γ/4T, at most 200 1/s."""
    kd = min(0.25 * scale.gamma / scale.period, MOST_KD)
    return {"kp": 0.25 * kd**2, "kd": kd}


def _super_twisting(scale: Scale) -> Gains:
    """Return k1 = 1.5 √L and k2 = 1.1 L (Levant 1998), L ten times the push a second.

    At |S| = HELD the root over S is not above γ/T, which bounds L.
    """
    most = sqrt(HELD) * scale.gamma / scale.period
    k1 = np.minimum(1.5 * np.sqrt(10.0 * scale.push), most)
    z_max = 4.0 * scale.push + 1.0
    return {"lambda_": scale.error_rate, "k1": k1, "k2": 1.1 * (k1 / 1.5) ** 2, "z_max": z_max}


def _adaptive(scale: Scale) -> Gains:
    """Return a gain that may grow to four times the push, within about a second."""
    reaching = _shaped(scale, 0.5, 4.0 * scale.push)
    return {
        "lambda_": scale.error_rate,
        **reaching,
        "k2_min": 0.25 * reaching["k2"],
        "adaptation_rate": 2.0 * reaching["k2"] / reaching["epsilon"],
    }


_RULES: dict[str, Callable[[Scale], Gains]] = {
    "rbfnn_nftsm": lambda scale: {**_nftsm_surface(scale.free_rate), **_model_free(scale)},
    "rbfnn_smc": lambda scale: {"lambda_": scale.free_rate, **_model_free(scale)},
    "nftsm": lambda scale: {**_nftsm_surface(scale.error_rate), **_model_based(scale)},
    "smc": lambda scale: {"lambda_": scale.error_rate, **_model_based(scale)},
    "super_twisting": _super_twisting,
    "integral_smc": lambda scale: {**_pd(scale), **_shaped(scale, 0.25, 2.0 * scale.push)},
    "adaptive_smc": _adaptive,
    "computed_torque": lambda scale: _pd(scale),
}
RULED_LAWS = frozenset(_RULES)
"""Laws that ``first_gains`` has a rule for."""
