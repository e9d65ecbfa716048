"""The network lens of a law with a disturbance observer."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.lenses import look_through

LOST = [5.0, 4.0, 3.0, 1.0, 0.0, 0.5]


def seen(observer: str, **robot: Any) -> Any:
    lane = {"law": "computed_torque", "observer": observer, "observer_rate": 40.0}
    document = {
        "robot": {"armature": 0.3, **robot},
        "lanes": {"A": lane},
        "disturbance": {"constant": LOST},
        "simulation": {"horizon": 2.0, "initial_velocity": "desired"},
    }
    return look_through(Experiment.from_document(document), "A", ["network"])["network"]


def test_without_an_observer_there_is_nothing_to_see() -> None:
    assert seen("none") is None


@pytest.mark.parametrize("observer", ["momentum", "time_delay"])
def test_the_estimate_stands_beside_what_is_lost(observer: str) -> None:
    view = seen(observer)
    assert view["observer"] == observer
    assert len(view["joints"]) == JOINTS
    for joint, lost in zip(view["joints"], LOST, strict=True):
        np.testing.assert_allclose(joint["lost"], lost)
        assert joint["lost_rms"] == pytest.approx(lost)
        assert joint["missing_rms"] == pytest.approx(0.0, abs=1e-3)
        assert (joint["known"] is None) == (lost == 0.0)
        if lost:
            assert joint["known"] == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("observer", ["none", "momentum"])
def test_the_integral_of_super_twisting_stands_beside_what_is_lost(observer: str) -> None:
    lane = {"law": "super_twisting", "observer": observer}
    document = {
        "lanes": {"A": lane},
        "robot": {"armature": 0.3},
        "disturbance": {"constant": LOST},
        "simulation": {"horizon": 3.0, "initial_velocity": "desired"},
    }
    view = look_through(Experiment.from_document(document), "A", ["network"])["network"]
    assert view["observer"] == ("twisting" if observer == "none" else observer)
    assert view["adds"] is (observer != "none")
    for joint, lost in zip(view["joints"], LOST, strict=True):
        assert joint["missing_rms"] == pytest.approx(0.0, abs=0.02 * max(LOST))
        assert joint["lost_rms"] == pytest.approx(lost)


def test_friction_is_part_of_what_is_lost() -> None:
    view = seen("time_delay", viscous_friction=2.0)
    swing = np.ptp(view["joints"][0]["lost"])
    # 2 N m s/rad under a velocity of cos(t) up to 2 s.
    assert swing == pytest.approx(2.0 * (1.0 - np.cos(2.0)), rel=1e-3)
