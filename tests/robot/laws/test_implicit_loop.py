"""What the implicit sign promises of a sampled loop, and what a delay takes from it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.advice.advice import advice_on
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.loop.simulate import LaneRun, simulate

UNSHAPED = {"k1": [80, 80, 40, 8, 8, 8], "k2": [40, 40, 25, 5, 5, 5]}
LANES: dict[str, dict[str, Any]] = {
    "smc": {"law": "smc", "lambda_": 10, **UNSHAPED},
    "nftsm": {"law": "nftsm", "nu": 10, "c": 1, "mu": 0.1, **UNSHAPED},
    "shaped": {
        "law": "nftsm",
        "nu": 10,
        "c": 1,
        "mu": 0.1,
        "inertia_shaped": True,
        "k1": 20,
        "k2": 20,
    },
}
SWUNG = {"sine": {"amplitude": [8, 8, 6, 1, 1, 1], "frequency": 1}}


def experiment(lane: str, switching: str, **simulation: Any) -> Experiment:
    """The arm as built, on the published motion, every joint disturbed by a slow sine."""
    return Experiment.from_document(
        {
            "robot": {"inertials": "datasheet", "armature": [0.6, 0.6, 0.6, 0.15, 0.15, 0.15]},
            "lanes": {"A": {**LANES[lane], "switching": switching, "epsilon": 0.2}},
            "disturbance": SWUNG,
            "simulation": {
                "mode": "sampled",
                "horizon": 2.0,
                "initial_velocity": "desired",
                **simulation,
            },
        }
    )


def run(lane: str, switching: str, **simulation: Any) -> LaneRun:
    return simulate(experiment(lane, switching, **simulation), estimate=False).lanes["A"]


@pytest.mark.parametrize("lane", LANES)
def test_it_moves_the_torque_as_little_as_a_smooth_law(lane: str) -> None:
    smooth, implicit, sign = (
        run(lane, switching).metrics_since(0.2).chattering
        for switching in ("tanh", "implicit", "sign")
    )
    assert implicit < 1.05 * smooth
    assert sign > 500.0 * implicit


@pytest.mark.parametrize("lane", LANES)
def test_what_a_disturbance_leaves_halves_with_the_period(lane: str) -> None:
    left = [
        np.abs(run(lane, "implicit", control_rate=rate).S[int(0.2 * rate) :]).max()
        for rate in (500.0, 1000.0, 2000.0)
    ]
    assert left[1] / left[0] == pytest.approx(0.5, rel=0.02)
    assert left[2] / left[1] == pytest.approx(0.5, rel=0.02)
    # A tanh whose layer stays as it is gains nothing.
    smooth = [
        np.abs(run(lane, "tanh", control_rate=rate).S[int(0.2 * rate) :]).max()
        for rate in (1000.0, 2000.0)
    ]
    assert smooth[1] / smooth[0] == pytest.approx(1.0, rel=0.02)


@pytest.mark.parametrize("lane", LANES)
def test_a_period_of_delay_brings_the_chattering_back(lane: str) -> None:
    prompt = run(lane, "implicit").metrics_since(0.2).chattering
    late = run(lane, "implicit", input_delay=1e-3).metrics_since(0.2).chattering
    assert late > 100.0 * prompt


@pytest.mark.parametrize("lane", LANES)
def test_in_continuous_mode_it_is_sign_to_the_last_bit(lane: str) -> None:
    one, other = (run(lane, kind, mode="continuous", step=0.002) for kind in ("sign", "implicit"))
    for name in ("q", "v", "tau", "S"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


@pytest.mark.parametrize("lane", LANES)
def test_it_is_offered_where_sign_chatters_and_taking_the_offer_ends_that(lane: str) -> None:
    chattering = experiment(lane, "sign")
    notes = advice_on(pack(chattering), "A")
    (offer,) = (note for note in notes if note.title.endswith("(implicit)"))
    assert offer.path == "lanes.A.switching"
    assert offer.patch is not None
    assert ("T·k₂" in offer.title) == (lane == "shaped")
    calm = simulate(chattering.patched(offer.patch), estimate=False).lanes["A"]
    assert calm.metrics.chattering < 300.0
    assert not [note for note in advice_on(pack(chattering.patched(offer.patch)), "A")]


def test_within_the_layer_that_the_offer_names_s_is_gone_after_one_period() -> None:
    one = experiment("shaped", "sign")
    (offer,) = (note for note in advice_on(pack(one), "A") if note.title.endswith("(implicit)"))
    assert offer.message.endswith("within which S is gone after one period.")
    taken = one.patched(offer.patch)
    on, off = (
        simulate(taken.patched({"simulation": {"initial_error": error}}), estimate=False)
        for error in (0.0, 1e-5)
    )
    apart = np.abs(off.lanes["A"].S - on.lanes["A"].S)
    assert np.all(np.abs(off.lanes["A"].S[0]) < off.lanes["A"].layer)
    assert np.all(apart[1] < 0.1 * apart[0])


@pytest.mark.parametrize("lane", LANES)
def test_under_a_delay_it_is_not_offered_and_the_lane_that_has_it_is_offered_tanh(
    lane: str,
) -> None:
    late = experiment(lane, "sign", input_delay=1e-3)
    assert not [note for note in advice_on(pack(late), "A") if "implicit" in note.title]
    unstable = experiment(lane, "implicit", input_delay=1e-3)
    (warning,) = (note for note in advice_on(pack(unstable), "A") if note.level == "warning")
    assert warning.path == "lanes.A.switching"
    assert warning.patch is not None
    calm = simulate(unstable.patched(warning.patch), estimate=False).lanes["A"]
    assert calm.metrics.chattering < 500.0


def test_the_published_gains_hold_a_sampled_arm_of_bare_links_only_with_it() -> None:
    def paper(switching: str) -> LaneRun:
        lane = {"law": "nftsm", "switching": switching}
        simulation = {"mode": "sampled", "horizon": 1.0}
        return simulate(
            Experiment.from_document({"lanes": {"A": lane}, "simulation": simulation}),
            estimate=False,
        ).lanes["A"]

    assert paper("tanh").freeze is not None
    held = paper("implicit")
    assert held.freeze is None
    assert held.metrics.chattering < 1000.0
