"""Bounded least squares of the equation, and how far its answer may be off.

Intervals allow for residuals that depend on each other, in time and between joints: the covariance
is the sandwich of Newey and West 1987, with the bandwidth of Andrews 1991 and the critical value of
Kiefer and Vogelsang 2005. They presuppose that the equation holds and that angles are far less
noisy than torques.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from slidetune.robot.identification.regressor import INERTIAL, Equation, Placed, payload_columns

Array = np.ndarray

PAYLOAD = 4
"""Numbers of the payload: mass, and the three of its centre."""
_WEIGHINGS = 3
"""Fits in turn with the weights that the one before tells (*ours*)."""
_AT_BOUND = 1e-6
"""Share of a range within which a number is at its bound (*ours*)."""
_LARGEST_CORRELATION = 0.97
"""Correlation of neighbouring rows beyond which none is believed (*ours*)."""
_WIDEST = 0.2
"""Largest bandwidth as a share of the rows (*ours*)."""


class Solution(NamedTuple):
    """An answer.

    Attributes:
        values: of all numbers, those that are fixed included. Shape (p,).
        free: the same without bounds, the middle of the intervals. Shape (p,).
        deviation: half the width of each one's interval; 0 where it is fixed. Shape (p,).
        slopes: of the torque over the numbers where they are free, in deviations of each joint's
            noise. Shape (r n, p).
        noise: effective residual of each joint in [N m]. Shape (n,).
        residual: measured minus fitted torque in [N m]. Shape (r, n).
    """

    values: Array
    free: Array
    deviation: Array
    slopes: Array
    noise: Array
    residual: Array


def solve(
    equation: Equation,
    flange: Placed,
    begin: Array,
    fitted: Array,
    lower: Array,
    upper: Array,
    shifted: bool = False,
) -> Solution:
    """Fit some of the numbers within their bounds.

    Every joint is weighted by its own noise, which a first fit tells.

    Args:
        equation: at every row.
        flange: where the flange stands.
        begin: mass, centre, armature, viscous and Coulomb friction and constant torque of each
            joint: where to begin, and what is fixed. Shape (p,).
        fitted: which of them are fitted. Shape (p,).
        lower: least values. Shape (p,).
        upper: greatest values. Shape (p,).
        shifted: whether the torque was shifted in time by what the log told, see
            ``lateness_of``: intervals then allow for that too.
    """
    values, noise = _weighted(equation, flange, begin, fitted, (lower, upper))
    slack = _AT_BOUND * (upper - lower)
    values = np.where(fitted & (values < lower + slack), lower, values)
    values = np.where(fitted & (values > upper - slack), upper, values)
    free = values
    if (fitted & ((values == lower) | (values == upper))).any():
        # What the log asks for without bounds; the centre stays within a body's size.
        wide = np.arange(len(values)) >= PAYLOAD
        wide[0] = True
        ends = np.where(wide, -np.inf, lower), np.where(wide, np.inf, upper)
        free, noise = _weighted(equation, flange, values, fitted, ends)
    slopes = (equation.columns @ extended(flange, free)[1]) / noise[:, None]
    rest = equation.torque - equation.known
    scaled = (rest - equation.columns @ extended(flange, free)[0]) / noise
    deviation = np.zeros(len(values))
    columns = np.compress(fitted, slopes, axis=2)
    if shifted:
        columns = np.dstack([columns, equation.rate / noise])
    deviation[fitted] = half_widths(columns, scaled)[: int(fitted.sum())]
    residual = rest - equation.columns @ extended(flange, values)[0]
    return Solution(values, free, deviation, slopes.reshape(-1, len(values)), noise, residual)


def _weighted(
    equation: Equation, flange: Placed, begin: Array, fitted: Array, ends: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Return the numbers of the least sum of squares, each joint by its noise, and that noise."""
    rest = equation.torque - equation.known
    noise, values = np.ones(rest.shape[1]), begin
    for _ in range(_WEIGHINGS):
        values = _minimum(equation, flange, values, fitted, ends, noise)
        residual = rest - equation.columns @ extended(flange, values)[0]
        noise = np.maximum(np.sqrt(np.mean(residual**2, axis=0)), 1e-9 * equation.weight)
    return values, noise


def extended(flange: Placed, values: Array) -> tuple[Array, Array]:
    """Return what the columns of the equation are multiplied by, and its slopes.

    Shapes (10 + 4 n,) and (10 + 4 n, 4 + 4 n).
    """
    body, slopes = payload_columns(flange, float(values[0]), values[1:PAYLOAD])
    rest = len(values) - PAYLOAD
    whole = np.zeros((INERTIAL + rest, PAYLOAD + rest))
    whole[:INERTIAL, :PAYLOAD] = slopes
    whole[INERTIAL:, PAYLOAD:] = np.eye(rest)
    return np.asarray(np.append(body, values[PAYLOAD:])), whole


def _minimum(
    equation: Equation,
    flange: Placed,
    begin: Array,
    fitted: Array,
    bounds: tuple[Array, Array],
    noise: Array,
) -> Array:
    """Return the numbers with the least sum of squares within their bounds."""
    from scipy.optimize import least_squares, lsq_linear  # here, because it takes long to import

    width = equation.columns.shape[2]
    matrix = (equation.columns / noise[:, None]).reshape(-1, width)
    wanted = ((equation.torque - equation.known) / noise).reshape(-1)
    # All rows in as many as there are columns: the sum of squares is the same but for a constant.
    triangle = np.asarray(np.linalg.qr(np.column_stack([matrix, wanted]), mode="r"))
    matrix, wanted = triangle[:, :-1], triangle[:, -1]
    lower, upper = bounds
    values = np.clip(begin, lower, upper)
    linear = fitted.copy()
    linear[1:PAYLOAD] = False  # the centre multiplies the mass
    columns = matrix @ extended(flange, values)[1]
    fixed = np.where(linear, 0.0, values)
    rest = wanted - matrix @ extended(flange, fixed)[0]
    if linear.any():
        first = lsq_linear(columns[:, linear], rest, (lower[linear], upper[linear]))
        values[linear] = np.clip(first.x, lower[linear], upper[linear])
    if not fitted[1:PAYLOAD].any():
        return np.asarray(values)

    def put(some: Array) -> Array:
        whole: Array = values.copy()
        whole[fitted] = some
        return whole

    found = least_squares(
        lambda some: matrix @ extended(flange, put(some))[0] - wanted,
        np.clip(values[fitted], lower[fitted], upper[fitted]),
        jac=lambda some: (matrix @ extended(flange, put(some))[1])[:, fitted],
        bounds=(lower[fitted], upper[fitted]),
        x_scale="jac",
        xtol=1e-13,
        ftol=1e-13,
        gtol=1e-13,
    )
    return put(np.asarray(found.x))


def half_widths(slopes: Array, residual: Array) -> Array:
    """Return half the widths of the 95 % intervals.

    Args:
        slopes: shape (r, n, k).
        residual: in deviations of each joint's noise. Shape (r, n).
    """
    rows, joints, count = slopes.shape
    if count == 0:
        return np.zeros(0)
    flat = np.reshape(slopes, (-1, count))
    scale = np.maximum(np.sqrt((flat**2).sum(axis=0)), 1e-300)
    bread = np.linalg.pinv((flat / scale).T @ (flat / scale), hermitian=True)
    scores = np.einsum("rnk,rn->rk", slopes, residual) / scale
    bandwidth = _bandwidth(scores)
    of_rows = scores.T @ scores
    meat = of_rows.copy()
    for lag in range(1, bandwidth + 1):
        shared = scores[lag:].T @ scores[:-lag]
        meat += (1.0 - lag / (bandwidth + 1.0)) * (shared + shared.T)
    spare = max(rows * joints - count, 1)
    alone = bread * float((residual**2).sum()) / spare
    # Never narrower than of noise that is white, or white but for what joints share.
    sandwiches = [bread @ one @ bread * (rows * joints / spare) for one in (of_rows, meat)]
    variance = np.max([np.diag(one) for one in (alone, *sandwiches)], axis=0)
    deviation: Array = np.sqrt(np.maximum(variance, 0.0)) / scale
    return _critical(bandwidth / rows) * deviation


def _bandwidth(scores: Array) -> int:
    """Return over how many rows residuals depend on each other (Andrews 1991, Eq. 6.2 and 6.4)."""
    rows = len(scores)
    square = (scores**2).sum(axis=0)
    seen = square > 0.0
    if not seen.any():
        return 0
    rho = (scores[1:, seen] * scores[:-1, seen]).sum(axis=0) / square[seen]
    rho = np.clip(rho, -_LARGEST_CORRELATION, _LARGEST_CORRELATION)
    variance = (square[seen] / rows * (1.0 - rho**2)) ** 2
    above = (4.0 * rho**2 * variance / ((1.0 - rho) ** 6 * (1.0 + rho) ** 2)).sum()
    below = (variance / (1.0 - rho) ** 4).sum()
    return int(min(np.ceil(1.1447 * (above / below * rows) ** (1.0 / 3.0)), _WIDEST * rows))


def _critical(share: float) -> float:
    """Return the two-sided 95 % value for a bandwidth (Kiefer and Vogelsang 2005, Bartlett)."""
    return 1.9600 + 2.9694 * share + 0.4160 * share**2 - 0.5324 * share**3
