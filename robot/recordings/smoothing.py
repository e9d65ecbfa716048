"""A smoothing spline of degree five through a recording: P-splines, with cross-validation.

O'Sullivan 1986, Eilers and Marx 1996: least squares on fewer knots than rows, with a penalty on the
integral of the third derivative's square, whose weight minimises the generalised cross-validation
(Craven and Wahba 1979), a joint at a time. Where there are no rows the penalty alone counts: the
motion with the least jerk.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from slidetune.robot.motion.recorded import DEGREE, spline_knots

Array = np.ndarray

_RIDGE = 1e-9
"""Share of the penalty that is always there (*ours*): it decides where there are no rows."""
_WEIGHTS = np.logspace(-4.0, 12.0, 81)
"""Weights of the penalty that are tried, in shares of that one (*ours*)."""
_TIED = 3
"""Coefficients that are one at an end at rest: angle, velocity and acceleration."""
_FLOOR = 1e-13
"""Share of a signal's square below which a residual is rounding (*ours*)."""


class Smoothed(NamedTuple):
    """A smoothing spline.

    Attributes:
        waypoints: its values at evenly spaced times from 0 on in [rad]. Shape (m, n).
        spacing: time between two of them in [s].
        residual: rows minus spline in [rad]. Shape (r, n).
        validated: effective residual in [rad] of rows that were left out, estimated: the root of
            the generalised cross-validation. Shape (n,).
    """

    waypoints: Array
    spacing: float
    residual: Array
    validated: Array


def smooth(time: Array, q: Array, count: int, spacing: float) -> Smoothed:
    """Return the spline through ``count`` waypoints that a recording asks for.

    Args:
        time: time in [s] from 0 on, rising, at most until the last waypoint. Shape (r,).
        q: angles in [rad]. Shape (r, n).
        count: how many waypoints.
        spacing: time between two of them in [s].
    """
    from scipy.interpolate import BSpline  # here, because it takes long to import
    from scipy.linalg import cholesky, eigh, solve_triangular

    knots = spline_knots(count, spacing)
    size = len(knots) - DEGREE - 1
    rows = BSpline.design_matrix(np.minimum(time, knots[-1]), knots, DEGREE)
    tied = np.eye(size)[:, : size - _TIED + 1]
    tied[size - _TIED :, -1] = 1.0
    centre = q.mean(axis=0)
    gram = tied.T @ (rows.T @ rows).toarray() @ tied
    penalty = tied.T @ _penalty(knots, size) @ tied
    # Constants cost nothing: rows decide them, wherever they are.
    ridge = _RIDGE * np.trace(gram) / np.trace(penalty)
    whole = gram + ridge * penalty
    lower = cholesky(whole, lower=True)
    inner = solve_triangular(lower, solve_triangular(lower, gram, lower=True).T, lower=True)
    shares, turn = eigh(0.5 * (inner + inner.T))
    shares = np.clip(shares, 0.0, 1.0)
    basis = solve_triangular(lower.T, turn, lower=False)  # diagonal in both: Demmler and Reinsch
    parts = basis.T @ (tied.T @ (rows.T @ (q - centre)))
    damping = 1.0 / (shares + (_WEIGHTS[:, None] + 1.0) * (1.0 - shares))
    best = _least_validation(parts, shares, damping, q - centre)
    coefficients = tied @ basis @ (damping[best].T * parts) + centre
    spline = BSpline(knots, coefficients, DEGREE)
    stops = spacing * np.arange(count)
    stops[-1] = knots[-1]
    residual = q - rows @ coefficients
    left = len(q) - (shares * damping[best]).sum(axis=1)
    validated = np.sqrt(len(q) * (residual**2).sum(axis=0)) / np.maximum(left, 1.0)
    return Smoothed(spline(stops), spacing, residual, validated)


def _penalty(knots: Array, size: int) -> Array:
    """Return the integrals of products of the basis' third derivatives. Shape (k, k)."""
    from scipy.interpolate import BSpline

    places, weights = np.polynomial.legendre.leggauss(DEGREE - 2)  # exact: their product is of 4
    edges = np.unique(knots)
    half = 0.5 * np.diff(edges)
    points = (0.5 * (edges[:-1] + edges[1:]))[:, None] + half[:, None] * places
    bends = BSpline(knots, np.eye(size), DEGREE).derivative(3)(points.ravel())
    return np.asarray(bends.T @ (bends * (half[:, None] * weights).ravel()[:, None]))


def _least_validation(parts: Array, shares: Array, damping: Array, signal: Array) -> Array:
    """Return which weight minimises GCV = n RSS / (n - trace)^2 of each joint. Shape (n,)."""
    count, square = len(signal), (signal**2).sum(axis=0)
    trace = (shares * damping).sum(axis=1)
    fitted = damping[:, :, None] * parts
    rest = square - 2.0 * (fitted * parts).sum(axis=1) + (shares[:, None] * fitted**2).sum(axis=1)
    rest = np.maximum(rest, _FLOOR * np.maximum(square, 1.0))
    return np.asarray(np.argmin(rest / np.maximum(count - trace, 1.0)[:, None] ** 2, axis=0))
