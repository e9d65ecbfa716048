"""What becomes of an arm that somebody sends: examined, and kept where nothing is refused."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import IO, Any

from slidetune.robot.errors import ArmStorageError
from slidetune.server.arms.unpacked import Unpacked, refused
from slidetune.server.compute.apart import LostProcessError, ask_apart

Sent = Sequence[tuple[str, IO[bytes]]]
"""Files with the paths that they were sent under."""

LIMIT = 120.0
"""Longest time that an examination may take in [s] (*ours*): 100 MB of meshes take some 20."""
_MODULE = "slidetune.server.arms.child"


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
        unpacked = Unpacked(Path(folder).resolve())
        for name, content in files:
            unpacked.take(name, content)
        asked = {
            "root": str(unpacked.root),
            "path": str(unpacked.urdf(urdf)),
            "tip": tip or None,
            "total_mass": total_mass,
        }
        try:
            answer: dict[str, Any] = ask_apart(_MODULE, asked, LIMIT)
        except LostProcessError as error:
            text = f"reading them {error.text}: one of the meshes may be damaged or far too large"
            raise refused(text) from error
    if "storage" in answer:
        raise ArmStorageError(answer["storage"])
    return answer
