"""Looking back, and branching off."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.kernels.workspace import PUSH, R_QD, TAU
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.server.live.recorder import INTERVAL, LENGTH, Recorder

LANES = {"A": {"law": "rbfnn_nftsm"}, "B": {"law": "nftsm"}}
EXPERIMENT = Experiment.from_document({"lanes": LANES, "simulation": {"step": 0.005}})
FALLING = Experiment.from_document(
    {
        "lanes": {"A": {"law": "rbfnn_smc", "k1": 0, "k2": 0, "learning_rate": 0}},
        "disturbance": {"constant": [0, 0, 0, 0, 0, -2]},
    }
)


def recorded(seconds: float) -> tuple[ClosedLoop, Recorder]:
    loop, recorder = ClosedLoop(pack(EXPERIMENT), 64), Recorder()
    while loop.time < seconds:
        recorder.look(loop)
        loop.step()
    return loop, recorder


def test_moments_lie_a_tenth_of_a_second_apart() -> None:
    _, recorder = recorded(2.0)
    assert recorder.span() == pytest.approx((0.0, 2.0 - INTERVAL), abs=0.006)
    moment = recorder.at(1.23)
    assert moment is not None
    assert moment.time == pytest.approx(1.2, abs=0.006)


def test_nothing_recorded_is_said_so() -> None:
    recorder = Recorder()
    assert recorder.span() is None
    assert recorder.at(1.0) is None


def test_a_minute_is_kept_and_no_more() -> None:
    _, recorder = recorded(LENGTH + 3.0)
    span = recorder.span()
    assert span is not None
    assert span[1] - span[0] == pytest.approx(LENGTH - INTERVAL, abs=0.1)


@st.composite
def any_settings(draw: st.DrawFn) -> dict[str, Any]:
    """Draw what makes the next steps depend on more than angles, velocities and weights."""
    laws = [
        {"law": "rbfnn_nftsm", "nu": 10, "c": 1, "k1": 8, "k2": 5, "epsilon": 0.1},
        {"law": "rbfnn_nftsm", "k1": 400.0, "epsilon": 0.01},
        {"law": "nftsm", "nu": 10, "c": 1, "k1": 8, "k2": 5, "switching": "sign"},
        {"law": "smc", "switching": "saturation", "epsilon": 0.01},
        {"law": "rbfnn_smc"},
        {"law": "computed_torque", "kp": 9000.0, "kd": 0.2},
    ]
    return {
        "robot": {
            "armature": draw(st.sampled_from([0.0, 0.3])),
            "coulomb_friction": draw(st.sampled_from([0.0, 1.0])),
            "torque_limit": draw(st.sampled_from([None, 60.0])),
        },
        "lanes": {name: draw(st.sampled_from(laws)) for name in "AB"},
        "disturbance": {
            "noise": {"amplitude": draw(st.sampled_from([0.0, 5.0]))},
            "pulse": {"amplitude": 20.0, "start": 0.15, "duration": 0.003, "period": 0.05},
            "nominal_mismatch": draw(st.sampled_from([1.0, 0.8])),
            "sensor_noise": {
                "position": draw(st.sampled_from([0.0, 1e-5])),
                "velocity": draw(st.sampled_from([0.0, 1e-3])),
            },
        },
        "simulation": {
            "mode": draw(st.sampled_from(["continuous", "sampled"])),
            "step": draw(st.sampled_from([0.001, 0.003])),
            "scheme": draw(st.sampled_from(["extrapolated", "plain"])),
            "control_rate": draw(st.sampled_from([330.0, 1000.0])),
            "input_delay": draw(st.sampled_from([0.0, 0.002, 0.0074, 0.05])),
            "initial_error": draw(st.sampled_from([0.0, 0.05])),
        },
    }


DETOURS: list[dict[str, Any]] = [
    {},
    {"lanes": {"A": {"law": "smc"}}},
    {"robot": {"torque_limit": 20.0}},
    {"simulation": {"input_delay": 0.011}},
    {"simulation": {"mode": "sampled", "control_rate": 500.0}},
    {"simulation": {"mode": "continuous", "step": 0.002}},
]
"""Edits that are taken back before anybody goes back in time."""


def advance(loop: ClosedLoop, recorder: Recorder, steps: int) -> dict[str, np.ndarray]:
    """Make steps as the session does; return each lane's rows."""
    first = loop.number
    for _ in range(steps):
        recorder.look(loop)
        loop.step()
    rows = np.arange(first, loop.number) % loop.rows
    return {name: lane.record[rows] for name, lane in loop.lanes.items()}


CONTINUOUS_MEANWHILE: dict[str, Any] = {
    "robot": {"armature": 0.3, "coulomb_friction": 1.0, "torque_limit": 60.0},
    "lanes": {
        "A": {"law": "rbfnn_nftsm", "k1": 400.0, "epsilon": 0.01},
        "B": {"law": "rbfnn_nftsm", "nu": 10, "c": 1, "k1": 8, "k2": 5, "epsilon": 0.1},
    },
    "disturbance": {
        "pulse": {"amplitude": 20.0, "start": 0.15, "duration": 0.003, "period": 0.05},
        "sensor_noise": {"position": 1e-05},
    },
    "simulation": {"mode": "sampled", "control_rate": 330.0, "input_delay": 0.05},
}
"""A sampled loop whose last bits told that it had been continuous meanwhile."""


@example(CONTINUOUS_MEANWHILE, DETOURS[-1], 0.0, 67)
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(any_settings(), st.sampled_from(DETOURS), st.floats(0.0, 0.35), st.integers(0, 150))
def test_whatever_came_after_it_a_restored_moment_repeats_its_future_to_the_last_bit(
    document: dict[str, Any], detour: dict[str, Any], wanted: float, more: int
) -> None:
    experiment = Experiment.from_document(document)
    loop, recorder = ClosedLoop(pack(experiment), 512), Recorder()
    ahead = ClosedLoop(pack(experiment), 512)
    advance(loop, recorder, round(0.35 / loop.period))
    # What a discarded future may leave behind.
    loop.adopt(pack(experiment.patched(detour)))
    loop.lanes["B"].work[PUSH] = 5.0
    advance(loop, recorder, more)
    loop.lanes["B"].work[PUSH] = 0.0
    loop.adopt(pack(experiment))
    advance(loop, recorder, 7)

    moment = recorder.at(wanted)
    assert moment is not None
    recorder.restore(loop, wanted)
    assert loop.time == moment.time
    copied = experiment.patched({"lanes": {"Copy": document["lanes"]["A"]}})
    loop.adopt(pack(copied), {"Copy": "A"})
    found = advance(loop, recorder, 200)

    advance(ahead, Recorder(), round(moment.time / ahead.period))
    expected = advance(ahead, Recorder(), 200)
    for name, origin in (("A", "A"), ("B", "B"), ("Copy", "A")):
        np.testing.assert_array_equal(found[name], expected[origin], err_msg=name)
        assert loop.lanes[name].freeze == ahead.lanes[origin].freeze


def test_a_lane_that_stood_still_stands_there_again() -> None:
    loop, recorder = ClosedLoop(pack(FALLING), 64), Recorder()
    advance(loop, recorder, 300)
    freeze, row = loop.lanes["A"].freeze, loop.lanes["A"].record[299 % 64, :R_QD].copy()
    assert freeze is not None
    loop.restart_lane("A")
    # Until nothing is left of those rows.
    advance(loop, recorder, 150)
    recorder.restore(loop, freeze.time + 0.1)
    assert loop.lanes["A"].freeze == freeze
    again = advance(loop, recorder, 10)["A"][:, :R_QD]
    np.testing.assert_array_equal(again, np.tile(row, (10, 1, 1)))


def test_under_another_delay_the_torque_of_the_moment_is_on_its_way() -> None:
    simulation = {"mode": "sampled", "input_delay": 0.002}
    document = {"lanes": LANES, "robot": {"armature": 5.0}, "simulation": simulation}
    experiment = Experiment.from_document(document)
    loop, recorder = ClosedLoop(pack(experiment), 512), Recorder()
    advance(loop, recorder, 100)
    torque = loop.lanes["A"].work[TAU].copy()
    advance(loop, recorder, 50)
    loop.adopt(pack(experiment.patched({"simulation": {"input_delay": 0.01}})))
    advance(loop, recorder, 20)
    recorder.restore(loop, 0.1)
    commands = loop.lanes["A"].commands
    np.testing.assert_array_equal(commands, np.tile(torque, (12, 1)))


def test_a_lane_that_was_not_there_yet_goes_on_from_where_it_is() -> None:
    simulation = {"mode": "sampled", "input_delay": 0.0074}
    document = {"lanes": LANES, "robot": {"armature": 5.0}, "simulation": simulation}
    experiment = Experiment.from_document(document)
    loop, recorder = ClosedLoop(pack(experiment), 512), Recorder()
    advance(loop, recorder, 103)
    loop.adopt(pack(experiment.patched({"lanes": {"C": {"law": "nftsm"}}})), {"C": "A"})
    advance(loop, recorder, 15)
    state, number = loop.lanes["C"].state(loop.number), loop.number
    assert state.freeze is None
    recorder.restore(loop, 0.05)
    assert loop.number < number
    after = loop.lanes["C"].state(loop.number)
    np.testing.assert_array_equal(after.state, state.state)
    # Torques on their way arrive in the order in which they were sent.
    np.testing.assert_array_equal(after.commands, state.commands)


def test_a_moment_takes_little_memory() -> None:
    simulation = {"mode": "sampled", "control_rate": 10_000.0}
    sizes = {}
    for delay in (0.0, 0.05):
        experiment = Experiment.from_document(
            {"lanes": LANES, "simulation": {**simulation, "input_delay": delay}}
        )
        (lane, _) = ClosedLoop(pack(experiment), 8).state().lanes.values()
        arrays = [value for value in vars(lane).values() if isinstance(value, np.ndarray)]
        assert all(array.base is None for array in arrays)
        sizes[delay] = sum(array.nbytes for array in arrays)
    assert sizes[0.0] <= 1500
    assert sizes[0.05] - sizes[0.0] <= 24_000


def test_what_came_after_a_restored_moment_is_forgotten() -> None:
    loop, recorder = recorded(1.0)
    recorder.restore(loop, 0.4)
    span = recorder.span()
    assert span is not None
    assert span[1] < 0.4
