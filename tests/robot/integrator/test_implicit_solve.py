"""The solved step: its equation holds for every curve, its sliding is held, nothing is claimed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot import load_preset
from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.environment.external_torque import COULOMB_WIDTH
from slidetune.robot.environment.layout import pack_environment
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.implicit_solve import SOLVED
from slidetune.robot.integrator.implicit_step import implicit_step
from slidetune.robot.kernels.workspace import (
    AD,
    BENDS,
    CURRENT,
    F_SLOPE,
    FULL,
    HELD,
    HELD_TORQUE,
    LEAKAGE,
    LEARNING,
    NETWORK,
    NETWORK_SLOPE,
    REACH,
    S_E,
    S_V,
    SHAPE,
    SHAPED,
    SLIDING,
    TAU,
    TERMINAL_C,
    TERMINAL_RATIO,
    VD,
    WORK_ROWS,
    F,
    Q,
    S,
    V,
)
from slidetune.robot.laws.terms.switching import ReachingGains, reach
from slidetune.robot.loop.simulate import simulate

Array = np.ndarray
SWITCHINGS = ("tanh", "saturation", "sign")
REACHINGS = ("exponential", "constant", "power")


class Drawn:
    """A step as a law might leave it: light wrists, thin layers, friction, limits."""

    def __init__(self, seed: int, switching: str, reaching: str, shaped: bool = False) -> None:
        self.random = random = np.random.default_rng(seed)
        self.h = 10.0 ** random.uniform(-4, -2.3)
        root = random.normal(size=(JOINTS, JOINTS)) / np.sqrt(JOINTS)
        heavy = np.diag([4.0, 4.0, 2.0, 0.1, 0.03, 0.03])
        self.M = heavy @ (root @ root.T + 0.05 * np.eye(JOINTS)) @ heavy
        self.bias = 50.0 * random.normal(size=JOINTS)
        self.gains = ReachingGains.model_validate(
            {
                "k1": random.uniform(0.0, 500.0),
                "k2": random.uniform(0.0, 500.0),
                "epsilon": 10.0 ** random.uniform(-4, 1),
                "alpha": random.uniform(0.05, 0.95),
                "switching": switching,
                "reaching": reaching,
            }
        )
        self.coulomb = random.choice([0.0, 20.0])
        self.limit = None if shaped else random.choice([None, 30.0, 300.0])
        self.environment = pack_environment(Disturbance(), 2.0, self.coulomb, self.limit)
        self.work = work = np.zeros((WORK_ROWS, JOINTS))
        work[V], work[VD], work[AD] = random.normal(size=(3, JOINTS))
        work[S] = random.normal(size=JOINTS) * 10.0 ** random.uniform(-3, 1, JOINTS)
        work[S_V], work[S_E] = 10.0 ** random.uniform(-1, 1, (2, JOINTS))
        rubbing = np.tanh(work[V] / COULOMB_WIDTH)
        work[F] = 2.0 * work[V] + self.coulomb * rubbing
        work[F_SLOPE] = 2.0 + self.coulomb * (1.0 - rubbing**2) / COULOMB_WIDTH
        if not shaped:
            work[NETWORK], work[LEARNING] = 5.0, 30.0
            work[NETWORK_SLOPE], work[LEAKAGE] = 150.0, 1.0
        reach(self.gains.pack_reaching(), work)
        self.rest = 30.0 * random.normal(size=JOINTS)
        self.share = np.eye(JOINTS)
        if shaped:
            # A nominal arm of the same shape, as a model-based law has it.
            work[SHAPED, 0] = 1.0
            self.share = 0.9 * self.M / work[S_V]
            work[SHAPE : SHAPE + JOINTS] = self.share
        work[TAU] = self.rest + self.share @ work[REACH]
        self.before = work.copy()
        self.left = implicit_step(self.h, CURRENT, FULL, self.M, self.bias, self.environment, work)
        self.a = (work[FULL + V] - work[CURRENT + V]) / self.h

    def needed(self) -> Array:
        """Return the torque that the motion took of the controller. Shape (6,)."""
        v = self.work[FULL + V]
        lost = 2.0 * v + self.coulomb * np.tanh(v / COULOMB_WIDTH)
        return np.asarray(self.M @ self.a + self.bias + lost)

    def end(self) -> Array:
        """Return S at the end of the step. Shape (6,)."""
        row = self.before
        moved = row[S_V] * (row[AD] - self.a) + row[S_E] * (row[VD] - self.work[FULL + V])
        return np.asarray(row[S] + self.h * moved)

    def asked(self, s: Array) -> Array:
        """Return what the law asks for at S, before its limit. Shape (6,)."""
        at = np.zeros((WORK_ROWS, JOINTS))
        at[S] = s
        reach(self.gains.pack_reaching(), at)
        row = self.before
        learned = self.h * (row[NETWORK_SLOPE] * s - row[LEAKAGE] * row[NETWORK])
        return np.asarray(self.rest + self.share @ at[REACH] + learned)

    def limited(self, torque: Array) -> Array:
        """Return a torque within the limit."""
        return torque if self.limit is None else np.clip(torque, -self.limit, self.limit)


@pytest.mark.parametrize("shaped", [False, True], ids=["plain", "shaped"])
@pytest.mark.parametrize("reaching", REACHINGS)
@pytest.mark.parametrize("switching", SWITCHINGS)
def test_the_torque_at_the_end_is_what_the_law_asks_for_there(
    switching: str, reaching: str, shaped: bool
) -> None:
    for seed in range(60):
        step = Drawn(seed, switching, reaching, shaped)
        assert step.left <= SOLVED, seed
        # Rounding of S times the slope of the law, within which no torque can be told from another.
        s, blur = step.end(), 1e-11 * (1.0 + np.abs(step.before[S]))
        high, low = step.asked(s + blur), step.asked(s - blur)
        needed, room = step.needed(), 1e-5 + SOLVED * np.diag(step.M) / step.h
        if shaped:
            # Joint by joint, before the inertia spreads it.
            spread = np.linalg.inv(step.share)
            needed, high, low = (spread @ (torque - step.rest) for torque in (needed, high, low))
            room = np.abs(spread) @ room
        else:
            high, low = step.limited(high), step.limited(low)
        assert (needed >= low - room).all(), (seed, needed - low)
        assert (needed <= high + room).all(), (seed, needed - high)


@pytest.mark.parametrize("shaped", [False, True], ids=["plain", "shaped"])
def test_sign_holds_a_joint_on_its_surface_with_less_than_k2(shaped: bool) -> None:
    held = 0
    for seed in range(60):
        step = Drawn(seed, "sign", "exponential", shaped)
        if step.work[HELD, 0] == 0.0:
            continue
        held += 1
        on = np.abs(step.end()) <= 1e-12 * (1.0 + np.abs(step.before[S]))
        assert on.any()
        sliding = step.work[SLIDING] != 0.0
        np.testing.assert_allclose(
            step.work[HELD_TORQUE][sliding], step.needed()[sliding], rtol=1e-6, atol=1e-4
        )
    assert held > 10


def run_of(lane: dict[str, Any], **simulation: Any) -> Any:
    document = {"lanes": {"A": lane}, "simulation": {"horizon": 1.0, **simulation}}
    return simulate(Experiment.from_document(document)).lanes["A"]


def test_sign_in_continuous_mode_keeps_S_at_zero_and_its_torque_smooth() -> None:
    gains = {"law": "smc", "k1": 20.0, "k2": 400.0, "lambda_": 5.0, "switching": "sign"}
    lane = run_of(gains, initial_velocity="rest")
    assert np.abs(lane.S[0]).min() > 0.5
    # What is left of it is how the desired motion bends within a step.
    assert np.abs(lane.S[300:]).max() < 1e-5
    # Not a torque that jumps between plus and minus k2, but the one that holds it there.
    assert np.abs(np.diff(lane.tau[300:], axis=0)).max() < 2.0
    assert lane.accuracy.error_estimate < 1e-4


@pytest.mark.parametrize("change", [{"epsilon": 0.3}, {"k2": 450.0}, {"k1": 50.0}])
def test_wrists_do_not_stick_beside_their_surface(change: dict[str, float]) -> None:
    undisturbed = load_preset("paper-undisturbed")
    others = {name: None for name in undisturbed.lanes if name != "NFTSM"}
    patch = {"lanes": {"NFTSM": change, **others}, "simulation": {"horizon": 2.0}}
    lane = simulate(undisturbed.patched(patch)).lanes["NFTSM"]
    assert lane.metrics.mae[3:].max() < 3e-4
    assert lane.metrics.chattering < 10_000.0
    assert lane.accuracy.error_estimate < 1e-4


def test_a_held_torque_that_friction_stops_does_not_turn_the_joint_back() -> None:
    """Coulomb friction ends a motion: it never begins one."""
    robot = {"coulomb_friction": 50.0, "armature": 0.0}
    lane = {"law": "smc", "k1": 0.0, "k2": 0.0, "lambda_": 0.01}
    document = {
        "robot": robot,
        "lanes": {"A": lane},
        "trajectory": {"kind": "hold"},
        "simulation": {"mode": "sampled", "horizon": 0.3, "plant_substeps": 1},
    }
    v = simulate(Experiment.from_document(document)).lanes["A"].v
    assert np.abs(np.diff(np.sign(v[:, 5]))).sum() <= 2.0


def test_angles_move_by_the_velocity_at_the_end() -> None:
    step = Drawn(3, "tanh", "constant")
    moved = step.before[Q] + step.h * step.work[FULL + V]
    np.testing.assert_array_equal(step.work[FULL + Q], moved)


def test_a_pulse_that_begins_within_a_step_does_not_show_before_it() -> None:
    """A joint that slides is held until the pulse comes, and the record says by what."""
    lane = {"law": "smc", "k1": 0.0, "k2": 60.0, "lambda_": 5.0, "switching": "sign"}
    document = {
        "robot": {"armature": 2.0, "inertials": "datasheet"},
        "lanes": {"A": {**lane, "reaching": "constant"}},
        "trajectory": {"kind": "hold"},
        "disturbance": {"pulse": {"amplitude": 190.0, "start": 0.1004, "duration": 0.0503}},
        "simulation": {"horizon": 0.3},
    }
    found = simulate(Experiment.from_document(document)).lanes["A"]
    before = found.tau[60:101] - found.tau[60]
    assert np.abs(before).max() < 1e-3
    assert np.abs(found.S[101]).min() > 1e-4
    # Each joint is driven away by what k2 can't hold, from the start of the pulse on.
    fine = simulate(
        Experiment.from_document({**document, "simulation": {"horizon": 0.3, "step": 5e-5}})
    ).lanes["A"]
    np.testing.assert_allclose(found.v[110], fine.v[2200], rtol=1e-4)


@pytest.mark.parametrize("reaching", REACHINGS)
@pytest.mark.parametrize("switching", SWITCHINGS)
def test_a_shaped_law_has_the_slope_of_the_surface_at_the_end(
    switching: str, reaching: str
) -> None:
    compared = 0
    for seed in range(60):
        step = Drawn(seed, switching, reaching, shaped=True)
        work, h, nu = step.before.copy(), 0.01 * step.h, step.before[S_E]
        c, mu, ratio = np.array([[0.1], [3.0], [5.0 / 3.0]]) * np.ones(JOINTS)
        work[BENDS, 0], work[TERMINAL_C : TERMINAL_RATIO + 1] = 1.0, (c, mu, ratio)

        def slope(de: Array) -> Array:
            return c + ratio * mu * np.abs(de) ** (ratio - 1.0)  # noqa: B023

        de = work[VD] - work[V]
        work[S_V] = slope(de)
        work[SHAPE : SHAPE + JOINTS] = share = 0.9 * step.M / work[S_V]
        # The equivalent control is behind the same inertia.
        work[TAU] = step.rest + share @ (work[REACH] + nu * de)
        before = work.copy()
        left = implicit_step(h, CURRENT, FULL, step.M, step.bias, step.environment, work)
        if left > SOLVED or work[HELD, 0]:
            continue
        compared += 1
        a = (work[FULL + V] - work[V]) / h
        after = de + h * (work[AD] - a)
        s = before[S] + h * (before[S_V] * (work[AD] - a) + nu * (work[VD] - work[FULL + V]))
        at = np.zeros((WORK_ROWS, JOINTS))
        at[S] = s
        reach(step.gains.pack_reaching(), at)
        asked = step.rest + 0.9 * step.M @ ((at[REACH] + nu * after) / slope(after))
        v = work[FULL + V]
        lost = 2.0 * v + step.coulomb * np.tanh(v / COULOMB_WIDTH)
        needed = step.M @ a + step.bias + lost
        room = 1e-5 * (1.0 + np.abs(needed).max()) + 10.0 * SOLVED * np.diag(step.M).max() / h
        assert np.abs(needed - asked).max() <= room, seed
    assert compared > 30
