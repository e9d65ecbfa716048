"""A serial arm of any description: its model, its joints, how it looks."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pinocchio as pin


@dataclass(frozen=True)
class Visual:
    """One part of the arm's looks: a mesh, or else one of the three primitives.

    Attributes:
        joint: the joint that carries it, counted from 1; 0 for what stands on the base.
        placement: its place in that joint's frame.
        mesh: a file that is there, in its own unit.
        scale: factors on the mesh along its axes, which make metres of its unit.
        box: edges along x, y and z in [m].
        cylinder: radius and length along z in [m].
        sphere: radius in [m].
        color: red, green, blue and opacity in 0..1, where the file has one.
    """

    joint: int
    placement: pin.SE3
    mesh: Path | None = None
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    box: tuple[float, float, float] | None = None
    cylinder: tuple[float, float] | None = None
    sphere: float | None = None
    color: tuple[float, float, float, float] | None = None


@dataclass(frozen=True)
class SerialArm:
    """A chain of 1 to 12 joints on a fixed base; every one of them has one q and one v.

    Attributes:
        model: the chain, with all other joints held at their neutral place. A joint that is called
            like a link has another name there: both are frames.
        tip: the frame of the model that is the arm's end.
        joints: names in the file, from base to tip.
        held: names of the joints that are held.
        lower: lower limits in [rad] or [m], ``-inf`` where there is none.
        upper: upper limits in [rad] or [m], ``inf`` where there is none.
        velocity: speed limits in [rad/s] or [m/s], ``inf`` where there is none.
        effort: torque or force limits in [N·m] or [N], ``inf`` where there is none.
        visuals: how the arm looks, from base to tip.
    """

    model: pin.Model
    tip: str
    joints: tuple[str, ...]
    held: tuple[str, ...]
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    velocity: tuple[float, ...]
    effort: tuple[float, ...]
    visuals: tuple[Visual, ...]
