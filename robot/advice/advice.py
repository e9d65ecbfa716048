"""What is wrong with these numbers, before running them: margins, time constants, torques."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from slidetune.robot.advice.adapted_gain import adapted_gain
from slidetune.robot.advice.remark import Advice, short
from slidetune.robot.advice.sampling import implicit, sampled_arm_instead, sampling, sign
from slidetune.robot.advice.torque_need import initial_torque, required_torque, start
from slidetune.robot.arm.known import arm_named
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.experiment.simulation import MAX_STEPS, Simulation
from slidetune.robot.fields.field_path import field_path
from slidetune.robot.fields.quantity import bounds
from slidetune.robot.fields.units import in_units_of
from slidetune.robot.kernels.workspace import LEAKAGE, NETWORK_SLOPE, TAU, S
from slidetune.robot.laws import SHIPPED
from slidetune.robot.laws.terms.network import NetworkGains
from slidetune.robot.margins.margin import is_stable

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
    elif lane.law in SHIPPED and np.all(np.multiply(lane.kd, horizon) > 4.0 * _DECAYS):
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
    slow = f"{formula} = {short(constant)} s, longer than the horizon of {horizon:g} s"
    yield Advice(
        "info",
        field_path(("lanes", name, field)),
        (f"{slow}: it hardly converges." if constant < 1e6 else "Nothing drives the error to zero.")
        + f" Try {symbol} = {value:g} {unit}.",
        {"lanes": {name: {field: value}}},
    )


def _limits(packed: Packed) -> Array:
    limit = packed.experiment.robot.torque_limit
    return np.broadcast_to(
        np.asarray(np.inf if limit is None else limit, dtype=float), packed.joints
    )


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
        f"The motion alone requires up to {short(need[joint])} N·m at joint {joint + 1}, whose "
        f"limit is {short(limit[joint])} N·m: no gains can track it. Raise the limit, or make the "
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
        f"At the start joint {joint + 1} needs {short(torque[joint])} N·m, but its limit is "
        f"{short(limit[joint])} N·m: the loop starts in torque saturation. Start with the desired "
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
            f"The Gaussians are narrower than the gaps between their centres ({short(spacing)} "
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
        f"At the start joint {joint + 1} saturates with S = {short(sliding[joint])} rad/s, and "
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
        f"{where} its network winds up by φΣh²|S| = {short(growth[joint])} N·m per second. "
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
            f"At {short(frequency)} Hz a cycle has fewer than {_STEPS_A_SWING} steps of "
            f"{short(1e3 * step)} ms: the impulse of each step is right, but not the waveform "
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
        ("simulation.input_delay", delay, f"An input delay of {short(1e3 * delay)} ms"),
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
        sampling,
        sampled_arm_instead,
        sign,
        implicit,
        adapted_gain,
        _convergence,
        _motion,
        _start,
        _blindness,
        _windup,
        _fast_disturbance,
        _unused,
    )
    slides = arm_named(packed.experiment.robot.model).slides
    found = [one for check in checks for one in check(packed, name)]
    return [replace(one, message=in_units_of(one.message, slides)) for one in found]
