"""A pose for an arm of any description to begin from."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

Array = np.ndarray

_POSES = 400
"""Poses that are compared (*ours*)."""
_WIDEST = 0.5 * np.pi
"""How far from the middle of its way a joint is tried, in [rad] or [m] (*ours*)."""
_SHARE = 0.5
"""Part of a joint's way, around its middle, from which poses are drawn (*ours*)."""
_LOADED = 0.6
"""Part of a joint's effort beyond which a pose is too heavy to hold (*ours*)."""


def home_pose(model: pin.Model, tip: str) -> tuple[float, ...]:
    r"""Return a pose within the limits, not singular, and light enough to be held.

    Of poses drawn from the middle half of each joint's way, the one with the greatest

    .. math:: \sigma_{min}(J) \, \lambda_{min}(N^{-1/2} M N^{-1/2}) \,
        \min(1, 0.6 / \max_j |G_j|/\tau_{max,j})^2, \qquad N = \operatorname{diag} M

    with the smallest singular value of the tip's Jacobian, whose lengths are in units of the arm's
    own, a measure of how well each joint can be moved alone, which is 1 where none moves another,
    and gravity's torque over the effort limit (ours).

    Args:
        model: a serial arm.
        tip: its flange.

    Returns:
        Angles in [rad] or displacements in [m], to two decimals where that fits the limits.
    """
    lower, upper = np.array(model.lowerPositionLimit), np.array(model.upperPositionLimit)
    free_below, free_above = ~np.isfinite(lower), ~np.isfinite(upper)
    lower = np.where(free_below, np.where(free_above, -np.pi, upper - 2.0 * np.pi), lower)
    upper = np.where(free_above, np.where(free_below, np.pi, lower + 2.0 * np.pi), upper)
    middle, half = 0.5 * (lower + upper), 0.5 * (upper - lower)
    reach = np.minimum(_SHARE * half, _WIDEST)
    draws = np.random.default_rng(0).uniform(-1.0, 1.0, (_POSES, model.nv))
    poses = _short(np.vstack([middle, middle + draws * reach]), lower, upper)
    data, frame = model.createData(), model.getFrameId(tip)
    scale = _size(model, frame)
    best = max(poses, key=lambda q: _merit(model, data, frame, q, scale))
    return tuple(best.tolist())


def _short(poses: Array, lower: Array, upper: Array) -> Array:
    """Return poses with two decimals; with more where joints move too little for that."""
    rounded = np.round(poses, 2)
    close = np.abs(rounded - poses) < 0.05 * (upper - lower)
    return np.where(close & (rounded > lower) & (rounded < upper), rounded, poses) + 0.0


def _size(model: pin.Model, frame: int) -> float:
    """Return the length of the chain in [m], 1 where it has none."""
    places = [model.jointPlacements[joint].translation for joint in range(2, model.njoints)]
    places.append(model.frames[frame].placement.translation)
    return sum(float(np.linalg.norm(place)) for place in places) or 1.0


def _merit(model: pin.Model, data: pin.Data, frame: int, q: Array, scale: float) -> float:
    found = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
    J = np.array(found).reshape(6, model.nv)  # of one joint it comes as a vector
    J[:3] /= scale
    singular = float(np.linalg.svd(J, compute_uv=False).min())
    upper = np.triu(np.reshape(pin.crba(model, data, q), (model.nv, model.nv)))
    root = 1.0 / np.sqrt(np.diagonal(upper))
    alone = float(np.linalg.eigvalsh((root[:, None] * upper * root).T).min())
    effort = np.where(model.effortLimit > 0.0, model.effortLimit, np.inf)
    load = float(np.max(np.abs(pin.computeGeneralizedGravity(model, data, q)) / effort))
    return singular * alone * min(1.0, _LOADED / max(load, 1e-12)) ** 2
