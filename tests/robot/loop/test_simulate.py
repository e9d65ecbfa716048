"""Whole runs: what they hold, that they repeat, that nothing makes them stumble."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, get_args

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydantic.fields import FieldInfo

from slidetune.robot.arm.arm import build_model, flange_positions, shipped_places
from slidetune.robot.arm.section import Robot
from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.experiment.simulation import Simulation
from slidetune.robot.fields.quantity import JOINTS, Section
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.robot.loop.simulate import CancelledError, LaneRun, Run, simulate, stop_flag
from slidetune.robot.motion.trajectory import (
    CircleTrajectory,
    HoldTrajectory,
    QuinticTrajectory,
    SineTrajectory,
)

Array = np.ndarray
COLUMNS = ("q", "v", "tau", "S", "f", "weights", "e", "de", "flange", "flange_desired")
SHORT = {"simulation": {"horizon": 0.2}}
# Everything is on, so that every number has something to act on.
BUSY: dict[str, Any] = {
    "robot": {
        "inertials": "datasheet",
        "inertia_scale": 1.1,
        "armature": 0.3,
        "viscous_friction": 1.0,
        "coulomb_friction": 1.0,
        "torque_limit": [25.0] * JOINTS,
        "lag": 0.002,
        "payload": {"mass": 2.0, "center": [0.02, 0.03, 0.1]},
    },
    "lanes": {
        "A": {"law": "rbfnn_nftsm", "k1": 8.0, "k2": 5.0, "nu": 5.0, "c": 1.0},
        "B": {"law": "computed_torque"},
    },
    "trajectory": {"kind": "sine", "phase": 0.2, "offset": 0.3},
    "disturbance": {
        "constant": 1.0,
        "sine": {"amplitude": 1.0, "phase": 0.5},
        "pulse": {"amplitude": 2.0, "start": 0.02, "duration": 0.02, "period": 0.05},
        "noise": {"amplitude": 1.0},
        "nominal_mismatch": 0.9,
        "sensor_noise": {"position": 1e-4, "velocity": 1e-2},
    },
    "simulation": {
        "mode": "sampled",
        "control_rate": 500.0,
        "plant_substeps": 4,
        "input_delay": 0.003,
        "horizon": 0.15,
        "initial_error": 0.1,
        "step": 0.002,
    },
}
# What the law is told not to look at, or where there is no choice yet.
INERT = {"title", "description", "slidetune", "model", "kind", "lanes", "goals", "uncertainty"}


def experiment_of(document: dict[str, Any]) -> Experiment:
    return Experiment.from_document(document)


def lane_of(document: dict[str, Any]) -> LaneRun:
    return next(iter(simulate(experiment_of(document)).lanes.values()))


def same(one: Run, other: Run) -> bool:
    return len(one.time) == len(other.time) and all(
        lane.high_frequency == other.lanes[key].high_frequency
        and np.array_equal(getattr(lane, name), getattr(other.lanes[key], name), equal_nan=True)
        for key, lane in one.lanes.items()
        for name in COLUMNS
    )


def test_columns_belong_together() -> None:
    run = simulate(experiment_of({**BUSY, "simulation": {"horizon": 0.2}}))
    assert run.time[0] == 0.0
    assert run.time[-1] == pytest.approx(0.2)
    assert len(run.time) == 201
    for lane in run.lanes.values():
        for name in COLUMNS[:8]:
            assert getattr(lane, name).shape == (201, JOINTS), name
        np.testing.assert_array_equal(lane.e, run.q_d - lane.q)
        np.testing.assert_array_equal(lane.de, run.v_d - lane.v)
        np.testing.assert_allclose(
            lane.flange, flange_positions(lane.q, shipped_places()), atol=1e-12
        )
        np.testing.assert_allclose(
            lane.flange_desired, flange_positions(run.q_d, shipped_places()), atol=1e-12
        )
        assert lane.freeze is None


@pytest.mark.parametrize(("mode", "rows"), [("continuous", 101), ("sampled", 51)])
def test_rows_follow_the_step_of_the_mode(mode: str, rows: int) -> None:
    simulation = {"mode": mode, "step": 0.002, "control_rate": 250.0, "horizon": 0.2}
    run = simulate(experiment_of({"simulation": simulation}))
    assert len(run.time) == rows
    np.testing.assert_allclose(np.diff(run.time), 0.2 / (rows - 1))


@pytest.mark.parametrize("mode", ["continuous", "sampled"])
def test_same_experiment_gives_the_same_bits(mode: str) -> None:
    experiment = experiment_of(BUSY).patched({"simulation": {"mode": mode}})
    copy = experiment_of(experiment.document())
    assert same(simulate(experiment), simulate(copy))


def test_another_seed_gives_another_run() -> None:
    experiment = experiment_of(BUSY)
    other = experiment.patched({"disturbance": {"seed": 2}})
    assert not same(simulate(experiment), simulate(other))


def test_seed_is_without_effect_where_nothing_is_random() -> None:
    experiment = experiment_of(SHORT)
    assert same(simulate(experiment), simulate(experiment.patched({"disturbance": {"seed": 2}})))


@pytest.mark.parametrize(
    "field", ["armature", "viscous_friction", "coulomb_friction", "torque_limit", "lag"]
)
def test_six_equal_numbers_are_one(field: str) -> None:
    experiment = experiment_of(BUSY)
    number = {"torque_limit": 20.0, "lag": 0.003}.get(field, 0.7)
    one = experiment.patched({"robot": {field: number}})
    value = getattr(one.robot, field)
    assert same(simulate(one), simulate(one.patched({"robot": {field: [value] * JOINTS}})))


def leaves(section: Section, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Walk through all fields of an experiment but its lanes."""
    for name, info in type(section).model_fields.items():
        value = getattr(section, name)
        if name in INERT:
            continue
        if isinstance(value, Section):
            yield from leaves(value, (*path, name))
        else:
            yield (*path, name), info


LEAVES = list(leaves(experiment_of(BUSY)))


def changed(info: FieldInfo, value: Any) -> Any:
    """Return another value of the field, not far away."""
    extra = info.json_schema_extra
    if isinstance(value, bool):
        return not value
    if isinstance(value, str):
        return next(choice for choice in get_args(info.annotation) if choice != value)
    assert isinstance(extra, dict)
    if isinstance(value, tuple):
        return [0.8 * number for number in value]
    other = value + 1 if isinstance(value, int) else 1.25 * value or 0.5 * float(extra["maximum"])
    return min(other, extra["maximum"])


@pytest.mark.parametrize("mode", ["continuous", "sampled"])
@pytest.mark.parametrize(("path", "info"), LEAVES, ids=[".".join(path) for path, _ in LEAVES])
def test_every_field_acts_in_the_modes_that_it_names(
    path: tuple[str, ...], info: FieldInfo, mode: str
) -> None:
    base = experiment_of(BUSY).patched({"simulation": {"mode": mode}})
    value: Any = base
    for name in path:
        value = getattr(value, name)
    patch: Any = changed(info, value)
    for name in reversed(path):
        patch = {name: patch}
    extra = info.json_schema_extra
    applies = extra.get("applies") if isinstance(extra, dict) else None
    acts = applies in (None, mode)
    assert same(simulate(base), simulate(base.patched(patch))) != acts


def held_torques(run: Run, lane: LaneRun, late: float) -> Array:
    """Integrate the arm alone under the recorded torques, each late by ``late`` [s]."""
    simulation = run.experiment.simulation
    model = build_model(run.experiment.robot)
    data = model.createData()
    q, v, rows = lane.q[0].copy(), lane.v[0].copy(), []
    substeps = simulation.plant_substeps
    h = 1.0 / simulation.control_rate / substeps
    for row in range(len(run.time)):
        rows.append(q.copy())
        for substep in range(substeps):
            sent = math.floor((row * substeps + substep - round(late / h)) / substeps)
            torque = lane.tau[sent] if sent >= 0 else np.zeros(JOINTS)
            v = v + h * pin.aba(model, data, q, v, torque)
            q = q + h * v
    return np.array(rows)


@pytest.mark.parametrize("delay", [0.0, 0.0002, 0.0009, 0.001, 0.0013, 0.002, 0.0047, 0.02])
def test_torque_arrives_late_by_the_exact_time(delay: float) -> None:
    document = {
        "robot": {"inertials": "datasheet", "armature": 0.5},
        "lanes": {"A": {"law": "smc", "k1": 2.0, "k2": 0.0, "lambda_": 2.0}},
        "simulation": {"mode": "sampled", "input_delay": delay, "horizon": 0.1},
    }
    run = simulate(experiment_of(document))
    lane = run.lanes["A"]
    np.testing.assert_allclose(held_torques(run, lane, delay), lane.q, atol=1e-9)
    if delay:
        assert np.abs(held_torques(run, lane, 0.0) - lane.q).max() > 1e-7


def test_limits_that_are_never_reached_change_nothing() -> None:
    free = {**SHORT, "lanes": {"A": {"law": "smc"}}}
    run = simulate(experiment_of(free))
    wide = simulate(experiment_of({**free, "robot": {"torque_limit": 5000.0}}))
    assert same(run, wide)


def test_a_lane_that_leaves_its_bounds_is_nan_from_there_and_never_before() -> None:
    lanes = {
        "falls": {"law": "rbfnn_smc", "k1": 0, "k2": 0, "learning_rate": 0},
        "holds": {"law": "rbfnn_nftsm"},
    }
    document = {**SHORT, "lanes": lanes, "disturbance": {"constant": -50.0}}
    run = simulate(experiment_of(document))
    lane = run.lanes["falls"]
    assert lane.freeze is not None
    rows = run.time <= lane.freeze.time
    assert rows.sum() > 1
    for name in COLUMNS[:9]:
        assert np.isfinite(getattr(lane, name)[rows]).all(), name
        assert np.isnan(getattr(lane, name)[~rows]).all(), name
    assert np.isfinite(lane.flange_desired).all()
    assert lane.metrics.diverged_at == lane.freeze.time
    assert np.isfinite(lane.metrics.mae).all()
    assert run.lanes["holds"].freeze is None
    assert np.isfinite(run.lanes["holds"].q).all()


def test_progress_goes_from_none_to_all_in_order() -> None:
    shares: list[float] = []
    lanes = {"A": {"law": "smc"}, "B": {"law": "nftsm"}}
    simulate(experiment_of({"lanes": lanes, "simulation": {"horizon": 2.0}}), shares.append)
    assert shares == sorted(shares)
    assert (shares[0], shares[-1]) == (0.0, 1.0)
    assert len(shares) > 4


@pytest.mark.parametrize("mode", ["continuous", "sampled"])
def test_a_run_can_be_stopped_halfway(mode: str) -> None:
    stop, shares = stop_flag(), list[float]()

    def tell(share: float) -> None:
        shares.append(share)
        stop[0] = share > 0.3

    calm = {"law": "smc", "k1": 5.0, "k2": 1.0}
    simulation = {"mode": mode, "horizon": 60.0}
    heavy = {"robot": {"armature": 5.0}, "lanes": {"A": calm}, "simulation": simulation}
    with pytest.raises(CancelledError):
        simulate(experiment_of(heavy), tell, stop)
    assert 0.3 < shares[-1] < 0.4


def test_an_unreachable_trajectory_is_refused_before_the_run() -> None:
    with pytest.raises(InvalidExperimentError, match="radius"):
        simulate(experiment_of({"trajectory": {"kind": "circle", "radius": 0.5}}))


@pytest.mark.parametrize("kind", ["quintic", "hold", "circle"])
@pytest.mark.parametrize("mode", ["continuous", "sampled"])
def test_every_trajectory_is_followed(kind: str, mode: str) -> None:
    document = {
        "robot": {"armature": 0.5},
        "trajectory": {"kind": kind},
        "lanes": {"A": {"law": "computed_torque"}},
        "simulation": {"mode": mode, "horizon": 1.0},
    }
    assert np.abs(lane_of(document).e).max() < 2e-3


# --- any experiment -----------------------------------------------------------------------------

RATIOS = ((5.0, 3.0), (7.0, 5.0), (9.0, 7.0), (19.0, 11.0))
CHEAP = {"horizon": 1.0, "plant_substeps": 20}


def any_value(name: str, info: FieldInfo) -> st.SearchStrategy[Any]:
    kind, extra = info.annotation, info.json_schema_extra
    if isinstance(kind, type) and issubclass(kind, Section):
        return any_section(kind)
    if name == "model":
        return st.just(info.default)
    if not isinstance(extra, dict) or "minimum" not in extra:
        return st.booleans() if kind is bool else st.sampled_from(get_args(kind))
    low, high = float(extra["minimum"]), float(CHEAP.get(name, extra["maximum"]))
    if kind is int:
        return st.integers(int(low), int(high))
    # The ends of the bounds and the default are where the trouble lives.
    number = st.floats(low, high) | st.sampled_from([low, high])
    if isinstance(info.default, tuple):
        return st.lists(number, min_size=len(info.default), max_size=len(info.default))
    if kind is float:
        return number | st.just(info.default)
    return st.just(info.default) | number | st.lists(number, min_size=JOINTS, max_size=JOINTS)


@st.composite
def any_section(draw: st.DrawFn, kind: type[Section]) -> dict[str, Any]:
    values = {name: draw(any_value(name, info)) for name, info in kind.model_fields.items()}
    if "p" in values:
        values["p"], values["k"] = draw(st.sampled_from(RATIOS))
    if (values.get("switching"), values.get("reaching")) == ("implicit", "power"):
        values["switching"] = "sign"
    return values


TRAJECTORIES = (SineTrajectory, QuinticTrajectory, HoldTrajectory, CircleTrajectory)


@st.composite
def any_document(draw: st.DrawFn) -> dict[str, Any]:
    lanes = st.one_of([any_section(law.lane) for law in LAWS.values()])
    document = {
        "robot": draw(any_section(Robot)),
        "lanes": {"A": draw(lanes), "B": draw(lanes)},
        "trajectory": draw(any_section(draw(st.sampled_from(TRAJECTORIES)))),
        "disturbance": draw(any_section(Disturbance)),
        "simulation": draw(any_section(Simulation)),
    }
    if document["simulation"]["mode"] == "continuous":
        for lane in document["lanes"].values():
            if lane.get("switching") == "sign":
                lane["switching"] = "tanh"
    return document


def packed_or_refusal(experiment: Experiment) -> Packed | InvalidExperimentError:
    try:
        return pack(experiment)
    except InvalidExperimentError as error:
        return error


@settings(
    max_examples=80,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
@given(any_document())
def test_any_experiment_runs_or_freezes_with_a_cause(document: dict[str, Any]) -> None:
    experiment = experiment_of(document)
    assert experiment_of(experiment.document()) == experiment
    packed = packed_or_refusal(experiment)
    if isinstance(packed, InvalidExperimentError):
        assert packed.fields[0].path.startswith("trajectory.")
        return
    loop = ClosedLoop(packed, 64)
    for _ in range(40):
        row = loop.step()
        for lane in loop.lanes.values():
            assert np.isfinite(lane.record[row]).all()
    for lane in loop.lanes.values():
        if lane.freeze is not None:
            assert f"Joint {lane.freeze.joint} " in lane.freeze.cause
            assert 0.0 <= lane.freeze.time < loop.time
            assert lane.freeze.gamma is None or np.isfinite(lane.freeze.gamma)
