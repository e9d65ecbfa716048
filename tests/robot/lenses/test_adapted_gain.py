"""The gain of an adaptive law, from its record, against the law's own."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.lenses.adapted_gain import adapted_gain
from slidetune.robot.loop.simulate import simulate


@pytest.mark.parametrize(("mode", "within"), [("sampled", 1e-8), ("continuous", 2.0)])
def test_it_is_the_gain_that_the_law_had(mode: str, within: float) -> None:
    lane = {"law": "adaptive_smc", "k2": 40.0, "k2_min": 0.5, "adaptation_rate": 300.0}
    experiment = Experiment.from_document(
        {
            "lanes": {"A": lane},
            "disturbance": {"constant": [8.0, 8.0, 6.0, 1.0, 1.0, 0.5]},
            "simulation": {"mode": mode, "horizon": 2.0, "initial_error": 0.05},
        }
    )
    run = simulate(experiment, estimate=False).lanes["A"]
    found = adapted_gain(pack(experiment), "A", run)
    assert found is not None
    assert found.max() > 1.0
    # The law records what the gain could give at a joint alone.
    model = pack(experiment).model
    data = model.createData()
    inertia = np.array([np.diag(pin.crba(model, data, q)) for q in run.q])
    np.testing.assert_allclose(found, run.f / inertia, rtol=1e-9, atol=within)


def test_a_law_that_keeps_its_gain_has_none() -> None:
    experiment = Experiment.from_document(
        {"lanes": {"A": {"law": "smc"}}, "simulation": {"horizon": 0.1}}
    )
    run = simulate(experiment, estimate=False).lanes["A"]
    assert adapted_gain(pack(experiment), "A", run) is None
