"""A whole horizon in one compiled call: the same rows, ends and counts as single steps."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import pytest

from slidetune.robot.arm import arm
from slidetune.robot.arm.known import SHIPPED
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.experiment.presets import SHIPPED_FOLDER, load_preset
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.cutting import cutting_of_whole_run
from slidetune.robot.integrator.law_call import Control, checked
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import (
    CAPPED,
    CUT,
    KNOWN,
    LEFT,
    R_Q,
    RECORD,
    STATE_ROWS,
    TAU,
    UNSOLVED,
    Q,
)
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.accuracy import difference
from slidetune.robot.loop.horizon import Rows, bind_rows, stepped_rows
from slidetune.robot.loop.lane import Lane
from slidetune.robot.loop.simulate import simulate, stop_flag
from tests.trust.random_experiment import Draw

Array = np.ndarray
Document = dict[str, Any]
TOLERANCE = 1e-12
DRAWN = 40
"""Random experiments."""
HORIZON = 0.3
"""Of a preset [s]."""

# In narrow layers a sampled loop chatters, which makes the last bit grow.
CALM = {"k1": 8, "k2": 5, "epsilon": 0.5}
EVERY_LAW: Document = {
    "rbfnn_nftsm": {"law": "rbfnn_nftsm", "nu": 10, "c": 1, **CALM},
    "rbfnn_smc": {"law": "rbfnn_smc", **CALM},
    "nftsm": {"law": "nftsm", "nu": 10, "c": 1, **CALM},
    "smc": {"law": "smc", **CALM},
    "computed_torque": {"law": "computed_torque"},
}
REMEMBERING: Document = {
    "super_twisting": {"law": "super_twisting", "k1": 2, "k2": 5},
    "integral_smc": {"law": "integral_smc", **CALM},
    "adaptive_smc": {"law": "adaptive_smc", **CALM},
    "integral sign": {"law": "integral_smc", "switching": "sign"},
}
VARIANTS: Document = {
    "fast": {"law": "rbfnn_nftsm", "nu": 10, "c": 1, "k1": 8, "k2": 5, "epsilon": 0.1},
    "shaped": {"law": "nftsm", "inertia_shaped": True, "k1": 5, "k2": 5},
    "sign": {"law": "smc", "switching": "sign"},
    "shaped sign": {"law": "nftsm", "inertia_shaped": True, "switching": "sign"},
}
FURTHER_VARIANTS: Document = {
    "implicit": {"law": "smc", "switching": "implicit", **CALM},
    "shaped implicit": {"law": "nftsm", "inertia_shaped": True, "switching": "implicit", **CALM},
    "observed": {"law": "smc", "observer": "momentum", "observer_rate": 20, **CALM},
    "observed, shaped": {
        "law": "nftsm",
        "inertia_shaped": True,
        "observer": "momentum",
        "observer_rate": 20,
        **CALM,
    },
}
OBSERVED: Document = {
    f"observed, {name}": {**REMEMBERING[name], "observer": "momentum", "observer_rate": 20}
    for name in ("super_twisting", "integral_smc", "adaptive_smc")
}
SAMPLED = {"mode": "sampled", "control_rate": 1000.0}
MODES: Document = {
    "plain": {"scheme": "plain"},
    "extrapolated": {"scheme": "extrapolated"},
    "sampled, even": {**SAMPLED, "plant_substeps": 4},
    "sampled, odd": {**SAMPLED, "plant_substeps": 5},
    "sampled, one": {**SAMPLED, "plant_substeps": 1},
    "whole delay": {**SAMPLED, "plant_substeps": 4, "input_delay": 0.002},
    "delay": {**SAMPLED, "plant_substeps": 4, "input_delay": 0.0014},
}
HIDDEN_LOAD = {"mass": 1.5, "center": [0.02, 0.03, 0.1]}
FRICTION = {"viscous_friction": 2.0, "coulomb_friction": 1.0}
NOISE = {"sensor_noise": {"position": 1e-5, "velocity": 1e-3}}
TORQUES = {
    "constant": 1.0,
    "sine": {"amplitude": 2.0},
    "pulse": {"amplitude": 2.0, "start": 0.02, "duration": 0.02, "period": 0.05},
    "noise": {"amplitude": 1.0},
}
ARMS: Document = {
    "the arm alone": {},
    "another nominal arm": {"disturbance": {"nominal_mismatch": 0.8}},
    "known payload": {"robot": {"payload": {**HIDDEN_LOAD, "known": True}}},
    "hidden payload": {"robot": {"payload": HIDDEN_LOAD}},
    "friction": {"robot": FRICTION},
    "limits": {"robot": {"torque_limit": 20.0}},
    "noise": {"disturbance": NOISE},
    "all of it": {
        "robot": {
            "inertials": "datasheet",
            "armature": 1.0,
            "torque_limit": 60.0,
            "payload": HIDDEN_LOAD,
            **FRICTION,
        },
        "disturbance": {"nominal_mismatch": 0.9, **NOISE, **TORQUES},
    },
}
FALLING = {"law": "rbfnn_smc", "k1": 0, "k2": 0, "learning_rate": 0}


class Made(NamedTuple):
    """What came of a lane: ``code`` as ``Rows`` returns it, for the row before which it ended."""

    lane: Lane
    row: int
    code: int
    error: str


def made(
    name: str, packed: Packed, bind: Callable[[Lane, Packed], Rows | None], at_once: int
) -> Made:
    """Make a lane's rows, so many in one call."""
    count = packed.experiment.simulation.rows
    lane = Lane(
        name, packed, np.zeros((count, len(RECORD), packed.joints)), cutting_of_whole_run(count)
    )
    make, rows = bind(lane, packed), np.zeros(2, np.int64)
    assert make is not None
    while rows[0] < count:
        rows[1] = min(rows[0] + at_once, count)
        try:
            code = checked(make(rows, stop_flag()))
        except ArithmeticError as error:
            return Made(lane, int(rows[0]), 0, str(error))
        if code:
            return Made(lane, int(rows[0]), code, "")
    return Made(lane, count, 0, "")


def both(name: str, packed: Packed) -> tuple[Made, Made]:
    """Return what a compiled lane and a stepped one made."""
    return made(name, packed, bind_rows, 37), made(name, packed, stepped_rows, 50)


def blocks(record: Array) -> Iterator[tuple[str, Array]]:
    for index, column in enumerate(RECORD):
        yield column, record[:, index]


def apart(one: Made, other: Made) -> float:
    """Return the greatest difference in a record, relative to a column's greatest number, or 1."""
    end, worst = min(one.row, other.row), 0.0
    known = dict(blocks(other.lane.record[:end]))
    for column, found in blocks(one.lane.record[:end]):
        scale = max(1.0, float(np.abs(known[column]).max(initial=0.0)))
        worst = max(worst, float(np.abs(found - known[column]).max(initial=0.0)) / scale)
    return worst


def same(name: str, document: Document | Experiment) -> Made:
    """Hold that both ways of making a lane give the same; return the compiled one."""
    experiment = document
    if not isinstance(experiment, Experiment):
        experiment = Experiment.from_document(experiment)
    one, other = both(name, pack(experiment))
    assert (one.row, one.code, one.error) == (other.row, other.code, other.error)
    assert np.isfinite(one.lane.record[: one.row]).all()
    assert apart(one, other) < TOLERANCE
    assert one.row == len(one.lane.record) or one.code or one.error
    if not one.code and not one.error:
        state, known = one.lane.work[:STATE_ROWS], other.lane.work[:STATE_ROWS]
        np.testing.assert_allclose(state, known, atol=TOLERANCE * max(1.0, np.abs(known).max()))
    counts, known = one.lane.work[:, 0], other.lane.work[:, 0]
    for row in (KNOWN, UNSOLVED, CAPPED, CUT):
        assert counts[row] == known[row]
    assert counts[LEFT] == pytest.approx(known[LEFT], rel=1e-3, abs=TOLERANCE)
    return one


def within_its_error(name: str, packed: Packed, told: str) -> None:
    """Hold that both ways give the same; where a loop makes the last bit grow, within its error."""
    one, other = both(name, packed)
    if apart(one, other) < TOLERANCE:
        assert (one.row, one.code) == (other.row, other.code), told
        return
    rest = {lane: None for lane in packed.gains if lane != name}
    alone = packed.experiment.patched({"lanes": rest})
    estimate = simulate(alone).lanes[name].accuracy.error_estimate
    end = min(one.row, other.row)
    found = difference(one.lane.record[:end, R_Q], other.lane.record[:end, R_Q])
    assert estimate is not None
    assert found < max(TOLERANCE, 2.0 * estimate), told


def test_every_law_is_compared() -> None:
    assert {lane["law"] for lane in (EVERY_LAW | REMEMBERING).values()} == set(LAWS)


@pytest.mark.parametrize(("mode", "robot"), list(product(MODES, ARMS)))
def test_one_call_gives_the_rows_of_single_steps(mode: str, robot: str) -> None:
    simulation = {**MODES[mode], "horizon": 0.1, "initial_error": 0.02}
    for lanes in (EVERY_LAW, REMEMBERING, VARIANTS, FURTHER_VARIANTS, OBSERVED):
        experiment = Experiment.from_document({"lanes": lanes, "simulation": simulation})
        experiment = experiment.patched({"robot": {"armature": 1.0}}).patched(ARMS[robot])
        for name in lanes:
            same(name, experiment)


@pytest.mark.parametrize("order", ["first", "second"])
@pytest.mark.parametrize("mode", MODES)
def test_one_call_gives_the_rows_of_single_steps_behind_a_lag(mode: str, order: str) -> None:
    drive = {"lag": [0.001, 0.002, 0.0, 0.004, 0.01, 0.02], "lag_order": order}
    simulation = {**MODES[mode], "horizon": 0.1, "initial_error": 0.02}
    for lanes in (EVERY_LAW, REMEMBERING, VARIANTS):
        experiment = Experiment.from_document({"lanes": lanes, "simulation": simulation})
        packed = pack(experiment.patched({"robot": {"armature": 2.0, **drive}}))
        for name in lanes:
            within_its_error(name, packed, name)


@pytest.mark.parametrize("name", sorted(path.stem for path in SHIPPED_FOLDER.glob("*.yaml")))
def test_one_call_gives_the_rows_of_single_steps_of_every_preset(name: str) -> None:
    experiment = load_preset(name).patched({"simulation": {"horizon": HORIZON}})
    packed = pack(experiment)
    for lane in packed.gains:
        if name.startswith("chattering"):
            within_its_error(lane, packed, lane)
        else:
            same(lane, experiment)


@pytest.mark.parametrize("scheme", ["plain", "extrapolated"])
def test_a_step_is_cut_into_the_same_parts(scheme: str) -> None:
    lanes = {"A": {"law": "rbfnn_nftsm", "nu": 10, "c": 1, "k1": 50, "k2": 50, "epsilon": 0.01}}
    simulation = {"scheme": scheme, "step": 0.005, "horizon": 0.5, "initial_error": 0.3}
    lane = same("A", {"lanes": lanes, "simulation": simulation}).lane
    assert scheme == "plain" or lane.work[CUT, 0] > 0


@pytest.mark.parametrize("mode", MODES)
def test_a_lane_leaves_its_bounds_at_the_same_row_and_joint(mode: str) -> None:
    document = {
        "lanes": {"A": FALLING},
        "disturbance": {"constant": [0, 0, 0, 0, 0, -5]},
        "simulation": {**MODES[mode], "horizon": 0.5},
    }
    end = same("A", document)
    assert end.code == 6
    assert 2 < end.row < len(end.lane.record) - 1


def laws_with(monkeypatch: pytest.MonkeyPatch, law: str, control: Control) -> None:
    monkeypatch.setitem(LAWS, law, replace(LAWS[law], control=control))


_smc = LAWS["smc"].control


@kernel
def _none_beyond(state, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    _smc(state, gains, nominal_M, nominal_nle, work)
    if work[state + Q, 1] > 0.03:
        work[TAU, 2] = np.nan


@kernel
def _raises_beyond(state, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    _smc(state, gains, nominal_M, nominal_nle, work)
    if work[state + Q, 1] > 0.03:
        raise ArithmeticError("no torque for this pose")


def _raises_in_python(state: int, *given: Array) -> None:
    _smc(state, *given)
    if given[-1][state + Q, 1] > 0.03:
        raise ArithmeticError("no torque for this pose")


ONE_LANE: Document = {"lanes": {"A": {"law": "smc"}}, "robot": {"armature": 1.0}}


@pytest.mark.parametrize("mode", MODES)
def test_a_law_that_gives_no_number_ends_both_at_the_same_row(
    mode: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    laws_with(monkeypatch, "smc", _none_beyond)
    end = same("A", {**ONE_LANE, "simulation": {**MODES[mode], "horizon": 0.2}})
    assert end.code
    assert np.isnan(end.lane.work[TAU, 2])
    assert end.row > 5


@pytest.mark.parametrize("control", [_raises_beyond, _raises_in_python], ids=["compiled", "plain"])
@pytest.mark.parametrize("mode", MODES)
def test_a_law_that_raises_ends_both_at_the_same_row(
    mode: str, control: Control, monkeypatch: pytest.MonkeyPatch
) -> None:
    laws_with(monkeypatch, "smc", control)
    end = same("A", {**ONE_LANE, "simulation": {**MODES[mode], "horizon": 0.2}})
    assert end.error == "no torque for this pose"
    assert end.row > 5


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("law", LAWS)
def test_a_law_of_plain_python_is_called_back_and_gives_the_rows_of_a_compiled_one(
    law: str, mode: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    document = {
        **ARMS["all of it"],
        "lanes": {"A": (EVERY_LAW | REMEMBERING)[law]},
        "simulation": {**MODES[mode], "horizon": 0.1},
    }
    compiled = same("A", document)
    control: Any = LAWS[law].control
    laws_with(monkeypatch, law, lambda *given: control(*given))
    np.testing.assert_array_equal(same("A", document).lane.record, compiled.lane.record)


def test_one_call_gives_the_rows_of_single_steps_of_whatever_can_be_set() -> None:
    draw, lanes = Draw(5, arms=(SHIPPED, SHIPPED, "pendulum", "two_links")), 0
    for number in range(DRAWN):
        try:
            packed = pack(Experiment.from_document(draw.document()))
        except InvalidExperimentError:
            continue
        for name in packed.gains:
            lanes += 1
            within_its_error(name, packed, f"no. {number}, {name}")
    assert lanes > DRAWN


@pytest.fixture
def without_chain(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """No arm agrees with Pinocchio."""
    monkeypatch.setattr(arm, "checked_chain", lambda model: None)
    arm.build_arm.cache_clear()
    arm._warn_once.cache_clear()
    yield
    arm.build_arm.cache_clear()


def test_an_arm_that_is_no_chain_is_stepped_and_says_so_once(
    without_chain: None, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    experiment = Experiment.from_document({"lanes": EVERY_LAW, "simulation": {"horizon": 0.1}})
    packed = pack(experiment)
    assert packed.chain is None
    for name in packed.gains:
        lane = Lane(name, packed, np.zeros((1, len(RECORD), JOINTS)), cutting_of_whole_run(1))
        assert bind_rows(lane, packed) is None
    stepped = simulate(experiment)
    told = [record for record in caplog.records if record.name == "slidetune.arm"]
    assert len(told) == 1
    assert "stepped" in told[0].getMessage()
    monkeypatch.undo()
    arm.build_arm.cache_clear()
    for name, lane in simulate(experiment).lanes.items():
        for column in ("q", "v", "tau", "S", "f", "weights"):
            expected = getattr(lane, column)
            scale = max(1.0, np.abs(expected).max())
            found = getattr(stepped.lanes[name], column)
            np.testing.assert_allclose(found, expected, atol=TOLERANCE * scale, rtol=0.0)
        assert stepped.lanes[name].accuracy.unconverged == lane.accuracy.unconverged
        assert stepped.lanes[name].accuracy.capped == lane.accuracy.capped


def test_a_nominal_arm_that_is_no_chain_is_stepped_too() -> None:
    packed = pack(Experiment.from_document({**ARMS["another nominal arm"], "lanes": EVERY_LAW}))
    assert packed.chain is not None
    assert packed.nominal_chain is not None
    other = replace(packed, nominal_chain=None)
    lane = Lane("nftsm", other, np.zeros((1, len(RECORD), JOINTS)), cutting_of_whole_run(1))
    assert bind_rows(lane, other) is None
    assert bind_rows(lane, packed) is not None
