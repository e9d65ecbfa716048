"""What torques are asked for before anything runs."""

from __future__ import annotations

import numpy as np

from slidetune.robot.advice.torque_need import initial_torque, required_torque
from slidetune.robot.loop.simulate import simulate
from tests.robot.advice.test_advice import DATASHEET, packed_of


def test_initial_torque_is_the_first_of_the_run() -> None:
    error = [0.1, 0, -0.1, 0, 0.2, 0]
    simulation = {"horizon": 0.1, "initial_error": error, "initial_velocity": "rest"}
    for law in ("rbfnn_nftsm", "nftsm", "computed_torque"):
        packed = packed_of({"simulation": simulation}, {"law": law})
        run = simulate(packed.experiment)
        np.testing.assert_allclose(initial_torque(packed, "A"), run.lanes["A"].tau[0], rtol=1e-9)


def test_required_torque_is_what_perfect_tracking_takes() -> None:
    friction = {"viscous_friction": 3.0, "coulomb_friction": 2.0}
    document = {"robot": {**DATASHEET, **friction}, "disturbance": {"constant": 4.0}}
    lane = {"law": "computed_torque", "kp": 10000, "kd": 200}
    packed = packed_of(document, lane)
    greatest = np.abs(simulate(packed.experiment).lanes["A"].tau[2000:]).max(axis=0)
    np.testing.assert_allclose(required_torque(packed), greatest, rtol=0.02, atol=0.3)


def test_required_torque_sees_a_move_that_is_short_in_its_horizon() -> None:
    move = {"kind": "quintic", "duration": 0.8, "end": [0.8, 0.8, -0.8, 0.8, 0.5, 0.5]}
    lane = {"law": "computed_torque", "kp": 10000, "kd": 200}
    document = {"robot": DATASHEET, "trajectory": move}
    needs = [
        required_torque(packed_of({**document, "simulation": {"horizon": horizon}}, lane))
        for horizon in (100.0, 0.8)
    ]
    np.testing.assert_allclose(needs[0], needs[1], rtol=0.02, atol=0.3)
