"""Tries a written law on what the controller of the run saw, before it is handed over."""

from __future__ import annotations

from dataclasses import fields, replace
from types import ModuleType

import numpy as np

from slidetune.robot.errors import SlidetuneError
from slidetune.robot.handover.sampled_run import Vectors

Array = np.ndarray

TOLERANCE = 1e-12
"""By what share of the largest torque law.c and law.py may differ from the run (*ours*)."""
_SHARE = 0.25
"""Share of that which is ours: other compilers round in another way (*ours*)."""
_DISTURBED = 1e-15
"""By what share inputs are changed to see what rounding does (*ours*): some last digits."""
_LIKE_ROUNDING = 10.0
"""By how much a difference may be above what such a change makes (*ours*)."""


class HandOverError(SlidetuneError, RuntimeError):
    """A package that could not be made."""


def loaded(text: str) -> ModuleType:
    """Return a written law as a module, which nobody else can import.

    Args:
        text: what ``law_texts`` wrote as law.py.
    """
    law = ModuleType("law")
    exec(compile(text, "law.py", "exec", dont_inherit=True), law.__dict__)
    return law


def torques_of(law: ModuleType, vectors: Vectors, growth: float = 0.0) -> Array:
    """Return a law's torques in [N m] for inputs one after the other. Shape (m, n).

    Args:
        law: the written law.
        vectors: what its controller sees.
        growth: by what share its memory is made larger after each period.
    """
    state, torques = law.State(), np.empty_like(vectors.tau)
    seen = [vectors.q, vectors.v, vectors.q_d, vectors.v_d]
    if vectors.model_based:
        seen += [vectors.a_d, vectors.M, vectors.h]
    for number in range(len(torques)):
        torques[number] = law.step(state, law.Inputs(*(column[number] for column in seen)))
        if growth:
            for name, value in vars(state).items():
                setattr(state, name, value * (1.0 + growth))
    return torques


def checked_vectors(law: ModuleType, vectors: Vectors) -> Vectors:
    """Return the vectors on which a written law does as the run did.

    All of them, unless the law makes so much of rounding that its torques come apart: then those
    before. A power reaching law, which is endlessly steep at S = 0, does that, and so does
    time-delay estimation, which adds up what each period was off by.

    Args:
        law: the written law.
        vectors: what the controller of the run saw and asked for.

    Raises:
        HandOverError: if there is no vector, or a torque differs by more than rounding makes.
    """
    if not len(vectors.time):
        raise HandOverError(
            "the sampled loop leaves its bounds within its first control period, so that there is "
            "nothing to compare the law with: choose other gains or a higher control rate"
        )
    made = torques_of(law, vectors)
    difference = np.maximum.accumulate(np.abs(made - vectors.tau).max(axis=1))
    largest = np.maximum.accumulate(np.abs(vectors.tau).max(axis=1))
    agreeing = np.flatnonzero(difference <= _SHARE * TOLERANCE * largest)
    count = int(agreeing[-1]) + 1 if agreeing.size else 0
    if count == len(vectors.time):
        return vectors
    other = torques_of(law, _disturbed(vectors), float(np.finfo(float).eps))
    rounded = np.abs(other - made).max(axis=1)[: count + 1]
    if count == 0 or difference[count] > _LIKE_ROUNDING * rounded.max():
        raise HandOverError(
            f"the written law differs from the run at {vectors.time[count]:g} s by "
            f"{difference[count]:.3g} of a torque of {largest[count]:.3g} N·m: this is a mistake "
            "of the program; please report it with the experiment"
        )
    return first_periods(vectors, count)


def first_periods(vectors: Vectors, count: int) -> Vectors:
    """Return the first ``count`` control periods of vectors."""
    columns = {one.name: getattr(vectors, one.name) for one in fields(vectors)}
    arrays = {name: value[:count] for name, value in columns.items() if name != "model_based"}
    return replace(vectors, **arrays)


def _disturbed(vectors: Vectors) -> Vectors:
    """Return vectors whose measurements differ in their last digits."""
    random = np.random.default_rng(0)
    signs = random.choice([-_DISTURBED, _DISTURBED], size=(2, *vectors.q.shape))
    return replace(vectors, q=vectors.q * (1.0 + signs[0]), v=vectors.v * (1.0 + signs[1]))
