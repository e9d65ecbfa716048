"""When a lane is said to have reached S = 0."""

from __future__ import annotations

from typing import Any

import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.laws.terms.switching import HELD
from slidetune.robot.loop.simulate import simulate

GENTLE = {"law": "nftsm", "inertia_shaped": True, "nu": 1, "c": 1, "mu": 0.1, "k1": 3, "k2": 0.5}
OFF_TARGET = {"horizon": 1.0, "initial_error": 0.1}
SAMPLED = {"mode": "sampled", "plant_substeps": 4}


def run_of(lane: dict[str, Any], **simulation: Any) -> Any:
    document = {
        "lanes": {"A": lane},
        "trajectory": {"kind": "hold"},
        "simulation": {**OFF_TARGET, **simulation},
    }
    return simulate(Experiment.from_document(document), estimate=False).lanes["A"]


@pytest.mark.parametrize("mode", [{}, SAMPLED])
def test_what_sign_reaches_does_not_depend_on_the_layer_that_it_ignores(
    mode: dict[str, Any],
) -> None:
    thin, wide = (
        run_of({**GENTLE, "switching": "sign", "epsilon": epsilon}, **mode).metrics.reaching_time
        for epsilon in (1e-3, 10.0)
    )
    assert thin == wide
    assert all(time is not None and 0.0 < time < 1.0 for time in thin)


@pytest.mark.parametrize("scheme", ["extrapolated", "plain"])
@pytest.mark.parametrize("step", [0.001, 0.005])
def test_sign_holds_what_it_has_reached_in_continuous_mode(scheme: str, step: float) -> None:
    lane = run_of({**GENTLE, "switching": "sign"}, scheme=scheme, step=step)
    for joint, reached in enumerate(lane.metrics.reaching_time):
        assert reached is not None
        assert (abs(lane.S[lane.time >= reached, joint]) <= HELD).all()


def test_a_wider_layer_is_reached_sooner() -> None:
    thin, wide = (
        run_of({**GENTLE, "epsilon": epsilon}).metrics.reaching_time for epsilon in (0.01, 0.05)
    )
    assert all(soon < late for soon, late in zip(wide, thin, strict=True))


def test_a_law_without_a_reaching_law_reaches_nothing() -> None:
    assert run_of({"law": "computed_torque"}).metrics.reaching_time == (None,) * JOINTS
    at_rest = run_of({"law": "computed_torque"}, initial_error=0.0)
    assert at_rest.metrics.reaching_time == (None,) * JOINTS
