"""The process in which an arm that somebody sends is examined and kept.

Meshes are read there: what a damaged one makes of their readers is lost with this process alone,
and the live session is not kept waiting for it.
"""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from slidetune.robot.arm.kept import keep
from slidetune.robot.arm.known_arm import own_arm
from slidetune.robot.doctor.examine import Examined, examine
from slidetune.robot.doctor.report import summary
from slidetune.robot.errors import ArmStorageError
from slidetune.server.compute.apart import answer_once


def examined(asked: dict[str, Any]) -> dict[str, Any]:
    """Return what the doctor says, and the name of the arm that is kept; see ``uploads``."""
    root, path = Path(asked["root"]), Path(asked["path"])
    found = examine(path, [root], asked["tip"], asked["total_mass"], within=root)
    name = ""
    if found.arm is not None:
        try:
            name = keep(own_arm(found.arm, found.name, file=path.name), path).name
        except ArmStorageError as error:
            return {"storage": str(error)}
    return _document(found, name, root)


def _document(found: Examined, name: str, root: Path) -> dict[str, Any]:
    """Say it, with no word of the folder in which the files were for a moment."""

    def placed(value: Any) -> Any:
        if not isinstance(value, str):
            return value
        return value.replace(f"{root}/", "").replace(str(root), "the files")

    findings = [
        {key: placed(value) for key, value in asdict(finding).items()} for finding in found.findings
    ]
    return {
        "name": name,
        "robot": found.name,
        "summary": summary(found),
        "tip": "" if found.arm is None else found.arm.tip,
        "joints": [] if found.arm is None else list(found.arm.joints),
        "held": [] if found.arm is None else list(found.arm.held),
        "findings": findings,
    }


if __name__ == "__main__":
    answer_once(examined)
