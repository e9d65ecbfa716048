"""What is wrong with these numbers, before running them: margins, time constants, torques."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from slidetune.robot.advice.sampled_arm import sampled_arm
from slidetune.robot.advice.sufficient import sufficient_layer, sufficient_rate
from slidetune.robot.advice.torque_need import initial_torque, required_torque, start
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.experiment.simulation import MAX_STEPS, Simulation
from slidetune.robot.fields.field_path import field_path
from slidetune.robot.fields.quantity import JOINTS, bounds
from slidetune.robot.kernels.workspace import LEAKAGE, NETWORK_SLOPE, TAU, S
from slidetune.robot.laws.terms.network import NetworkGains
from slidetune.robot.margins.margin import Margin, is_stable, loop_margin

Array = np.ndarray

_LEFT = 0.1
"""Sliding variable in [rad/s] by which wind-up is told where the start leaves none (*ours*)."""
_RESERVE = 1.2
"""Torque limit that is proposed, as a multiple of what the motion takes (*ours*)."""
_NARROW = 0.35
"""Width of a Gaussian over the spacing of their centres, below which there are gaps (*ours*)."""
_STEPS_A_SWING = 10
"""Steps that show the course of a swing (*ours*)."""
_DECAYS = 3.0
"""Time constants within the horizon that is proposed: 5 % of the error are left (*ours*)."""


@dataclass(frozen=True)
class Advice:
    """One piece of advice on a lane's numbers.

    Attributes:
        level: ``warning`` where trouble is to be expected, ``info`` where something is surprising.
        path: the field it concerns, dotted from the experiment.
        message: the number, the rule and the way out.
        patch: a merge patch that sets the nearest good value, or ``None``.
        title: what to call the patch; empty where its values say it.
    """

    level: Literal["info", "warning"]
    path: str
    message: str
    patch: dict[str, Any] | None = None
    title: str = ""


def _sampling(packed: Packed, name: str) -> Iterator[Advice]:
    simulation, lane = packed.experiment.simulation, packed.experiment.lanes[name]
    if simulation.mode != "sampled":
        return
    margin = loop_margin(packed, name)
    if margin.holds:
        return
    rule = f"{_rule(margin, simulation.input_delay > 0.0)}: expect {_outcome(packed, margin)}. "
    if margin.radius is None:
        yield Advice("warning", "simulation.control_rate", f"{rule}Lower the other gains.")
        return
    rate = sufficient_rate(packed, name)
    layer = sufficient_layer(packed, name) if hasattr(lane, "epsilon") else None
    if layer is not None:
        wide = f"{_span(layer)} rad/s"
        instead = f", or a control rate of {rate:g} Hz" if rate is not None else ""
        steep = lane.reaching != "power" and np.all(np.divide(lane.k2, lane.epsilon) > lane.k1)
        whose = "k₂/ε dominates. Stable" if steep else "Stable"
        text = f"{rule}{whose} with ε = {wide}{instead}."
        path = field_path(("lanes", name, "epsilon"))
        yield Advice("warning", path, text, {"lanes": {name: {"epsilon": layer}}})
        return
    ways = [] if rate is None else [f"a control rate of {rate:g} Hz"]
    ways += _other_gains(margin, bool(np.any(getattr(lane, "learning_rate", 0.0))))
    ways += ["a shorter delay"] if simulation.input_delay else []
    fits = rate is not None and simulation.horizon * rate <= MAX_STEPS
    yield Advice(
        "warning",
        "simulation.control_rate",
        f"{rule}Stable with {' or '.join(ways)}.",
        {"simulation": {"control_rate": rate}} if fits else None,
    )


def _sampled_arm(packed: Packed, name: str) -> Iterator[Advice]:
    offer = sampled_arm(packed)
    if offer is not None and name in offer.lanes:
        yield Advice(
            "warning", "simulation.mode", offer.message, offer.patch, "Use the sampled arm"
        )


def _other_gains(margin: Margin, learns: bool) -> list[str]:
    """Say in words which other gains would make a loop stable."""
    if margin.gamma and margin.limit:
        factor = margin.limit / margin.gamma
        if factor > 1.0:
            return [f"reaching gains {_short(1.01 * factor)} times higher"]
        return [f"reaching gains {_short(1.01 / factor)} times lower"]
    return ["lower surface gains"] + (["a lower learning rate"] if learns else [])


def _outcome(packed: Packed, margin: Margin) -> str:
    """Say in words what an unstable loop comes to; the period map knows no torque limits."""
    if margin.bounded:
        return "a limit cycle"
    if packed.experiment.robot.torque_limit is None:
        return "divergence"
    return "a limit cycle within the torque limits, or divergence"


def _rule(margin: Margin, late: bool) -> str:
    """Say in words why a loop is not stable."""
    delay = " with this delay" if late else ""
    if margin.radius is None:
        return "Even without sign(S), this loop is unstable at this rate" + delay
    rule = f"Deviations grow by up to a factor ρ = {margin.radius:.5g} per sample"
    if margin.gamma is None or margin.limit is None:
        return rule
    gamma = _short(margin.gamma)
    if margin.limit == 0.0:
        return f"{rule}, whatever the reaching gains (γ = {gamma})"
    if margin.limit > margin.gamma:
        return f"{rule}: the reaching gains are too low (γ = {gamma}{delay})"
    return f"{rule} (γ = {gamma}, the limit of this loop{delay} is {_short(margin.limit)})"


def _short(value: float) -> str:
    """Return a number of three digits, without an exponent up to a million."""
    return f"{float(f'{value:.3g}'):g}"


def _span(values: float | list[float]) -> str:
    low, high = float(np.min(values)), float(np.max(values))
    return _short(low) if low == high else f"{_short(low)} to {_short(high)}"


def _sign(packed: Packed, name: str) -> Iterator[Advice]:
    simulation, lane = packed.experiment.simulation, packed.experiment.lanes[name]
    if simulation.mode != "sampled":
        return  # there sign holds S at zero
    if getattr(lane, "switching", "") != "sign" or lane.reaching == "power" or not np.any(lane.k2):
        return
    smooth = packed.experiment.patched({"lanes": {name: {"switching": "tanh"}}})
    change: dict[str, Any] = {"switching": "tanh"}
    other = pack(smooth)
    if not is_stable(other, name):
        layer = sufficient_layer(other, name)
        if layer is None:
            return
        change["epsilon"] = layer
    width = _span(change.get("epsilon", lane.epsilon))
    yield Advice(
        "info",
        field_path(("lanes", name, "switching")),
        f"sign(S) makes the torque jump by 2k₂ = {_short(2.0 * np.max(lane.k2))} N·m up to "
        f"{simulation.control_rate:g} times per second: it chatters. tanh with ε = {width} rad/s "
        "is smooth at this rate.",
        {"lanes": {name: change}},
    )


def _convergence(packed: Packed, name: str) -> Iterator[Advice]:
    lane, horizon = packed.experiment.lanes[name], packed.experiment.simulation.horizon
    wanted = _DECAYS / horizon
    decays = "On the surface the error's time constant is {}"
    if hasattr(lane, "nu"):
        field, symbol, unit, formula = "nu", "ν", "1/s", decays.format("c/ν")
        constant, nearest = np.max(np.divide(lane.c, lane.nu)), np.max(lane.c) * wanted
    elif hasattr(lane, "lambda_"):
        field, symbol, unit = "lambda_", "λ", "1/s"
        formula = decays.format("1/λ")
        constant, nearest = np.max(np.divide(1.0, lane.lambda_)), wanted
    elif np.all(np.multiply(lane.kd, horizon) > 4.0 * _DECAYS):
        field, symbol, unit, formula = (
            "kp",
            "k_p",
            "1/s²",
            "The error's time constant is about k_d/k_p",
        )
        constant = np.max(np.divide(lane.kd, np.maximum(lane.kp, 1e-9)))
        nearest = wanted * np.max(lane.kd)
    else:
        return
    if constant <= horizon:
        return
    value = min(float(f"{nearest:.2g}"), bounds(type(lane), field)[1])
    slow = f"{formula} = {_short(constant)} s, longer than the horizon of {horizon:g} s"
    yield Advice(
        "info",
        field_path(("lanes", name, field)),
        (f"{slow}: it hardly converges." if constant < 1e6 else "Nothing drives the error to zero.")
        + f" Try {symbol} = {value:g} {unit}.",
        {"lanes": {name: {field: value}}},
    )


def _limits(packed: Packed) -> Array:
    limit = packed.experiment.robot.torque_limit
    return np.broadcast_to(np.asarray(np.inf if limit is None else limit, dtype=float), JOINTS)


def _motion(packed: Packed, name: str) -> Iterator[Advice]:
    limit = _limits(packed)
    if not np.any(np.isfinite(limit)):
        return
    need = required_torque(packed)
    joint = int(np.argmax(need / limit))
    if need[joint] <= limit[joint]:
        return
    enough = np.maximum(limit, np.ceil(_RESERVE * need)).tolist()
    uniform = isinstance(packed.experiment.robot.torque_limit, float)
    higher = {"robot": {"torque_limit": max(enough) if uniform else enough}}
    yield Advice(
        "warning",
        "robot.torque_limit",
        f"The motion alone requires up to {_short(need[joint])} N·m at joint {joint + 1}, whose "
        f"limit is {_short(limit[joint])} N·m: no gains can track it. Raise the limit, or make the "
        "motion slower or smaller.",
        higher if max(enough) <= 5000.0 else None,
    )


def _start(packed: Packed, name: str) -> Iterator[Advice]:
    limit = _limits(packed)
    if not np.any(np.isfinite(limit)):
        return
    # A joint that the motion alone overtaxes is told of already.
    able = required_torque(packed) <= limit
    torque = np.where(able, np.abs(initial_torque(packed, name)), 0.0)
    joint = int(np.argmax(torque / limit))
    if torque[joint] <= limit[joint]:
        return
    yield Advice(
        "info",
        "robot.torque_limit",
        f"At the start joint {joint + 1} needs {_short(torque[joint])} N·m, but its limit is "
        f"{_short(limit[joint])} N·m: the loop starts in torque saturation. Start with the desired "
        "velocity and no error, or lower the gains.",
        _calmer_start(packed, name, able),
    )


def _calmer_start(packed: Packed, name: str, able: Array) -> dict[str, Any] | None:
    """Return the patch of the start that keeps within the torque limits, if one does."""
    for start_of in (
        {"initial_velocity": "desired"},
        {"initial_error": 0.0},
        {"initial_velocity": "desired", "initial_error": 0.0},
    ):
        patch = {"simulation": start_of}
        calmer = pack(packed.experiment.patched(patch))
        if np.all(~able | (np.abs(initial_torque(calmer, name)) <= _limits(packed))):
            return patch
    return None


def _blindness(packed: Packed, name: str) -> Iterator[Advice]:
    lane = packed.experiment.lanes[name]
    if isinstance(lane, NetworkGains) and np.min(lane.width) < _NARROW * lane.spacing:
        spacing = lane.spacing
        yield Advice(
            "info",
            field_path(("lanes", name, "width")),
            f"The Gaussians are narrower than the gaps between their centres ({_short(spacing)} "
            "rad): between two of them the network does not respond.",
            {"lanes": {name: {"width": float(f"{spacing:.2g}")}}},
        )


def _windup(packed: Packed, name: str) -> Iterator[Advice]:
    """Tell how fast the weights grow while a joint gives all it has and S can't vanish."""
    limit, work = _limits(packed), start(packed, name)
    learns = (work[NETWORK_SLOPE] > 0.0) & (work[LEAKAGE] == 0.0)
    if not np.any(learns & np.isfinite(limit)):
        return
    begins = learns & (np.abs(work[TAU]) > limit)
    lasting = learns & (required_torque(packed) > limit)
    if not np.any(begins | lasting):
        return
    sliding = np.where(begins, np.abs(work[S]), _LEFT)
    growth = np.where(begins | lasting, work[NETWORK_SLOPE] * sliding, 0.0)
    joint = int(np.argmax(growth))
    leakage = float(f"{np.max(growth / limit) * 1.05:.2g}")
    where = (
        f"At the start joint {joint + 1} saturates with S = {_short(sliding[joint])} rad/s, and "
        "until it leaves saturation"
        if begins[joint]
        else f"Joint {joint + 1} lacks torque, and while that leaves S = {sliding[joint]:g} rad/s"
    )
    _, most = bounds(NetworkGains, "leakage")
    way_out = (
        f"A leakage of {leakage:g} 1/s keeps it below the limit."
        if leakage <= most
        else "A lower learning rate or a smaller initial error limits it."
    )
    yield Advice(
        "info",
        field_path(("lanes", name, "leakage")),
        f"{where} its network winds up by φΣh²|S| = {_short(growth[joint])} N·m per second. "
        f"{way_out}",
        {"lanes": {name: {"leakage": leakage}}} if leakage <= most else None,
    )


def _fast_disturbance(packed: Packed, name: str) -> Iterator[Advice]:
    """Tell of a disturbance that swings faster than the steps can follow."""
    disturbance, simulation = packed.experiment.disturbance, packed.experiment.simulation
    swings = {
        "disturbance.sine.frequency": (disturbance.sine.frequency, disturbance.sine.amplitude),
        "disturbance.noise.bandwidth": (disturbance.noise.bandwidth, disturbance.noise.amplitude),
    }
    sampled = simulation.mode == "sampled"
    step = simulation.row_period / (simulation.plant_substeps if sampled else 1)
    for path, (frequency, amplitude) in swings.items():
        if not np.any(amplitude) or _STEPS_A_SWING * step * frequency <= 1.0 + 1e-9:
            continue
        yield Advice(
            "info",
            path,
            f"At {_short(frequency)} Hz a cycle has fewer than {_STEPS_A_SWING} steps of "
            f"{_short(1e3 * step)} ms: the impulse of each step is right, but not the waveform "
            "within it.",
            _finer_steps(packed.experiment, frequency),
        )


def _finer_steps(experiment: Experiment, frequency: float) -> dict[str, Any] | None:
    """Return the patch that follows a swing of that frequency in [Hz], if there is one."""
    simulation = experiment.simulation
    if simulation.mode == "sampled":
        _, most = bounds(Simulation, "plant_substeps")
        substeps = int(np.ceil(_STEPS_A_SWING * frequency * simulation.row_period - 1e-9))
        return {"simulation": {"plant_substeps": substeps}} if substeps <= most else None
    least, _ = bounds(Simulation, "step")
    unit = 10.0 ** (np.floor(np.log10(1.0 / (_STEPS_A_SWING * frequency))) - 1.0)
    step = float(f"{np.floor(1.0 / (_STEPS_A_SWING * frequency) / unit + 1e-9) * unit:.2g}")
    fits = step >= max(least, simulation.horizon / MAX_STEPS)
    return {"simulation": {"step": step}} if fits else None


def _unused(packed: Packed, name: str) -> Iterator[Advice]:
    experiment = packed.experiment
    noise, delay = experiment.disturbance.sensor_noise, experiment.simulation.input_delay
    settings = (
        ("simulation.input_delay", delay, f"An input delay of {_short(1e3 * delay)} ms"),
        ("disturbance.sensor_noise.position", noise.position, "Noise on the measured angles"),
        ("disturbance.sensor_noise.velocity", noise.velocity, "Noise on the measured velocities"),
    )
    used = experiment.simulation.mode == "sampled" or not any(value for _, value, _ in settings)
    if used:
        return
    change = _sampled(experiment)
    for path, value, what in settings:
        if value:
            text = (
                f"{what} acts in sampled mode only: this loop is continuous, so it has no effect."
            )
            yield Advice("info", path, text, change)


def _sampled(experiment: Experiment) -> dict[str, Any] | None:
    """Return the patch that chooses sampled mode, if every lane is stable there."""
    patch = {"simulation": {"mode": "sampled"}}
    simulation = experiment.simulation.model_copy(update=patch["simulation"])
    if simulation.horizon / simulation.row_period > MAX_STEPS:
        return None
    packed = pack(experiment.patched(patch))
    return patch if all(is_stable(packed, name) for name in experiment.lanes) else None


def advice_on(packed: Packed, name: str) -> list[Advice]:
    """Return all remarks on one lane's numbers; an empty list says that nothing is amiss."""
    checks = (
        _sampling,
        _sampled_arm,
        _sign,
        _convergence,
        _motion,
        _start,
        _blindness,
        _windup,
        _fast_disturbance,
        _unused,
    )
    return [one for check in checks for one in check(packed, name)]
