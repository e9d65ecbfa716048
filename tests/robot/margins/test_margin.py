"""The spectral radius of one control period, against what the sampled loop really does."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.advice.advice import advice_on
from slidetune.robot.advice.sufficient import sufficient_layer, sufficient_rate
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.loop.simulate import LaneRun, simulate
from slidetune.robot.margins.margin import (
    MARGINAL,
    is_stable,
    loop_margin,
    period_map,
    worst_margin,
)
from slidetune.robot.margins.period_map import Around, calm
from slidetune.robot.margins.timing import Timing

Array = np.ndarray
LAWS = ("rbfnn_nftsm", "rbfnn_smc", "nftsm", "smc", "computed_torque")
"""Laws to draw from: those without a memory of their own."""
SMALL = 1e-8
"""Angle [rad] by which a loop is moved aside: far within every layer."""
LANES: dict[str, dict[str, Any]] = {
    "rbfnn_nftsm": {"nu": 10.0, "c": 1.0, "mu": 0.0, "k2": 0.0, "learning_rate": 1.0},
    "rbfnn_smc": {"lambda_": 10.0, "k2": 0.0, "learning_rate": 1.0},
    "nftsm": {"nu": 10.0, "c": 1.0, "mu": 0.0, "k2": 0.0},
    "shaped": {"law": "nftsm", "inertia_shaped": True, "nu": 10.0, "c": 1.0, "mu": 0.0, "k2": 0.0},
    "smc": {"lambda_": 10.0, "k2": 0.0},
    "computed_torque": {"kp": 400.0},
}
GAIN = {"computed_torque": "kd"}


def sampled(
    lane: dict[str, Any],
    rate: float = 200.0,
    drive: dict[str, Any] | None = None,
    **simulation: Any,
) -> Experiment:
    """A lane that holds a pose, a hair's breadth aside."""
    robot = {"inertials": "datasheet", "armature": [0.6, 0.6, 0.6, 0.15, 0.15, 0.15]}
    document = {
        "robot": {**robot, **(drive or {})},
        "lanes": {"A": {"law": "smc", **lane}},
        # Hanging down: nothing has to be learnt before it is held.
        "trajectory": {"kind": "hold", "position": [0.0, -0.5 * np.pi, 0.0, 0.0, 0.0, 0.0]},
        "simulation": {
            "mode": "sampled",
            "control_rate": rate,
            "initial_error": SMALL,
            "horizon": 400.0 / rate,
            **simulation,
        },
    }
    return Experiment.from_document(document)


def moved(run: LaneRun, load: LaneRun) -> Array:
    """Return how far a run is from the one that begins on its pose. Shape (n,)."""
    apart = np.abs(run.q - load.q).max(axis=1)
    return np.where(np.isfinite(apart), apart, np.inf)


def growth(experiment: Experiment) -> float:
    """Return by how much a small deviation grows from period to period, at last."""
    on = experiment.patched({"simulation": {"initial_error": 0.0}})
    run, still = (simulate(one, estimate=False).lanes["A"] for one in (experiment, on))
    apart = moved(run, still)
    rows = len(apart)
    # Over as many periods as lie before rounding or the nonlinear is reached.
    usable = np.flatnonzero((apart > 1e-13) & (apart < 1e-3))
    last = usable[-1] if len(usable) else rows - 1
    first = last // 2
    high = apart[first : (first + last) // 2].max()
    higher = apart[(first + last) // 2 : last + 1].max()
    return float((higher / high) ** (2.0 / max(last - first, 1)))


def said_and_seen_agree(law: str, low: float = 8.0, **simulation: Any) -> bool:
    """Find the gain at which the radius passes 1, and tell whether loops begin to grow there.

    Growth passes 1 once between the two ends: it does so within 2 % of the gain that is said if it
    has not yet done so 2 % below, and has 2 % above.
    """
    lane = {"law": law, **LANES[law]}
    key = GAIN.get(lane["law"], "k1")
    high = 400.0 if key == "kd" else 1000.0

    def with_gain(gain: float) -> Experiment:
        return sampled({**lane, key: gain}, **simulation)

    # Gains that are too weak grow as well, slowly: a bisection from there would find nothing.
    for find in (radius, growth):
        assert find(with_gain(low)) <= 1.0
        assert find(with_gain(high)) > 1.0
    while high / low > 1.003:
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if radius(with_gain(middle)) > 1.0 else (middle, high)
    return growth(with_gain(0.98 * low)) <= 1.0 < growth(with_gain(1.02 * low))


def radius(experiment: Experiment) -> float:
    """Return the spectral radius, a hair lower: what stands at 1 is not to count."""
    found = period_map(pack(experiment), "A", 0.0).radius()
    return found - MARGINAL


@pytest.mark.parametrize("substeps", [1, 10])
@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0, 1.63, 3.0])
@pytest.mark.parametrize("law", LANES)
def test_the_border_is_where_the_sampled_loop_begins_to_diverge(
    law: str, delay: float, substeps: int
) -> None:
    if substeps == 1 and law not in ("smc", "rbfnn_nftsm"):
        pytest.skip("other laws with ten steps of the arm")
    # Without a delay the border of computed torque lies beyond its field at 200 Hz.
    rate = 100.0 if law == "computed_torque" and delay < 1.0 else 200.0
    simulation = {"rate": rate, "input_delay": delay / rate, "plant_substeps": substeps}
    assert said_and_seen_agree(law, **simulation)


@pytest.mark.parametrize("delay", [0.0, 0.4, 1.63])
@pytest.mark.parametrize("order", ["first", "second"])
@pytest.mark.parametrize("lag", [0.0005, 0.004, [0.002, 0.003, 0.004, 0.005, 0.01, 0.0]])
@pytest.mark.parametrize("law", ["smc", "rbfnn_nftsm"])
def test_the_border_knows_the_lag_of_the_drives(
    law: str, lag: Any, order: str, delay: float
) -> None:
    rate = 200.0
    drive = {"lag": lag, "lag_order": order}
    # A lag remembers: what is no longer there at last takes longer to leave.
    simulation = {"rate": rate, "input_delay": delay / rate, "horizon": 1600.0 / rate}
    assert said_and_seen_agree(law, 6.0, drive=drive, **simulation)


FREEZES = [
    ({"law": "smc", "lambda_": 100.0, "k1": 5.0, "k2": 0.0}, 50.0),
    ({"law": "nftsm", "nu": 100.0, "c": 1.0, "mu": 0.0, "k1": 1.0, "k2": 0.0}, 50.0),
    ({"law": "computed_torque", "kp": 5000.0, "kd": 20.0}, 100.0),
    ({"law": "rbfnn_nftsm", "nu": 100.0, "c": 0.4, "mu": 0.0, "k1": 60.0, "k2": 0.0}, 100.0),
]


@pytest.mark.parametrize(("lane", "rate"), FREEZES)
def test_what_gamma_does_not_see_is_told(lane: dict[str, Any], rate: float) -> None:
    document = {
        "robot": {"armature": 0.3},
        "lanes": {"A": lane},
        "trajectory": {"kind": "hold"},
        "simulation": {"mode": "sampled", "control_rate": rate, "initial_error": 0.01},
    }
    experiment = Experiment.from_document(document)
    packed = pack(experiment)
    margin = loop_margin(packed, "A")
    assert worst_margin(packed, "A") < 1.0
    assert margin.radius is not None
    assert margin.radius > 1.01
    assert not margin.bounded
    freeze = simulate(experiment, estimate=False).lanes["A"].freeze
    assert freeze is not None
    # Sampling is blamed where it is to blame: the last one would not be stable without it.
    sampling = lane["law"] != "rbfnn_nftsm"
    assert ("ρ =" in freeze.cause) == sampling
    assert freeze.radius == (pytest.approx(margin.radius, rel=1e-3) if sampling else None)


def drawn(seed: int) -> Experiment:
    """Draw a sampled lane with a layer somewhere about its border."""
    random = np.random.default_rng(seed)
    law = LAWS[seed % len(LAWS)]

    def log(low: float, high: float) -> float:
        return float(np.exp(random.uniform(np.log(low), np.log(high))))

    lane: dict[str, Any] = {"law": law}
    if law == "computed_torque":
        lane |= {"kp": log(1.0, 10000.0), "kd": log(0.5, 400.0)}
    else:
        lane |= {"k1": log(0.1, 300.0), "k2": log(0.1, 300.0), "epsilon": log(0.003, 10.0)}
        lane |= {"switching": random.choice(["tanh", "saturation"]).item()}
        lane |= {"reaching": random.choice(["exponential", "constant"]).item()}
    if "nftsm" in law:
        lane |= {"nu": log(0.1, 100.0), "c": log(0.1, 10.0), "mu": log(0.01, 1.0)}
    if law.endswith("smc"):
        lane |= {"lambda_": log(0.1, 100.0)}
    if law.startswith("rbfnn"):
        lane |= {"learning_rate": log(1.0, 1000.0), "width": log(0.3, 30.0)}
        lane |= {"leakage": random.choice([0.0, 2.0]).item()}
    rate = log(61.0, 2000.0)
    delay = float(random.choice([0.0, 0.5, 1.0, 2.0, 3.0])) / rate
    lag = float(random.choice([0.0, 0.0, log(0.0005, 0.01)]))
    return sampled(
        lane,
        rate,
        drive={"lag": lag, "lag_order": random.choice(["first", "second"]).item()},
        input_delay=delay,
        plant_substeps=4,
        initial_error=1e-7,
    )


def settles(experiment: Experiment) -> bool | None:
    """Tell whether a small deviation is no greater at the end than it was on the way.

    ``None`` where the loop itself leaves its layer before it has learnt to hold the arm.
    """
    on = experiment.patched({"simulation": {"initial_error": 0.0}})
    run, still = (simulate(one, estimate=False).lanes["A"] for one in (experiment, on))
    if np.nanmax(np.abs(still.S)) > 0.2 * np.min(still.layer) > 0.0:
        return None
    apart = moved(run, still)
    return bool(apart[-len(apart) // 4 :].max() <= 1.5 * apart[: len(apart) // 2].max() + 1e-12)


@pytest.mark.parametrize("part", range(10))
def test_no_loop_is_falsely_called_stable(part: int) -> None:
    stable = 0
    for seed in range(20 * part, 20 * part + 20):
        experiment = drawn(seed)
        if not is_stable(pack(experiment), "A"):
            continue
        settled = settles(experiment)
        stable += settled is not None
        assert settled is not False, (seed, experiment.lanes)
    assert stable > 1


def offers(law: str) -> list[tuple[Packed, Packed]]:
    """Return loops that are not stable, and what they become with what is offered."""
    found = []
    for seed in range(100 if law == "computed_torque" else 25):
        experiment = drawn(1000 + 5 * seed + LAWS.index(law))
        packed = pack(experiment)
        if is_stable(packed, "A"):
            continue
        layer = sufficient_layer(packed, "A") if law != "computed_torque" else None
        if layer is not None:
            found.append((packed, pack(experiment.patched({"lanes": {"A": {"epsilon": layer}}}))))
        rate = sufficient_rate(packed, "A")
        if rate is not None and rate < 5000.0:
            patch = {"simulation": {"control_rate": rate, "horizon": max(400.0 / rate, 0.1)}}
            found.append((packed, pack(experiment.patched(patch))))
    return found


@pytest.mark.parametrize("law", LAWS)
def test_what_is_offered_holds(law: str) -> None:
    found = offers(law)
    assert len(found) >= (3 if law != "computed_torque" else 1)
    for before, after in found:
        assert not is_stable(before, "A")
        assert is_stable(after, "A")
        assert settles(after.experiment) is not False, after.experiment.lanes


@pytest.mark.parametrize("switching", ["tanh", "saturation"])
@pytest.mark.parametrize("law", ["smc", "rbfnn_nftsm"])
def test_a_layer_that_is_too_thin_ends_in_a_limit_cycle(law: str, switching: str) -> None:
    lane = {"law": law, "k1": 5.0, "k2": 10.0, "epsilon": 0.005, "switching": switching}
    if law == "smc":
        lane["lambda_"] = 5.0
    else:
        lane |= {"nu": 5.0, "c": 1.0, "mu": 0.1, "learning_rate": 5.0}
    experiment = sampled(lane, horizon=4.0)
    margin = loop_margin(pack(experiment), "A")
    assert not margin.stable
    assert margin.bounded
    run = simulate(experiment, estimate=False).lanes["A"]
    assert run.freeze is None
    assert np.abs(run.S[-100:]).max() > 0.005
    assert np.abs(run.q - run.q[0]).max() < 0.2


def test_sign_and_power_have_no_gamma() -> None:
    for change in ({"switching": "sign"}, {"reaching": "power"}):
        margin = loop_margin(pack(sampled({"k1": 5.0, "k2": 1.0, **change})), "A")
        assert (margin.gamma, margin.limit) == (None, None)
        assert margin.bounded
        assert (margin.radius is None) == ("switching" in change)


@pytest.mark.parametrize("shaped", [False, True])
@pytest.mark.parametrize(("k1", "k2"), [(5.0, 1.0), (80.0, [0.05, 300.0, 2.0, 9.0, 0.3, 40.0])])
def test_gamma_of_the_implicit_sign_is_one_whatever_the_gains(
    shaped: bool, k1: float, k2: Any
) -> None:
    lane = {"law": "nftsm", "nu": 0.1, "c": 1.0, "mu": 0.0, "inertia_shaped": shaped}
    lane |= {"k1": k1, "k2": k2, "switching": "implicit"}
    margin = loop_margin(pack(sampled(lane, 1000.0)), "A")
    assert margin.gamma == pytest.approx(1.0, rel=1e-4)
    assert margin.limit == pytest.approx(2.0, rel=2e-3)
    assert margin.stable
    late = loop_margin(pack(sampled(lane, 1000.0, input_delay=1e-3)), "A")
    assert late.limit == pytest.approx(1.0, rel=2e-3)


def test_a_joint_without_switching_gain_keeps_its_proportional_share_of_the_implicit_law() -> None:
    lane = {"law": "nftsm", "nu": 0.1, "c": 1.0, "mu": 0.0, "inertia_shaped": True, "k1": 250.0}
    margin = loop_margin(pack(sampled({**lane, "k2": 0.0, "switching": "implicit"}, 1000.0)), "A")
    # k1 S at the end of the period: T k1 / (1 + T k1).
    assert margin.gamma == pytest.approx(0.2, rel=1e-6)


def test_the_border_of_a_mere_damper_is_two() -> None:
    margin = loop_margin(pack(sampled({"k1": 5.0, "k2": 0.0, "lambda_": 0.01})), "A")
    assert margin.limit == pytest.approx(2.0, rel=2e-3)
    assert margin.stable


def test_a_surface_that_turns_fast_lowers_the_border() -> None:
    # γ + Tλ = 2 is where the conventional surface leaves its border.
    for turning in (20.0, 60.0):
        packed = pack(sampled({"k1": 5.0, "k2": 0.0, "lambda_": turning}))
        margin = loop_margin(packed, "A")
        assert margin.limit == pytest.approx(2.0 - turning / 200.0, rel=0.05)


def test_an_angle_that_nothing_pulls_back_is_no_instability() -> None:
    margin = loop_margin(pack(sampled({"law": "computed_torque", "kp": 0.0, "kd": 10.0})), "A")
    assert margin.radius == pytest.approx(1.0, abs=MARGINAL)
    assert margin.stable


@pytest.mark.parametrize("substeps", [1, 10])
@pytest.mark.parametrize("periods", [12.0, 20.3, 40.0])
def test_a_long_delay_in_longer_periods_has_the_same_border(periods: float, substeps: int) -> None:
    simulation = {"input_delay": periods / 1000.0, "plant_substeps": substeps}
    packed = calm(pack(sampled({"k1": 0.5, "k2": 0.0}, 1000.0, **simulation)))
    whole, part = packed.experiment.simulation.delay
    exact = Timing(1e-3 / substeps, substeps, whole * substeps + part)
    wide, narrow = (Around(packed, "A", 0.0, cut).map() for cut in (exact, None))
    low, high = 0.01, 100.0
    assert wide.stable(low)
    assert not wide.stable(high)
    while high / low > 1.0005:
        middle = float(np.sqrt(low * high))
        low, high = (middle, high) if narrow.stable(middle) else (low, middle)
    assert wide.stable(0.995 * low)
    assert not wide.stable(1.005 * low)


@pytest.mark.parametrize("rate", [100.0, 1000.0])
@pytest.mark.parametrize("kind", ["sine", "quintic", "circle"])
def test_an_angle_that_nothing_pulls_back_is_none_in_motion_either(kind: str, rate: float) -> None:
    for lane in ({"law": "computed_torque", "kp": 0.0, "kd": 20.0}, {"k1": 0.0, "k2": 0.0}):
        document = sampled(lane, rate, horizon=10.0).document()
        experiment = Experiment.from_document({**document, "trajectory": {"kind": kind}})
        assert is_stable(pack(experiment), "A")


def test_gains_too_weak_for_gravity_are_told_to_be_higher() -> None:
    # Upright, the arm is a pendulum that falls by itself, whatever the control rate.
    lane = {"law": "nftsm", "nu": 1.0, "c": 1.0, "mu": 0.0, "k2": 0.0}
    upright = {"trajectory": {"kind": "hold", "position": [0.0, 0.5 * np.pi, 0.0, 0.0, 0.0, 0.0]}}
    unknown = {"disturbance": {"nominal_mismatch": 0.3}}
    experiment = sampled({**lane, "k1": 20.0}, 1000.0).patched({**upright, **unknown})
    packed = pack(experiment)
    margin = loop_margin(packed, "A")
    assert not margin.stable
    assert margin.gamma is not None
    assert margin.limit is not None
    assert margin.limit > margin.gamma
    (note,) = (note for note in advice_on(packed, "A") if note.path == "simulation.control_rate")
    factor = float(note.message.split("reaching gains ")[-1].split()[0])
    assert "times higher" in note.message
    for share, stable in ((1.0, True), (0.95, False)):
        stronger = experiment.patched({"lanes": {"A": {"k1": 20.0 * factor * share}}})
        assert is_stable(pack(stronger), "A") == stable


def test_the_border_of_the_gains_counts_all_along_the_motion() -> None:
    told = 0
    for seed in range(60):
        swung = drawn(3000 + seed).patched({"trajectory": {"kind": "sine"}})
        gains = swung.lanes["A"]
        margin = loop_margin(pack(swung), "A")
        if gains.law == "computed_torque" or margin.stable or not margin.limit:
            continue
        assert margin.gamma is not None
        # A hair on the stable side of it; what is not stable as it is may lie below or above it.
        share = margin.limit / margin.gamma
        share *= 1.01 if share > 1.0 else 0.99
        scaled = gains.model_copy(update={"k1": share * gains.k1, "k2": share * gains.k2})
        assert is_stable(pack(swung.model_copy(update={"lanes": {"A": scaled}})), "A"), seed
        told += 1
    assert told > 5
