"""What a log knows of the arm, as numbers with intervals and as an edit of the experiment."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from threadpoolctl import threadpool_limits

from slidetune.robot.arm.known import arm_named
from slidetune.robot.arm.section import Robot
from slidetune.robot.identification.beside_bound import asked, beside_bounds
from slidetune.robot.identification.filtering import kinematics_of
from slidetune.robot.identification.late_torque import LEAST, lateness_of
from slidetune.robot.identification.numbers import (
    BLOCKS,
    PARTS,
    bounds_of,
    names_of,
    part_of,
    title_of,
    titles_of,
    unit_of,
    values_of,
)
from slidetune.robot.identification.regressor import Equation, equation_of, flange_of
from slidetune.robot.identification.remarks import remarks_on
from slidetune.robot.identification.solving import PAYLOAD, Solution, solve
from slidetune.robot.recordings.recording import Recording
from slidetune.robot.recordings.refused import RecordingError

Array = np.ndarray
Told = Literal["yes", "given", "no"]

_CLEAR = 0.3
"""Share in a direction that nothing tells from which on a number is part of it (*ours*)."""
_SURE = 1.96
"""Deviations of a 95 % interval."""
_HEAVY = 0.25
"""Share of the arm's mass that is much for a payload (*ours*)."""
_FAR = 0.3
"""Distance in [m] that is much for a centre of mass (*ours*): what the field permits."""
_SHIFTS = 3
"""Most times that torques are shifted (*ours*)."""
_CLOSE = 0.1
"""Share of its interval that a shift may still be off (*ours*)."""
_DIGITS = 4
_RANKS = (2, 3, 4, 1)
"""Which numbers of a joint are fixed first: armature, viscous, Coulomb friction, constant."""


@dataclass(frozen=True)
class Estimate:
    """One number.

    Attributes:
        path: of the field, with the joint or axis counted from 0, such as
            ``viscous_friction`` of the arm and the number of the joint.
        title: in words, such as ``viscous friction of joint 3``.
        unit: of it.
        present: its value in the experiment.
        value: what the log says, or ``None`` where it can't tell.
        low: lower end of the 95 % interval, or ``None``.
        high: upper end, or ``None``.
        told: ``yes``; ``given``: as long as what ``reason`` names is right; ``no``.
        reason: why not, or on what condition, or what is odd about it, in words.
    """

    path: str
    title: str
    unit: str
    present: float
    value: float | None
    low: float | None
    high: float | None
    told: Told
    reason: str = ""


@dataclass(frozen=True)
class Identification:
    """What a log says of the arm.

    Attributes:
        estimates: every number that was asked for.
        time: of each row in [s]. Shape (r,).
        torque: measured torque below the cutoff in [N m]. Shape (r, n).
        fitted: the torque that the fitted arm needs in [N m]. Shape (r, n).
        rms_torque: effective measured torque of each joint in [N m]. Shape (n,).
        rms_residual: effective difference of both in [N m]. Shape (n,).
        bandwidth: cutoff in [Hz].
        patch: merge patch that sets what the log tells.
        remarks: what is doubtful, in words.
    """

    estimates: tuple[Estimate, ...]
    time: Array
    torque: Array
    fitted: Array
    rms_torque: Array
    rms_residual: Array
    bandwidth: float
    patch: dict[str, Any]
    remarks: tuple[str, ...]

    @property
    def residual(self) -> Array:
        """Measured minus fitted torque in [N m]. Shape (r, n)."""
        return np.asarray(self.torque - self.fitted)


def torque_of(recording: Recording, constants: Sequence[float] | None) -> Array:
    """Return the torques of a log in [N m], or those of its currents. Shape (m, n).

    Args:
        recording: a log.
        constants: torque at the joint per current in [N m/A], gear included, one a joint or one
            for all; torques count where it is ``None``.

    Raises:
        RecordingError: if the log has neither, or currents without constants.
    """
    joints = recording.q.shape[1]
    if constants is None:
        if recording.tau is not None:
            return recording.tau
        if recording.current is not None:
            raise RecordingError(
                f"{recording.name}: has currents and no torques: give the torque at each joint per "
                "ampere, gear included"
            )
        raise RecordingError(
            f"{recording.name}: has no torques (tau1 or joint_1/effort, say) and no currents (i1)"
        )
    if recording.current is None:
        raise RecordingError(f"{recording.name}: has no currents to which constants apply")
    if len(constants) not in (1, joints) or not all(np.isfinite(one) and one for one in constants):
        raise RecordingError(
            f"torque constants must be one number or {joints}, none of them 0, got {len(constants)}"
        )
    return np.asarray(recording.current * np.asarray(constants, dtype=float))


def identify(
    recording: Recording,
    robot: Robot,
    parts: Iterable[str] = PARTS,
    constants: Sequence[float] | None = None,
    bandwidth: float | None = None,
    load: Sequence[float] | float = 0.0,
) -> Identification:
    """Fit friction, payload, armature and constant torques to a log.

    Links count as known: those of the experiment's arm, with its inertials and their scale. What is
    not asked for, and what the log can't tell, stays as it is in the experiment. Torques that act
    later than the log has them are shifted, and a remark says by how much.

    Args:
        recording: a log of this arm, with measured angles and torques or currents.
        robot: the arm's section of the experiment.
        parts: some of ``PARTS``.
        constants: see ``torque_of``.
        bandwidth: cutoff in [Hz], see ``kinematics_of``.
        load: constant torque of the experiment's disturbance in [N m], one a joint or one for all.

    Raises:
        RecordingError: if the log can't tell anything, saying why.
    """
    wanted = tuple(parts)
    unknown = [part for part in wanted if part not in PARTS]
    if unknown or not wanted:
        raise RecordingError(f"what is fitted must be some of {', '.join(PARTS)}, got {unknown}")
    if not recording.measured:
        raise RecordingError(f"{recording.name}: has no measured angles, only those asked for")
    # The matrices are tall and narrow: threads would take ten times as long, and every core.
    with threadpool_limits(limits=1, user_api="blas"):
        return _fitted(recording, robot, wanted, torque_of(recording, constants), bandwidth, load)


def _fitted(
    recording: Recording,
    robot: Robot,
    wanted: Sequence[str],
    torque: Array,
    bandwidth: float | None,
    load: Sequence[float] | float,
) -> Identification:
    names = names_of(robot)
    present, lower, upper = values_of(robot, load), *bounds_of(len(names))
    fitted = np.array([part_of(path) in wanted for path in names])
    present = np.clip(present, lower, upper)
    late, half = 0.0, 0.0
    for shifts_left in range(_SHIFTS, -1, -1):
        log = kinematics_of(recording, torque, bandwidth, late)
        equation = equation_of(robot, log)
        much = _much(robot, equation)
        shifted = late != 0.0
        solution, reasons = _told(
            equation, robot, names, present, fitted, (lower, upper), much, shifted
        )
        more, half = lateness_of(equation, solution, solution.deviation > 0.0)
        if not shifts_left or abs(more) <= (_CLOSE * half if shifted else max(half, LEAST)):
            break
        late += more
    half = max(half, abs(more))  # what a shift may still be off, where it has not settled
    estimates = _estimates(robot, names, solution, reasons, present, (lower, upper), fitted)
    whole = np.sqrt(np.mean(equation.torque**2, axis=0))
    left = np.sqrt(np.mean(solution.residual**2, axis=0))
    return Identification(
        estimates=estimates,
        time=equation.time,
        torque=equation.torque,
        fitted=equation.torque - solution.residual,
        rms_torque=whole,
        rms_residual=left,
        bandwidth=log.bandwidth,
        patch=_patch(robot, load, estimates),
        remarks=remarks_on(recording, whole, left, (late, half)),
    )


def _much(robot: Robot, equation: Equation) -> Array:
    """Return what is much of each number: an interval wider than that tells nothing.

    Friction as much as a joint's own weight and inertia ask for, at 1 rad/s; as much inertia as it
    turns anyway; a quarter of the arm as payload.
    """
    arm = arm_named(robot.model).model
    mass = _HEAVY * sum(inertia.mass for inertia in list(arm.inertias)[1:])
    weights = [equation.weight] * (BLOCKS - 1)
    return np.concatenate([[mass], [_FAR] * 3, equation.inertia, *weights])


def _told(
    equation: Equation,
    robot: Robot,
    names: list[str],
    present: Array,
    wanted: Array,
    ends: tuple[Array, Array],
    much: Array,
    shifted: bool,
) -> tuple[Solution, dict[int, str]]:
    """Fit what the log can tell, fixing one number after the other that it can't.

    Returns:
        The solution, and for each number that was fixed, or depends on one that was, why.
    """
    flange, fitted = flange_of(robot), wanted.copy()
    reasons: dict[int, str] = {}
    given: dict[int, list[int]] = {}
    # Begun with some mass, so that a centre has an effect.
    begin = present.copy()
    if fitted[0] and begin[0] == 0.0:
        begin[0] = 0.1 * min(much[0], ends[1][0])
    while True:
        values = np.where(fitted, begin, present)
        solution = solve(equation, flange, values, fitted, *ends, shifted)
        found = _untold(solution, fitted, much)
        if found is None:
            beyond = _beyond(solution, fitted, ends)
            if beyond is None:
                break
            fitted[beyond] = False
            reasons[beyond] = (
                f"the log asks for {asked(solution, beyond)}, beyond what is allowed: the model "
                "lacks something, and its present value is kept"
            )
            continue
        fixed, members = found
        fitted[fixed] = False
        others = [member for member in members if member != fixed and fitted[member]]
        if others:
            told = titles_of(names, others)
            reasons[fixed] = f"the log can't tell it from {told}: its present value is kept"
            for member in others:
                given.setdefault(member, []).append(fixed)
        else:
            reasons[fixed] = "the log does not excite it: its present value is kept"
    for member, fixes in given.items():
        if fitted[member]:
            reasons[member] = f"given the present value of {titles_of(names, fixes)}"
    return beside_bounds(solution, names, fitted, ends, much, reasons), reasons


def _beyond(solution: Solution, fitted: Array, ends: tuple[Array, Array]) -> int | None:
    """Return a number that the fit has pushed to an end at which no real one would be.

    Nothing is an answer: no friction, no payload. As much as a field permits is none.
    """
    at_end = (solution.values == ends[1]) | ((ends[0] < 0.0) & (solution.values == ends[0]))
    found = np.flatnonzero(fitted & at_end)
    return int(found[0]) if len(found) else None


def _untold(solution: Solution, fitted: Array, much: Array) -> tuple[int, list[int]] | None:
    """Return a number to fix, and all that its direction holds; ``None`` where all is told."""
    free = np.flatnonzero(fitted)
    if not len(free):
        return None
    scaled = solution.slopes[:, free] * much[free]
    strength, directions = np.linalg.eigh(scaled.T @ scaled)
    wide = np.flatnonzero(solution.deviation[free] > much[free])
    if strength[0] < _SURE**2:
        weight = np.abs(directions[:, 0])
        members = [int(free[at]) for at in np.flatnonzero(weight >= _CLEAR * weight.max())]
    elif len(wide):
        members = [int(free[np.argmax(solution.deviation[free] / much[free])])]
    else:
        return None
    size = np.linalg.norm(solution.slopes * much, axis=0)
    # The centre first, then constant torques, the mass last; of alike ones the least effect.
    return min(members, key=lambda member: (_rank(member, len(fitted)), size[member])), members


def _rank(member: int, count: int) -> int:
    if member == 0:
        return len(_RANKS) + 1
    if member < PAYLOAD:
        return 0
    return _RANKS[(member - PAYLOAD) // ((count - PAYLOAD) // BLOCKS)]


def _estimates(
    robot: Robot,
    names: list[str],
    solution: Solution,
    reasons: dict[int, str],
    present: Array,
    ends: tuple[Array, Array],
    wanted: Array,
) -> tuple[Estimate, ...]:
    found = []
    for number in np.flatnonzero(wanted):
        at, path = int(number), names[number]
        told: Told = "yes"
        reason = reasons.get(at, "")
        value: float | None = float(solution.values[at])
        low: float | None
        high: float | None
        if solution.deviation[at] == 0.0 and at in reasons:
            told, value, low, high = "no", None, None, None
        else:
            low, high, odd = _interval(solution, at, ends)
            told = "given" if reason else "yes"
            reason = "; ".join(part for part in (reason, odd) if part)
        title, unit = title_of(path), unit_of(robot, path)
        found.append(
            Estimate(path, title, unit, float(present[at]), value, low, high, told, reason)
        )
    return tuple(found)


def _interval(solution: Solution, at: int, ends: tuple[Array, Array]) -> tuple[float, float, str]:
    """Return the ends of an interval within the bounds, and what is odd about it."""
    value, half = float(solution.values[at]), float(solution.deviation[at])
    middle, lower, upper = float(solution.free[at]), float(ends[0][at]), float(ends[1][at])
    low, high = middle - half, middle + half
    odd = ""
    if high < lower or low > upper:
        odd = (
            f"without its bounds the log asks for {middle:.3g} ± {half:.2g}: the model lacks "
            "something"
        )
    elif low <= lower < value:
        odd = f"the interval holds {lower:g}"
    low, high = float(np.clip(low, lower, upper)), float(np.clip(high, lower, upper))
    return min(low, value), max(high, value), odd


def _patch(
    robot: Robot, load: Sequence[float] | float, estimates: tuple[Estimate, ...]
) -> dict[str, Any]:
    """Return the patch that sets what is told; whole lists, with the rest as it is."""
    joints = arm_named(robot.model).joints
    patch: dict[str, Any] = {}
    forces: list[float] = []
    for one in estimates:
        if one.value is None:
            continue
        value, keys = float(f"{one.value:.{_DIGITS}g}"), one.path.split(".")
        if keys[1] == "constant":
            forces = forces or np.broadcast_to(load, joints).astype(float).tolist()
            forces[int(keys[2])] = value
        elif keys[1] != "payload":
            whole = np.broadcast_to(getattr(robot, keys[1]), joints).astype(float).tolist()
            patch.setdefault(keys[1], whole)[int(keys[2])] = value
        elif keys[2] == "mass":
            patch.setdefault("payload", {})["mass"] = value
        else:
            center = patch.setdefault("payload", {}).setdefault(
                "center", list(robot.payload.center)
            )
            center[int(keys[3])] = value
    found = {"robot": patch, "disturbance": {"constant": forces} if forces else {}}
    return {section: one for section, one in found.items() if one}
