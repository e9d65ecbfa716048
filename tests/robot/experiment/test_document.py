"""The one document."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import MAX_LANES, Experiment
from slidetune.robot.experiment.simulation import MAX_STEPS, Simulation
from slidetune.robot.laws import LAWS

RICH: dict[str, Any] = {
    "title": "Everything",
    "description": "ν, σ and a second\nline",
    "robot": {
        "inertials": "datasheet",
        "armature": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
        "torque_limit": [150, 150, 150, 28, 28, 28],
        "payload": {"mass": 2, "center": [0, 0.01, 0.1], "known": True},
    },
    "lanes": {law: {"law": law} for law in list(LAWS)[-6:]},
    "trajectory": {"kind": "circle", "radius": 0.07, "plane": "xz"},
    "disturbance": {"constant": -3, "noise": {"amplitude": [1, 0, 0, 0, 0, 0]}, "seed": 9},
    "simulation": {"mode": "sampled", "control_rate": 500, "initial_error": 0.1},
}


def rich() -> Experiment:
    return Experiment.from_document(RICH)


def test_document_makes_the_same_experiment() -> None:
    copy = Experiment.from_document(json.loads(json.dumps(rich().document())))
    assert copy == rich()
    assert hash(copy) == hash(rich())
    assert copy.document() == rich().document()


def test_document_is_plain_json() -> None:
    text = json.dumps(rich().document(), allow_nan=False)
    assert json.loads(text) == rich().document()


def test_experiments_are_keys() -> None:
    runs = {rich(): 1, Experiment(): 2}
    assert runs[Experiment.from_document(RICH)] == 1
    assert rich().patched({"disturbance": {"seed": 10}}) not in runs


def test_equal_experiments_have_equal_hashes_whatever_the_lanes_order() -> None:
    turned = {**RICH, "lanes": dict(reversed(RICH["lanes"].items()))}
    other = Experiment.from_document(turned)
    assert other == rich()
    assert hash(other) == hash(rich())
    zero = rich().patched({"disturbance": {"constant": 0.0}})
    minus = rich().patched({"disturbance": {"constant": -0.0}})
    assert (zero == minus, hash(zero) == hash(minus)) == (True, True)


def test_an_experiment_can_not_be_changed() -> None:
    experiment = rich()
    with pytest.raises(ValidationError, match="frozen"):
        experiment.title = "other"  # type: ignore[misc]
    with pytest.raises(ValidationError, match="frozen"):
        experiment.simulation.horizon = 1.0  # type: ignore[misc]


def test_a_refused_patch_leaves_the_experiment() -> None:
    experiment = rich()
    with pytest.raises(InvalidExperimentError):
        experiment.patched({"simulation": {"horizon": 5, "control_rate": -1}})
    assert experiment == rich()


def test_default_is_the_proposal_of_the_paper() -> None:
    lanes = Experiment().lanes
    assert list(lanes) == ["RBFNN-NFTSM"]
    gains = lanes["RBFNN-NFTSM"].model_dump()
    published = {
        "nu": 0.3,
        "c": 10.0,
        "mu": 0.3,
        "p": 5.0,
        "k": 3.0,
        "k1": 150.0,
        "k2": 150.0,
        "width": 10.0,
        "learning_rate": 50.0,
        "epsilon": 1.0,
        "leakage": 0.0,
    }
    assert published.items() <= gains.items()


@pytest.mark.parametrize("name", ["A", "ν = 30", "a.b", "x" * 40, "日本", "it's 50 %"])
def test_lane_names_may_be_words(name: str) -> None:
    assert name in Experiment.from_document({"lanes": {name: {"law": "smc"}}}).lanes


@pytest.mark.parametrize("name", ["", " a", "a ", "a/b", "a\\b", "<b>", "a\nb", "\x00", "x" * 41])
def test_lane_names_that_would_break_a_path_or_a_page_are_refused(name: str) -> None:
    with pytest.raises(InvalidExperimentError, match="1 to 40 characters"):
        Experiment.from_document({"lanes": {name: {"law": "smc"}}})


def test_a_lane_is_not_named_like_what_no_object_of_a_browser_can_hold() -> None:
    with pytest.raises(InvalidExperimentError, match="__proto__ is not allowed"):
        Experiment.from_document({"lanes": {"__proto__": {"law": "smc"}}})


def test_number_of_lanes_is_bounded() -> None:
    lanes = {str(number): {"law": "smc"} for number in range(MAX_LANES)}
    assert len(Experiment.from_document({"lanes": lanes}).lanes) == MAX_LANES
    with pytest.raises(InvalidExperimentError, match="at most 6"):
        Experiment.from_document({"lanes": {**lanes, "more": {"law": "smc"}}})


def test_number_of_steps_is_bounded_by_what_counts_in_the_mode() -> None:
    for simulation in ({"step": 1e-4}, {"mode": "sampled", "control_rate": 10_000}):
        longest = {**simulation, "horizon": MAX_STEPS * 1e-4}
        Experiment.from_document({"simulation": longest})
        with pytest.raises(InvalidExperimentError, match="shorten it"):
            Experiment.from_document({"simulation": {**longest, "horizon": 20.01}})
    Experiment.from_document({"simulation": {"horizon": 120, "control_rate": 10_000}})


@pytest.mark.parametrize(
    ("delay", "rate", "substeps", "expected"),
    [
        (0.0, 1000.0, 10, (0, 0)),
        (0.001, 1000.0, 10, (1, 0)),
        (0.0025, 1000.0, 10, (2, 5)),
        (0.00004, 1000.0, 10, (0, 0.4)),
        (0.00996, 1000.0, 10, (9, 9.6)),
        (0.05, 10_000.0, 200, (500, 0)),
        (0.001, 250.0, 1, (0, 0.25)),
    ],
)
def test_delay_is_counted_in_periods_and_steps_of_the_arm(
    delay: float, rate: float, substeps: int, expected: tuple[int, float]
) -> None:
    simulation = Simulation(input_delay=delay, control_rate=rate, plant_substeps=substeps)
    assert simulation.delay == pytest.approx(expected, abs=1e-9)


def experiment_or_refusal(document: Any) -> Experiment | InvalidExperimentError:
    try:
        return Experiment.from_document(document)
    except InvalidExperimentError as error:
        return error


@settings(max_examples=60, deadline=None)
@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
        lambda inner: (
            st.lists(inner, max_size=3)
            | st.dictionaries(
                st.sampled_from([*Experiment.model_fields, "law", "kind", "k1", "A", "payload"]),
                inner,
                max_size=3,
            )
        ),
        max_leaves=8,
    )
)
def test_any_json_makes_an_experiment_or_a_refusal(document: Any) -> None:
    made = experiment_or_refusal(document)
    if isinstance(made, Experiment):
        assert Experiment.from_document(made.document()) == made
    else:
        assert made.fields
        assert all(field.message for field in made.fields)
