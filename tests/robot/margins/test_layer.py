"""The boundary layer that a lane has in its loop."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.laws.terms.switching import HELD
from slidetune.robot.margins.layer import layer_of

K2 = [10.0, 20.0, 0.0, 4.0, 1.0, 2.0]


def packed_of(lane: dict[str, Any], mode: str = "sampled") -> Packed:
    document = {
        "robot": {"armature": 0.3},
        "lanes": {"A": {"law": "nftsm", "c": 2.0, "mu": 0.7, "k2": K2, **lane}},
        "simulation": {"mode": mode, "control_rate": 500.0},
    }
    return pack(Experiment.from_document(document))


@pytest.mark.parametrize("switching", ["tanh", "saturation"])
def test_a_smooth_switching_function_has_its_own(switching: str) -> None:
    assert (layer_of(packed_of({"switching": switching, "epsilon": 0.3}), "A") == 0.3).all()


def test_sign_counts_as_held_and_a_law_that_does_not_switch_has_none() -> None:
    assert (layer_of(packed_of({"switching": "sign"}), "A") == HELD).all()
    assert (layer_of(packed_of({"switching": "implicit"}, "continuous"), "A") == HELD).all()
    document = {"lanes": {"A": {"law": "computed_torque"}}}
    assert not layer_of(pack(Experiment.from_document(document)), "A").any()


def test_the_implicit_sign_has_the_period_times_k2() -> None:
    packed = packed_of({"switching": "implicit", "inertia_shaped": True})
    expected = 0.002 * np.array(K2)
    np.testing.assert_allclose(layer_of(packed, "A"), np.where(expected > 0.0, expected, HELD))


def test_the_unshaped_implicit_sign_has_each_joint_s_own_at_the_start() -> None:
    packed = packed_of({"switching": "implicit"})
    model = packed.model
    # The published motion starts with q = 0 and without error, where the slope of S is c.
    M = pin.crba(model, model.createData(), np.zeros(JOINTS))
    M = np.triu(M) + np.triu(M, 1).T
    expected = 0.002 * 2.0 * np.diag(np.linalg.inv(M)) * np.array(K2)
    np.testing.assert_allclose(
        layer_of(packed, "A"), np.where(expected > 0.0, expected, HELD), rtol=1e-9
    )
