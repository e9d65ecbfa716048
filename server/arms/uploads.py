"""What becomes of an arm that somebody sends: examined, and kept where nothing is refused."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import IO, Any

from slidetune.robot.arm.kept import keep
from slidetune.robot.arm.known import arm_named
from slidetune.robot.arm.known_arm import own_arm
from slidetune.robot.doctor.examine import Examined, examine
from slidetune.robot.doctor.report import summary
from slidetune.server.arms.unpacked import Unpacked

Sent = Sequence[tuple[str, IO[bytes]]]
"""Files with the paths that they were sent under."""


def take_arm(
    files: Sent, urdf: str = "", tip: str | None = None, total_mass: float | None = None
) -> dict[str, Any]:
    """Examine an arm and keep it where the doctor refuses nothing.

    Args:
        files: a URDF with its meshes, or ZIPs of them.
        urdf: path of the description where there are several.
        tip: the link that is its flange.
        total_mass: of the whole arm in [kg], for links without one.

    Returns:
        What the doctor says, and the name that the arm is kept by, empty where it is refused, as
        plain JSON values.

    Raises:
        InvalidExperimentError: if the files are none of an arm.
        ArmStorageError: if it can't be kept.
    """
    with tempfile.TemporaryDirectory(prefix="slidetune-arm-") as folder:
        unpacked = Unpacked(Path(folder))
        for name, content in files:
            unpacked.take(name, content)
        path = unpacked.urdf(urdf)
        examined = examine(path, [unpacked.root], tip or None, total_mass, within=unpacked.root)
        name = ""
        if examined.arm is not None:
            kept = keep(own_arm(examined.arm, examined.name, file=path.name), path)
            name = arm_named(kept.name).name
        return _document(examined, name, unpacked.root)


def _document(examined: Examined, name: str, root: Path) -> dict[str, Any]:
    """Say it, with no word of the folder in which it was for a moment."""

    def placed(value: Any) -> Any:
        if not isinstance(value, str):
            return value
        return value.replace(f"{root}/", "").replace(str(root), "the files")

    findings = [
        {key: placed(value) for key, value in asdict(finding).items()}
        for finding in examined.findings
    ]
    return {
        "name": name,
        "robot": examined.name,
        "summary": summary(examined),
        "tip": "" if examined.arm is None else examined.arm.tip,
        "joints": [] if examined.arm is None else list(examined.arm.joints),
        "held": [] if examined.arm is None else list(examined.arm.held),
        "findings": findings,
    }
