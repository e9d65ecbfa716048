"""The arms that an experiment may be about, by name: those that ship, and those that were added."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from pathlib import Path

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.description import POSES, URDF_PATH
from slidetune.robot.arm.teaching import PENDULUM, TWO_LINKS

SHIPPED = "jaka_zu5"
"""The arm of the paper."""
FLANGE = "flange_link"
WIDEST_STEP = 0.6
"""How far the default move takes a joint at most, in [rad] or [m] (*ours*)."""


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
    """

    name: str
    title: str
    meaning: str
    model: pin.Model
    tip: str
    home: tuple[float, ...]

    @property
    def joints(self) -> int:
        """How many joints it has."""
        return int(self.model.nv)

    @property
    def away(self) -> tuple[float, ...]:
        """A pose to move to from home, within the limits: a quarter of each joint's way."""
        lower = np.maximum(self.model.lowerPositionLimit, -np.pi)
        upper = np.minimum(self.model.upperPositionLimit, np.pi)
        home = np.array(self.home)
        to = np.where(upper - home >= home - lower, upper, lower)
        return tuple((home + np.clip(0.25 * (to - home), -WIDEST_STEP, WIDEST_STEP)).tolist())


_added: dict[str, KnownArm] = {}


@cache
def _shipped() -> dict[str, KnownArm]:
    def described(name: str, title: str, meaning: str, path: Path, tip: str) -> KnownArm:
        model = pin.buildModelFromUrdf(str(path))
        home = POSES["tool_down_back"] if name == SHIPPED else (0.0,) * model.nv
        return KnownArm(name, title, meaning, model, tip, tuple(home))

    arms = (
        described(SHIPPED, "JAKA Zu 5", "JAKA Zu 5, six joints, 5 kg, 954 mm.", URDF_PATH, FLANGE),
        described("pendulum", "Pendulum", "A rod of 0.5 m and 1 kg on one joint.", PENDULUM, "tip"),
        described(
            "two_links", "Two links", "Two rods of 0.4 m in a vertical plane.", TWO_LINKS, "tip"
        ),
    )
    return {arm.name: arm for arm in arms}


def known_arms() -> dict[str, KnownArm]:
    """Return all arms by name, those that ship first."""
    return {**_shipped(), **_added}


def add_arm(arm: KnownArm) -> None:
    """Let experiments be about an arm.

    Raises:
        ValueError: if one that ships has its name, or its tip is not on its last joint.
    """
    frame = arm.model.frames[arm.model.getFrameId(arm.tip)]
    if frame.parentJoint != arm.joints:
        raise ValueError(f"the tip {arm.tip} of {arm.name} is not on its last joint")
    if arm.name in _shipped():
        raise ValueError(f"{arm.name} is the name of an arm that ships")
    _added[arm.name] = arm


def arm_named(name: str) -> KnownArm:
    """Return an arm.

    Raises:
        ValueError: if no arm has that name; says which there are, and how to add one.
    """
    arms = known_arms()
    if name in arms:
        return arms[name]
    close = get_close_matches(name, arms, 1)
    guess = f" (did you mean {close[0]}?)" if close else ""
    raise ValueError(
        f"no arm named {name} is known here{guess}: there are {', '.join(arms)}; add another one "
        "by its URDF"
    )
