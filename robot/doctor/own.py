"""The arm of a URDF as one of the user's own, or the doctor's words why there is none."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from slidetune.robot.arm.known_arm import KnownArm, own_arm
from slidetune.robot.doctor.examine import Examined, examine
from slidetune.robot.doctor.report import report
from slidetune.robot.errors import RefusedArmError


def read_arm(
    path: Path,
    package_dirs: Sequence[Path] = (),
    tip: str | None = None,
    total_mass: float | None = None,
    title: str = "",
) -> tuple[KnownArm, Examined]:
    """Return the arm of a URDF, by the name that it has on every machine, and what was found.

    Args:
        path: the file.
        package_dirs: see ``examine``.
        tip: see ``examine``.
        total_mass: see ``examine``.
        title: name on the screen; by default the robot's.

    Raises:
        RefusedArmError: if the doctor refuses it; the text is its whole report.
    """
    examined = examine(path, package_dirs, tip, total_mass)
    if examined.arm is None:
        raise RefusedArmError(report(examined))
    return own_arm(examined.arm, examined.name, title, path.name), examined
