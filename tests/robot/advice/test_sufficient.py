"""Layers that the advice proposes: wide enough, and hardly wider."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.packed import pack
from slidetune.robot.margins.margin import is_stable
from tests.robot.advice.test_advice import CHATTERING, DATASHEET, SAMPLED, advice_by_path, packed_of


@pytest.mark.parametrize("epsilon", [3.0, [3.0, 3.0, 3.0, 2.0, 2.0, 2.0]])
def test_in_place_of_sign_no_layer_is_proposed_that_is_far_too_wide(epsilon: Any) -> None:
    document = {**SAMPLED, "robot": DATASHEET}
    lane = {**CHATTERING, "switching": "sign", "epsilon": epsilon}
    note = advice_by_path(document, lane)["lanes.A.switching"]
    assert note.patch is not None
    better = packed_of(document, lane).experiment.patched(note.patch)
    assert is_stable(pack(better), "A")
    layer = better.lanes["A"].epsilon
    assert isinstance(layer, tuple) == isinstance(epsilon, list)
    assert np.all(np.asarray(layer) < np.asarray(epsilon))
    thinner = {"lanes": {"A": {"epsilon": (0.45 * np.asarray(layer)).tolist()}}}
    assert not is_stable(pack(better.patched(thinner)), "A")
