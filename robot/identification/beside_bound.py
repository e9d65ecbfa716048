"""Numbers beside one that a bound holds: what it may not be, others make up for."""

from __future__ import annotations

import numpy as np

from slidetune.robot.identification.numbers import titles_of
from slidetune.robot.identification.solving import Solution

Array = np.ndarray

_CERTAIN = 2.0
"""Half intervals beyond a bound from which on it is no chance (*ours*): of the
twenty numbers or so of a fit one is beyond its interval anyway."""
_BIASED = 0.1
"""Half intervals by which a number is moved that is worth a word (*ours*)."""
_MOVED, _MOVED_TO_END = 1.0, 0.5
"""Half intervals by which a bound of another number may move one before it tells nothing, and where
it moves it to an end of its own (*ours*)."""
_OF_MUCH, _OF_ITSELF = 0.001, 0.01
"""Shares of what is much of a number, and of itself, below which a distance makes no difference
(*ours*): without noise intervals are narrower than what a filter leaves."""


def beside_bounds(
    solution: Solution,
    names: list[str],
    fitted: Array,
    ends: tuple[Array, Array],
    much: Array,
    reasons: dict[int, str],
) -> Solution:
    """Say what the bounds of some numbers do to others; those that they move tell nothing.

    None is fixed for a fit anew: the others, which lie where they do without bounds as well, would
    then make up for its present value instead.

    Args:
        solution: of the fit.
        names: fields of the numbers.
        fitted: which numbers were fitted. Shape (p,).
        ends: least and greatest values. Shapes (p,).
        much: what is much of each number. Shape (p,).
        reasons: takes the words of each.

    Returns:
        The solution; where a number tells nothing its deviation is 0.
    """
    worth = np.maximum(_OF_MUCH * much, _OF_ITSELF * np.abs(solution.free))
    held = _held(solution, fitted & (_distance(solution) > worth), ends)
    if not held:
        return solution
    bound = f"the bound of {titles_of(names, held)}"
    moved = _moved(solution, fitted & (_distance(solution) > worth), ends)
    biased = _distance(solution) > np.maximum(_BIASED * solution.deviation, worth)
    for member in np.flatnonzero(fitted).tolist():
        if member in moved:
            reasons[member] = (
                f"{bound} moves it from {asked(solution, member)} to "
                f"{solution.values[member]:.3g}: its present value is kept"
            )
        elif member not in held and biased[member]:
            said = f"beside {bound} it is biased, by about {_distance(solution)[member]:.2g}"
            reasons[member] = "; ".join(part for part in (reasons.get(member, ""), said) if part)
    deviation = solution.deviation.copy()
    deviation[moved] = 0.0
    return solution._replace(deviation=deviation)


def asked(solution: Solution, number: int) -> str:
    """Return what the log asks for without bounds, in words."""
    return f"{solution.free[number]:.3g} ± {solution.deviation[number]:.2g}"


def _held(solution: Solution, fitted: Array, ends: tuple[Array, Array]) -> list[int]:
    """Return the numbers that the log wants beyond their bounds for certain.

    Args:
        solution: of the fit.
        fitted: which numbers were fitted and are far from where they would be. Shape (p,).
        ends: least and greatest values. Shapes (p,).
    """
    certain = _outside(solution, ends) & (_distance(solution) > _CERTAIN * solution.deviation)
    return [int(at) for at in np.flatnonzero(fitted & _at_end(solution, ends) & certain)]


def _moved(solution: Solution, fitted: Array, ends: tuple[Array, Array]) -> list[int]:
    """Return the numbers that bounds of others have moved by more than their interval allows.

    Without those bounds they lie within their own: they are where they are because of others.
    Where a number is moved to an end of its own half of that is enough.

    Args:
        solution: of the fit, in which some number is held by its bounds.
        fitted: which numbers were fitted and are far from where they would be. Shape (p,).
        ends: least and greatest values. Shapes (p,).
    """
    allowed = np.where(_at_end(solution, ends), _MOVED_TO_END, _MOVED) * solution.deviation
    moved = ~_outside(solution, ends) & (_distance(solution) > allowed)
    return [int(at) for at in np.flatnonzero(fitted & moved)]


def _distance(solution: Solution) -> Array:
    return np.asarray(np.abs(solution.values - solution.free))


def _at_end(solution: Solution, ends: tuple[Array, Array]) -> Array:
    return np.asarray((solution.values == ends[0]) | (solution.values == ends[1]))


def _outside(solution: Solution, ends: tuple[Array, Array]) -> Array:
    return np.asarray((solution.free < ends[0]) | (solution.free > ends[1]))
