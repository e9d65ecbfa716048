"""The reference itself: against closed forms, published solutions, and what is stored of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp

from slidetune.robot.arm.arm import build_model
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.laws import LAWS
from tests.reference.arm import JOINTS, arm
from tests.reference.data import TIME, read
from tests.reference.draw import DRAWS, widely
from tests.reference.loop import Loop
from tests.reference.solve import solve

Array = np.ndarray
DATA = Path(__file__).parent.parent / "data"


def document(lane: dict[str, Any], **sections: Any) -> dict[str, Any]:
    return Experiment.from_document({"lanes": {"A": lane}, **sections}).document()


@pytest.mark.parametrize(
    "robot",
    [
        {},
        {"inertials": "datasheet", "inertia_scale": 1.3, "armature": 0.4},
        {"payload": {"mass": 4.0, "center": [0.1, -0.05, 0.2], "known": True}},
    ],
)
def test_two_arms_built_apart_are_one(robot: dict[str, Any]) -> None:
    section = document({"law": "smc"}, robot=robot)["robot"]
    ours = build_model(Experiment.from_document({"robot": robot}).robot)
    other = arm(section)
    random = np.random.default_rng(1)
    for _ in range(20):
        q, v, a = random.uniform(-3.0, 3.0, (3, JOINTS))
        torques = [pin.rnea(model, model.createData(), q, v, a) for model in (ours, other)]
        np.testing.assert_allclose(torques[0], torques[1], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    ("lane", "name"),
    [("NFTSM", "nftsm"), ("RBFNN-NFTSM", "rbfnn-nftsm"), ("RBFNN-SMC", "rbfnn-smc")],
)
def test_it_agrees_with_the_solutions_of_the_published_loops(lane: str, name: str) -> None:
    preset = load_preset("paper-undisturbed")
    others = {other: None for other in preset.lanes if other != lane}
    time = np.arange(26) * 0.02
    found = solve(preset.patched({"lanes": others}).document(), time, 1e-11)
    truth = np.genfromtxt(DATA / f"{name}.csv", delimiter=",", names=True)
    q = np.array([truth[f"q{joint}"] for joint in range(1, 7)]).T[: len(time)]
    # Theirs has the joint origins as the manufacturer prints them, up to 12 µm from the clean ones.
    np.testing.assert_allclose(found.q, q, atol=1e-6)


def test_computed_torque_leaves_the_linear_error_equation() -> None:
    lane = {"law": "computed_torque", "kp": 100.0, "kd": 12.0}
    found = solve(document(lane, simulation={"initial_error": 0.2}), TIME, 1e-10)
    # e'' + 12 e' + 100 e = 0 with e(0) = 0.2 and e'(0) = 0.
    omega = 8.0
    shape = np.cos(omega * TIME) + 6.0 / omega * np.sin(omega * TIME)
    e = np.sin(TIME) - found.q[:, 3]
    np.testing.assert_allclose(e, 0.2 * np.exp(-6.0 * TIME) * shape, atol=1e-8)


@pytest.mark.parametrize("switching", ["tanh", "saturation", "sign"])
def test_shaped_by_the_inertia_every_joint_obeys_its_reaching_law(switching: str) -> None:
    gains = {"nu": 5.0, "c": 1.0, "mu": 0.0, "k1": 3.0, "k2": 2.0, "epsilon": 0.1}
    lane = {"law": "nftsm", "inertia_shaped": True, "switching": switching, **gains}
    found = solve(document(lane, simulation={"initial_error": 0.3}), TIME, 1e-10)

    def rate(_: float, y: Array) -> Array:
        s, e = y
        switched = {
            "tanh": np.tanh(s / 0.1),
            "saturation": np.clip(s / 0.1, -1.0, 1.0),
            "sign": np.clip(s / 1e-6, -1.0, 1.0),
        }[switching]
        return np.array([-3.0 * s - 2.0 * switched, s - 5.0 * e])

    start = [5.0 * 0.3, 0.3]
    scalar = solve_ivp(rate, (0.0, 1.0), start, "Radau", TIME, rtol=1e-10, atol=1e-12)
    for joint in range(JOINTS):
        np.testing.assert_allclose(np.sin(TIME) - found.q[:, joint], scalar.y[1], atol=1e-6)


@pytest.mark.parametrize("seed", range(10))
def test_its_jacobian_is_the_derivative(seed: int) -> None:
    loop = Loop(widely(seed), thin=0.1)
    random = np.random.default_rng(seed)
    y = loop.start + 0.05 * random.normal(size=len(loop.start))
    found = loop.jacobian(0.3, y)
    close = np.zeros(found.shape, dtype=bool)
    # A small slope drowns in the rounding of a small difference, a bend in a large one.
    for by in (1e-5, 1e-6, 1e-7, 1e-8):
        ends = [(loop.rate(0.3, y + by * d), loop.rate(0.3, y - by * d)) for d in np.eye(len(y))]
        expected = np.array([(high - low) / (2.0 * by) for high, low in ends]).T
        close |= np.isclose(found, expected, rtol=1e-3, atol=1e-6 * np.abs(found).max())
    assert close.all()


def test_the_stored_cases_are_as_many_as_are_told() -> None:
    cases = read()
    assert [case.origin for case in cases] == ["hand"] * 100 + ["wide"] * 100 + ["world"] * 60
    assert set(DRAWS) >= {case.origin for case in cases}


def test_the_stored_cases_cover_all_that_can_be_chosen() -> None:
    cases = read()
    lanes = [next(iter(case.document["lanes"].values())) for case in cases]
    for law in LAWS:
        assert sum(lane["law"] == law for lane in lanes) >= 20
    for key, values in (
        ("switching", ("tanh", "saturation", "sign")),
        ("reaching", ("exponential", "constant", "power")),
    ):
        for value in values:
            assert sum(lane.get(key) == value for lane in lanes) >= 20
    kinds = [case.document["trajectory"]["kind"] for case in cases]
    assert set(kinds) == {"sine", "quintic", "hold", "circle"}
    robots = [case.document["robot"] for case in cases]
    assert sum(robot["torque_limit"] is not None for robot in robots) >= 30
    assert sum(robot["payload"]["mass"] > 0.0 for robot in robots) >= 30
    assert sum(np.any(robot["coulomb_friction"]) for robot in robots) >= 30
    world = [case.document for case in cases if case.origin == "world"]
    for part in ("sine", "pulse", "noise"):
        assert sum(np.any(one["disturbance"][part]["amplitude"]) for one in world) >= 10
    assert sum(np.any(one["simulation"]["initial_error"]) for one in world) >= 10
    assert sum(case.agreement < 1e-5 for case in cases) >= 256


@pytest.mark.parametrize("number", [0, 2, 108])
def test_a_stored_case_is_solved_anew(number: int) -> None:
    case = read()[number]
    # What has been added since it was stored is off.
    found = solve(Experiment.from_document(case.document).document(), TIME, 1e-9)
    np.testing.assert_allclose(found.q, case.q, atol=1e-6)
