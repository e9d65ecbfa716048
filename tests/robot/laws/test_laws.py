"""The registry of laws, and what their gains do."""

from __future__ import annotations

from functools import reduce
from operator import or_
from typing import Annotated, Any, Literal

import numpy as np
import pytest
from pydantic import Field

from slidetune.robot.experiment.document import Experiment, LaneName
from slidetune.robot.experiment.merge_patch import merge_patch
from slidetune.robot.experiment.packed import pack
from slidetune.robot.fields.quantity import JOINTS, PerJoint, Section, field
from slidetune.robot.integrator.stages import sample
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import (
    GAIN,
    REACH,
    S_E,
    S_V,
    SHAPE,
    SHAPED,
    TAU,
    WORK_ROWS,
    Q,
    S,
    V,
    W,
)
from slidetune.robot.laws import LAWS
from slidetune.robot.laws.law import Law
from slidetune.robot.laws.terms.network import no_network
from slidetune.robot.laws.terms.surface import LinearSurface, linear_surface
from slidetune.robot.loop.simulate import LaneRun, simulate
from slidetune.robot.margins.margin import sampling_margin
from tests.robot.kernel_tables import arm_of, table_of

Array = np.ndarray
COLUMNS = ("q", "v", "tau", "S", "f", "weights")

# Gains at which every other one has something to act on.
BASE: dict[str, Any] = {
    "nu": 2.0,
    "c": 3.0,
    "mu": 0.5,
    "p": 9.0,
    "k": 7.0,
    "k1": 20.0,
    "k2": 15.0,
    "epsilon": 0.5,
    "alpha": 0.5,
    "lambda_": 4.0,
    "width": 0.5,
    "learning_rate": 30.0,
    "leakage": 0.5,
    "center_span": 1.0,
    "network_input": "error",
    "switching": "tanh",
    "reaching": "exponential",
    "inertia_shaped": False,
    "kp": 100.0,
    "kd": 20.0,
    "z_max": 0.5,
    "k2_min": 10.0,
    "adaptation_rate": 1000.0,
    "observer": "none",
    "observer_rate": 30.0,
}
CHANGED: dict[str, Any] = {
    "p": 11.0,
    "k": 5.0,
    "network_input": "angle",
    "switching": "saturation",
    "reaching": "power",
    "inertia_shaped": True,
    "observer": "momentum",
}
NEEDED = {"alpha": {"reaching": "power"}, "observer_rate": {"observer": "momentum"}}
# An adapted gain only grows, and comes to its bound, where S is outside of the layer.
GROWING = {"k2", "adaptation_rate"}
GAINS = [(law, name) for law in LAWS for name in LAWS[law].lane.model_fields if name != "law"]
PER_JOINT = [
    (law, name)
    for law, name in GAINS
    if LAWS[law].lane.model_fields[name].annotation is not float and isinstance(BASE[name], float)
]


def document(lane: dict[str, Any], mode: str = "continuous") -> dict[str, Any]:
    return {
        "robot": {"armature": 0.2},
        "lanes": {"A": lane},
        "disturbance": {"constant": 2.0, "nominal_mismatch": 0.8},
        "simulation": {
            "mode": mode,
            "horizon": 0.1,
            "step": 0.005,
            "control_rate": 500.0,
            "plant_substeps": 2,
            "initial_error": 0.1,
        },
    }


def gains_of(law: str, **changes: Any) -> dict[str, Any]:
    known = LAWS[law].lane.model_fields
    return {"law": law, **{name: BASE[name] for name in known if name != "law"}, **changes}


def run(lane: dict[str, Any], mode: str = "continuous") -> LaneRun:
    return simulate(Experiment.from_document(document(lane, mode))).lanes["A"]


def same(one: LaneRun, other: LaneRun) -> bool:
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in COLUMNS)


def test_registry_is_by_name_and_each_lane_knows_its_law() -> None:
    assert list(LAWS) == [
        "rbfnn_nftsm",
        "rbfnn_smc",
        "nftsm",
        "smc",
        "super_twisting",
        "integral_smc",
        "adaptive_smc",
        "computed_torque",
    ]
    for name, law in LAWS.items():
        assert law.name == name == law.lane().law
        assert law.title
        assert law.summary.startswith("τ = ")


def test_flags_of_a_law_say_what_it_does() -> None:
    for name, law in LAWS.items():
        exact = run(gains_of(name))
        nominal = document(gains_of(name))
        nominal["disturbance"]["nominal_mismatch"] = 1.0
        other = simulate(Experiment.from_document(nominal)).lanes["A"]
        assert same(exact, other) != law.model_based
        assert exact.weights.any() == law.network


@pytest.mark.parametrize("mode", ["continuous", "sampled"])
@pytest.mark.parametrize(("law", "name"), GAINS)
def test_every_gain_has_an_effect(law: str, name: str, mode: str) -> None:
    base = gains_of(law, **NEEDED.get(name, {}))
    if law == "adaptive_smc" and name in GROWING:
        base["epsilon"] = 0.1
    value = CHANGED.get(name, base[name] * 1.3 if isinstance(base[name], float) else None)
    assert not same(run(base, mode), run({**base, name: value}, mode))


@pytest.mark.parametrize(("law", "name"), PER_JOINT)
def test_a_gain_of_one_joint_stands_in_that_joint_s_column(law: str, name: str) -> None:
    base = gains_of(law)
    numbers = LAWS[law].lane.model_validate(base).pack()
    for joint in range(JOINTS):
        values = [BASE[name]] * JOINTS
        values[joint] = CHANGED.get(name, 1.3 * BASE[name])
        changed = LAWS[law].lane.model_validate({**base, name: values}).pack()
        assert np.flatnonzero((changed != numbers).any(axis=0)).tolist() == [joint]


@pytest.mark.parametrize("law", ["rbfnn_nftsm", "rbfnn_smc", "nftsm", "smc"])
@pytest.mark.parametrize("name", ["k1", "k2", "epsilon"])
def test_a_reaching_gain_of_one_joint_changes_that_joint_s_first_torque(
    law: str, name: str
) -> None:
    first = run(gains_of(law)).tau[0]
    for joint in range(JOINTS):
        values = [BASE[name]] * JOINTS
        values[joint] *= 1.5
        differs = run(gains_of(law, **{name: values})).tau[0] != first
        assert np.flatnonzero(differs).tolist() == [joint]


@pytest.mark.parametrize("mode", ["continuous", "sampled"])
@pytest.mark.parametrize("law", LAWS)
def test_six_equal_gains_are_one(law: str, mode: str) -> None:
    one = gains_of(law)
    per_joint = {name for kind, name in PER_JOINT if kind == law}
    six = {name: [value] * JOINTS if name in per_joint else value for name, value in one.items()}
    assert same(run(one, mode), run(six, mode))


@pytest.mark.parametrize("law", [name for name, law in LAWS.items() if law.network])
def test_published_width_hides_what_the_network_looks_at(law: str) -> None:
    wide = run(gains_of(law, width=10.0))
    for source in ("angle", "desired"):
        other = run(gains_of(law, width=10.0, network_input=source))
        assert np.abs(wide.q - other.q).max() < 1e-3


def evaluated(lane: dict[str, Any], q: Array, v: Array) -> Array:
    """Return the workspace as a law leaves it at a state of an arm of our choice."""
    root = np.random.default_rng(8).normal(size=(JOINTS, JOINTS))
    arm = arm_of(root @ root.T + np.eye(JOINTS), np.ones(JOINTS))
    work = np.zeros((WORK_ROWS, JOINTS))
    work[Q], work[V] = q, v
    work[W + 1] = float(LAWS[lane["law"]].memory > 1)  # an integral that has begun
    gains = LAWS[lane["law"]].lane.model_validate(lane).pack()
    table = table_of(work, arm=arm, gains=gains, control=LAWS[lane["law"]].control)
    assert sample(0.0, 0, 0, table) == 0
    return work


@pytest.mark.parametrize("law", [*LAWS, "shaped"])
def test_a_law_hands_the_implicit_step_the_slopes_of_its_feedback(law: str) -> None:
    # Any other ones keep the order of the scheme, and lose what it is for: stiff gains.
    lane = gains_of("nftsm", inertia_shaped=True) if law == "shaped" else gains_of(law)
    lane |= {"mu": 0.0} if "mu" in lane else {}
    silent = {**lane, "k1": 0.0, "k2": 0.0} if "k1" in lane else None
    if silent is not None and "k2_min" in silent:
        silent["k2_min"] = 0.0
    q, v = np.random.default_rng(9).normal(size=(2, JOINTS)) / 5.0

    def feedback(q: Array, v: Array) -> Array:
        torque = evaluated(lane, q, v)[TAU]
        return torque if silent is None else torque - evaluated(silent, q, v)[TAU]

    work = evaluated(lane, q, v)
    share = work[SHAPE : SHAPE + JOINTS] if work[SHAPED, 0] else np.eye(JOINTS)
    for joint, ahead in enumerate(1e-6 * np.eye(JOINTS)):
        over_q = (feedback(q + ahead, v) - feedback(q - ahead, v)) / 2e-6
        over_v = (feedback(q, v + ahead) - feedback(q, v - ahead)) / 2e-6
        column = share[:, joint] * work[GAIN, joint]
        np.testing.assert_allclose(over_q, -column * work[S_E, joint], rtol=1e-5, atol=1e-5)
        np.testing.assert_allclose(over_v, -column * work[S_V, joint], rtol=1e-5, atol=1e-5)


def test_alpha_is_ignored_by_the_other_reaching_laws() -> None:
    for reaching in ("exponential", "constant"):
        lane = gains_of("smc", reaching=reaching)
        assert same(run(lane), run({**lane, "alpha": 0.9}))


def test_a_network_that_does_not_learn_stays_silent() -> None:
    lazy = run(gains_of("rbfnn_smc", learning_rate=0.0))
    assert not lazy.f.any()
    assert not lazy.weights.any()


# --- one more law: a file and a line in the registry ---------------------------------------------


class Toy(LinearSurface):
    """Gains of a plain proportional-derivative law."""

    law: Literal["toy"] = "toy"
    gain: PerJoint = field(
        40.0, title="Gain", unit="N·m·s/rad", low=0.0, high=500.0, step=1.0, meaning="Feedback."
    )

    def pack(self, joints: int = JOINTS) -> Array:
        """Return lambda and the gain. Shape (2, n)."""
        return np.vstack([self.pack_surface(joints), np.full((1, joints), self.gain)])


@kernel
def toy_control(_state, gains, _M, _nle, work):  # type: ignore[no-untyped-def]
    """τ = g (de + λ e)."""
    linear_surface(gains[:1], work)
    no_network(work)
    work[SHAPED, 0] = 0.0
    for j in range(JOINTS):
        work[GAIN, j] = gains[1, j]
        work[REACH, j] = gains[1, j] * work[S, j]
        work[TAU, j] = work[REACH, j]


TOY = Law("toy", "Toy", "τ = g(de + λe)", Toy, toy_control, False, False)


@pytest.fixture
def wider(monkeypatch: pytest.MonkeyPatch) -> type[Experiment]:
    """Return the document as it would be with one more line in the registry."""
    monkeypatch.setitem(LAWS, "toy", TOY)
    lane = Annotated[reduce(or_, [law.lane for law in LAWS.values()]), Field(discriminator="law")]

    class Wider(Experiment):
        lanes: dict[LaneName, lane]  # type: ignore[valid-type]

    return Wider


@pytest.mark.parametrize("mode", ["continuous", "sampled"])
def test_a_further_law_runs_beside_the_others(wider: type[Experiment], mode: str) -> None:
    lanes = {"toy": {"law": "toy", "lambda_": 4.0, "gain": 40.0}}
    # The same law in the words of another one.
    lanes["twin"] = {"law": "rbfnn_smc", "lambda_": 4.0, "k1": 40.0, "k2": 0.0, "learning_rate": 0}
    experiment = wider.from_document({**document({}, mode), "lanes": lanes})
    result = simulate(experiment)
    np.testing.assert_allclose(result.lanes["toy"].q, result.lanes["twin"].q, atol=1e-12)
    packed = pack(experiment)
    margins = [sampling_margin(packed, name, np.ones(JOINTS)) for name in lanes]
    assert margins[0] == pytest.approx(margins[1])


def test_a_further_law_takes_part_in_patches(wider: type[Experiment]) -> None:
    before = wider.from_document({"lanes": {"A": {"law": "smc", "lambda_": 7.0}}})
    after = merge_patch(before.document(), {"lanes": {"A": {"law": "toy"}}})
    assert wider.from_document(after).lanes["A"] == Toy(lambda_=7.0)


def test_a_further_law_describes_its_gains_in_the_schema(wider: type[Experiment]) -> None:
    gain: Section | dict[str, Any] = wider.model_json_schema()["$defs"]["Toy"]["properties"]["gain"]
    assert (gain["title"], gain["unit"], gain["maximum"]) == ("Gain", "N·m·s/rad", 500.0)
