"""What harmonic balance puts in the place of a law is that law, where it says so."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.kernels.workspace import TAU
from slidetune.robot.margins.margin import evaluate
from slidetune.robot.margins.plain_lane import as_plain, switches

SHAPED: list[dict[str, Any]] = [
    {"law": "nftsm", "inertia_shaped": True, "nu": 10.0, "c": 1.5, "mu": 0.1},
    {"law": "integral_smc"},
    {"law": "adaptive_smc", "k2_min": [20.0, 30.0, 15.0, 10.0, 5.0, 40.0]},
]


def one_lane(lane: dict[str, Any], **simulation: Any) -> Experiment:
    others = dict.fromkeys(load_preset("drive-lag").lanes)
    patch = {"lanes": {**others, "A": lane}, "simulation": simulation}
    return load_preset("drive-lag").patched(patch)


@pytest.mark.parametrize("reaching", ["exponential", "constant"])
@pytest.mark.parametrize("lane", SHAPED)
def test_a_shaped_implicit_sign_is_the_saturation_in_its_place(
    lane: dict[str, Any], reaching: str
) -> None:
    gains = {"k1": 30.0, "k2": [20.0, 30.0, 15.0, 10.0, 5.0, 40.0], "reaching": reaching}
    packed = pack(one_lane({**lane, **gains, "switching": "implicit"}))
    plain, term = as_plain(packed, "A", 0.7)
    assert term.switching == "saturation"
    random = np.random.default_rng(1)
    for _ in range(20):
        q, v = random.uniform(-0.1, 0.1, 6), 1.0 + random.uniform(-0.1, 0.1, 6)
        ours, theirs = (
            evaluate(one, "A", q, v, packed.trajectory)[TAU].copy() for one in (packed, plain)
        )
        np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-9)


def test_continuous_mode_knows_no_layer_of_the_implicit_sign() -> None:
    lane = {"law": "smc", "switching": "implicit"}
    plain, term = as_plain(pack(one_lane(lane, mode="continuous")), "A", 0.0)
    assert term.switching == "sign"
    assert plain.experiment.lanes["A"].switching == "sign"


@pytest.mark.parametrize(
    ("lane", "expected"),
    [
        ({"law": "super_twisting"}, True),
        ({"law": "super_twisting", "k1": 0.0, "k2": 0.0}, False),
        ({"law": "smc", "k2": 0.0}, False),
        ({"law": "smc", "switching": "implicit"}, True),
        ({"law": "smc", "reaching": "power"}, False),
        ({"law": "computed_torque"}, False),
    ],
)
def test_which_lanes_have_something_to_balance(lane: dict[str, Any], expected: bool) -> None:
    assert switches(pack(one_lane(lane)), "A") is expected
