"""An arm that an experiment may be about: its model, what is allowed of it, how it looks."""

from __future__ import annotations

import hashlib
import json
import re
import unicodedata
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.chain import turned_axis
from slidetune.robot.arm.home import home_pose
from slidetune.robot.arm.serial import SerialArm, Visual
from slidetune.robot.fields.written_value import written

Array = np.ndarray

WIDEST_STEP = 0.6
"""How far the default move takes a joint at most, in [rad] or [m] (*ours*)."""
LONGEST_SLUG = 24
"""Characters of the robot's own name in an arm's (*ours*)."""
DIGITS = 8
"""Hexadecimal digits of the digest in an arm's name (*ours*)."""
_NAME = re.compile(rf"[a-z0-9][a-z0-9-]{{0,{LONGEST_SLUG - 1}}}-[0-9a-f]{{{DIGITS}}}")
_RELATIVE = 9
"""Decimals of a block of numbers, relative to its largest, that a digest looks at (*ours*): what
lies beyond them differs between machines.
"""


@dataclass(frozen=True, eq=False)
class KnownArm:
    """An arm as it is described; an experiment may scale and load it.

    Attributes:
        name: value of ``model`` in the section ``robot``.
        title: name on the screen.
        meaning: the arm in one line.
        model: the arm with a fixed base, a serial chain of joints; not to be changed.
        tip: the frame of the model that is its flange.
        home: the pose that it begins from in [rad], or [m] where a joint slides.
        visuals: how it looks, from base to tip.
    """

    name: str
    title: str
    meaning: str
    model: pin.Model
    tip: str
    home: tuple[float, ...]
    visuals: tuple[Visual, ...] = ()

    @property
    def joints(self) -> int:
        """How many joints it has."""
        return int(self.model.nv)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of its joints, from base to tip."""
        return tuple(self.model.names)[1:]

    @cached_property
    def slides(self) -> tuple[bool, ...]:
        """Which joints slide: their units are m and N in the place of rad and N·m."""
        found = (turned_axis(self.model, joint) for joint in range(1, self.joints + 1))
        return tuple(axis is not None and axis[1] for axis in found)

    @property
    def lower(self) -> tuple[float, ...]:
        """Lower limits in [rad] or [m], ``-inf`` where there is none."""
        return tuple(self.model.lowerPositionLimit.tolist())

    @property
    def upper(self) -> tuple[float, ...]:
        """Upper limits in [rad] or [m], ``inf`` where there is none."""
        return tuple(self.model.upperPositionLimit.tolist())

    @property
    def velocity(self) -> tuple[float, ...]:
        """Speed limits in [rad/s] or [m/s], ``inf`` where there is none."""
        return tuple(self.model.velocityLimit.tolist())

    @property
    def effort(self) -> tuple[float, ...]:
        """Torque or force limits in [N·m] or [N], ``inf`` where there is none."""
        return tuple(self.model.effortLimit.tolist())

    @property
    def away(self) -> tuple[float, ...]:
        """A pose to move to from home, within the limits: a quarter of each joint's way."""
        lower = np.maximum(self.model.lowerPositionLimit, -np.pi)
        upper = np.minimum(self.model.upperPositionLimit, np.pi)
        home = np.array(self.home)
        to = np.where(upper - home >= home - lower, upper, lower)
        return tuple((home + np.clip(0.25 * (to - home), -WIDEST_STEP, WIDEST_STEP)).tolist())


def is_own_name(name: str) -> bool:
    """Whether one of the user's arms may be called so: a slug and a digest, and never a path."""
    return bool(_NAME.fullmatch(name))


def own_arm(serial: SerialArm, called: str, title: str = "", file: str = "") -> KnownArm:
    """Return an arm of the user's own, by the name that it has on every machine.

    Args:
        serial: the arm that the doctor has found.
        called: the robot's name in its file.
        title: name on the screen; by default the robot's.
        file: name of its file, for its meaning.
    """
    model = serial.model
    count = len(serial.joints)
    joints = f"{count} {'joint' if count == 1 else 'joints'}"
    source = f" of {written(file)}" if file else ""
    return KnownArm(
        f"{_slug(called)}-{digest_of(model, serial.tip)}",
        written(title or called),
        f"{joints}{source}, up to {written(serial.tip)}.",
        model,
        serial.tip,
        home_pose(model, serial.tip),
        serial.visuals,
    )


def _slug(called: str) -> str:
    plain = unicodedata.normalize("NFKD", called[:400]).encode("ascii", "ignore").decode().lower()
    return re.sub(r"[^a-z0-9]+", "-", plain).strip("-")[:LONGEST_SLUG].rstrip("-") or "arm"


def digest_of(model: pin.Model, tip: str) -> str:
    """Return a digest of all that a run depends on, and of the limits.

    Names of links and joints and what is drawn are no part of it; nor are the last digits, by
    which machines differ.

    Args:
        model: a serial arm.
        tip: its flange.
    """
    frame = model.frames[model.getFrameId(tip)]
    content: list[Any] = [_rounded(model.gravity.linear), _placed(frame.placement)]
    for joint in range(1, model.njoints):
        inertia = model.inertias[joint]
        content += [
            model.joints[joint].shortname().removeprefix("JointModel")[:1],
            _rounded(np.asarray(model.joints[joint].createData().S).ravel()),
            _placed(model.jointPlacements[joint]),
            _rounded(np.array([inertia.mass])),
            _rounded(inertia.lever),
            _rounded(np.asarray(inertia.inertia).ravel()),
        ]
    for limits in (
        model.lowerPositionLimit,
        model.upperPositionLimit,
        model.velocityLimit,
        model.effortLimit,
    ):
        content.append([_rounded(np.array([limit])) for limit in limits])
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()[:DIGITS]


def _placed(placement: pin.SE3) -> list[list[str]]:
    return [_rounded(np.asarray(placement.rotation).ravel()), _rounded(placement.translation)]


def _rounded(values: Array) -> list[str]:
    """Return numbers to nine decimals of the largest, so that 6e-17 beside 1 is 0."""
    largest = float(np.abs(values).max())
    if not np.isfinite(largest) or largest == 0.0:
        return [repr(float(value) + 0.0) for value in values]
    # Rounded first: what is 1 on one machine is 1 - 1e-16 on another.
    last = int(np.floor(np.log10(float(f"{largest:.{_RELATIVE}g}")))) - _RELATIVE
    return [f"{round(float(value) / 10.0**last)}e{last}" for value in values]
