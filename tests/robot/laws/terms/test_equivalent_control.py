"""Under the equivalent control of a perfect model the sliding variable stands still."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.arm.dynamics import dynamics
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.kernel_arrays import kernel_table
from slidetune.robot.integrator.stages import sample
from slidetune.robot.kernels.workspace import (
    AD,
    QD,
    REACH,
    RECORD,
    S_E,
    S_V,
    TAU,
    VD,
    WORK_ROWS,
    Q,
    S,
    V,
)
from slidetune.robot.laws import LAWS

Array = np.ndarray
SILENT = {"k1": 0.0, "k2": 0.0}
LANES: dict[str, dict[str, Any]] = {
    "NFTSM": {"law": "nftsm", "nu": [0.3, 1, 3, 10, 30, 5], "mu": [0.3, 1, 3, 0, 0.1, 2]},
    "SMC": {"law": "smc", "lambda_": [1, 2, 5, 10, 20, 50]},
}


def s_dot(lane: dict[str, Any], seed: int, **experiment: Any) -> tuple[Array, Array]:
    """Return dS/dt of the true arm under a law at a random state, and the workspace."""
    random = np.random.default_rng(seed)
    document = {
        "lanes": {"A": lane},
        "trajectory": {
            "kind": "sine",
            "amplitude": random.uniform(-1, 1, JOINTS).tolist(),
            "angular_frequency": random.uniform(0, 3, JOINTS).tolist(),
        },
        **experiment,
    }
    packed = pack(Experiment.from_document(document))
    q, v = random.uniform(-3, 3, JOINTS), random.uniform(-3, 3, JOINTS)
    work = np.zeros((WORK_ROWS, JOINTS))
    work[Q], work[V] = q, v
    truth = dynamics(packed.model, work[Q], work[V])
    nominal = dynamics(packed.nominal or packed.model, work[Q], work[V])
    truth.refill()
    nominal.refill()
    gains, record = packed.gains["A"], np.zeros((1, len(RECORD), JOINTS))
    arrays = (gains, packed.environment, packed.trajectory, work, record)
    table = kernel_table(truth, nominal, *arrays, control=LAWS[lane["law"]].control)
    sample(random.uniform(0, 5), 0, 0, table)
    M, nle = truth.inertia, truth.bias
    a = np.linalg.solve(M, work[TAU] - nle)
    return work[S_V] * (work[AD] - a) + work[S_E] * (work[VD] - v), work


@pytest.mark.parametrize("name", LANES)
def test_s_dot_is_zero_under_equivalent_control(name: str) -> None:
    worst = max(np.abs(s_dot({**LANES[name], **SILENT}, seed)[0]).max() for seed in range(300))
    assert worst <= 1e-9


def test_s_dot_is_zero_for_the_published_gains() -> None:
    lane = {"law": "nftsm", **SILENT}
    assert max(np.abs(s_dot(lane, seed)[0]).max() for seed in range(300)) <= 1e-9


def test_s_dot_is_zero_with_payload_and_armature_that_are_known() -> None:
    robot = {"armature": 0.3, "payload": {"mass": 4.0, "known": True}, "inertials": "datasheet"}
    for seed in range(50):
        rate, _ = s_dot({**LANES["NFTSM"], **SILENT}, seed, robot=robot)
        assert np.abs(rate).max() <= 1e-9


def test_s_dot_is_not_zero_under_a_wrong_model() -> None:
    for change in (
        {"disturbance": {"nominal_mismatch": 0.9}},
        {"robot": {"payload": {"mass": 2.0}}},
    ):
        rate, _ = s_dot({**LANES["NFTSM"], **SILENT}, 1, **change)
        assert np.abs(rate).max() > 1.0


def test_a_perfect_model_drives_s_by_the_reaching_law_through_the_inverse_inertia() -> None:
    rate, work = s_dot({**LANES["SMC"], "k1": 3.0, "k2": 2.0}, 5)
    packed = pack(Experiment())
    M = pin.crba(packed.model, packed.model.createData(), work[Q].copy())
    expected = -work[S_V] * np.linalg.solve(M, work[REACH])
    np.testing.assert_allclose(rate, expected, rtol=1e-9, atol=1e-7)


@pytest.mark.parametrize("switching", ["tanh", "saturation"])
def test_shaping_by_the_inertia_gives_the_reaching_law_of_the_textbook(switching: str) -> None:
    k1, k2 = np.array([1, 2, 3, 4, 5, 6.0]), np.array([6, 5, 4, 3, 2, 1.0])
    lane = {
        **LANES["NFTSM"],
        "k1": k1.tolist(),
        "k2": k2.tolist(),
        "epsilon": 2.0,
        "switching": switching,
        "inertia_shaped": True,
    }
    for seed in range(100):
        rate, work = s_dot(lane, seed)
        ratio = work[S] / 2.0
        value = np.tanh(ratio) if switching == "tanh" else np.clip(ratio, -1, 1)
        np.testing.assert_allclose(rate, -k1 * work[S] - k2 * value, rtol=1e-9, atol=1e-8)


def test_computed_torque_makes_a_linear_error_equation() -> None:
    for seed in range(50):
        rate, work = s_dot({"law": "computed_torque", "kp": 100.0, "kd": 20.0}, seed)
        e, de = work[QD] - work[Q], work[VD] - work[V]
        # S = de + 5 e, and the error obeys dde + 20 de + 100 e = 0.
        np.testing.assert_allclose(rate - 5.0 * de, -20.0 * de - 100.0 * e, rtol=1e-8, atol=1e-7)
