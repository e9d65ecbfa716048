"""Merge patches: made after the schema, wrong ones, and damaged ones, through ``patched``."""

from __future__ import annotations

import json
from functools import lru_cache
from random import Random
from typing import Any

from slidetune.robot.advice.advice import advice_on
from slidetune.robot.errors import SlidetuneError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.merge_patch import difference
from slidetune.robot.experiment.packed import pack
from slidetune.robot.laws import LAWS
from slidetune.robot.margins.margin import worst_margin
from tests.trust.fuzz.values import TEXTS, wrong
from tests.trust.fuzz.verdict import crash, unclear, words
from tests.trust.fuzz.yaml import instances, unequal

_LANES = {
    "NFTSM": {"law": "nftsm", "k1": [1, 2, 3, 4, 5, 6]},
    "A": {"law": "rbfnn_nftsm"},
    "a.b": {"law": "computed_torque"},
    "twisting": {"law": "super_twisting"},
    "integral": {"law": "integral_smc"},
    "adaptive": {"law": "adaptive_smc"},
}


@lru_cache(maxsize=1)
def base() -> Experiment:
    """Return what is patched."""
    return Experiment.from_document({"title": "base", "lanes": _LANES, "disturbance": {"seed": 3}})


def _leaves(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    if not isinstance(value, dict):
        return [path]
    return [leaf for key, item in value.items() for leaf in _leaves(item, (*path, key))]


def _at(path: tuple[Any, ...], value: Any) -> Any:
    for key in reversed(path):
        value = {key: value}
    return value


def _one_value(random: Random) -> Any:
    """Return a patch of one place: a leaf of the document, or a part of the way to it."""
    path = random.choice(_leaves(base().document()))
    path = path[: random.randint(1, len(path))]
    if random.random() < 0.1:
        path = (*path, random.choice(TEXTS))
    return _at(path, wrong(random))


def _with_nulls(value: Any, random: Random) -> Any:
    if not isinstance(value, dict):
        return None if random.random() < 0.03 else value
    return {key: _with_nulls(item, random) for key, item in value.items()}


def _made(random: Random) -> Any:
    wildness = random.choice((0.0, 0.02, 0.1, 0.4))
    try:
        return _with_nulls(instances().make(random, wildness), random)
    except RecursionError:
        return {"robot": wrong(random)}


def _lanes(random: Random) -> Any:
    """Return a patch that adds, renames, removes lanes or changes their law."""
    laws = (*LAWS, "sliding")
    names = (*_LANES, *TEXTS)
    changes: tuple[Any, ...] = (None, {}, {"law": random.choice(laws)}, {"nu": 2}, wrong(random))
    count = random.choice((1, 2, 3, 7))
    return {"lanes": {random.choice(names): random.choice(changes) for _ in range(count)}}


def patch_input(random: Random) -> Any:
    """Return one patch, of values that Python holds."""
    kinds = (_one_value, _made, _lanes, wrong)
    return random.choices(kinds, (35, 40, 20, 5))[0](random)


def judge_patch(patch: Any, thorough: bool) -> tuple[bool, tuple[str, str] | None]:
    """Apply a patch; return whether it was taken, and the cause and detail of a fault.

    Args:
        patch: what to apply.
        thorough: whether to read it back from YAML, too, and to make it ready to run.
    """
    before = base().document()
    try:
        after = base().patched(patch)
    except SlidetuneError as error:
        fields = [vars(one) for one in getattr(error, "fields", ())]
        cause = unclear(str(error), fields, words(patch))
        return False, None if cause is None else (cause, str(error)[:300])
    except Exception as error:
        return False, crash(error)
    if base().document() != before:
        return True, ("changes what it is applied to", "")
    return True, _complaint(after, thorough)


def _complaint(after: Experiment, thorough: bool) -> tuple[str, str] | None:
    try:
        json.dumps(after.document(), allow_nan=False).encode()
        if base().patched(difference(base().document(), after.document())) != after:
            return "the way from one experiment to another leads elsewhere", ""
        if not thorough:
            return None
        return unequal(after) or _unready(after)
    except Exception as error:
        return crash(error)


def _unready(experiment: Experiment) -> tuple[str, str] | None:
    """Make an experiment ready to run and judge it; a path out of reach may be refused."""
    try:
        packed = pack(experiment)
    except SlidetuneError as error:
        fields = [vars(one) for one in getattr(error, "fields", ())]
        cause = unclear(str(error), fields, "")
        return None if cause is None else (cause, str(error)[:300])
    for name in packed.gains:
        found = [vars(note) for note in advice_on(packed, name)]
        json.dumps([found, worst_margin(packed, name)], allow_nan=False)
    return None
