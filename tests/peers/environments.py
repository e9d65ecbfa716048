"""A Python environment for every peer, apart from ours: some bring much along, some may clash.

They lie in ``build/peers``, with the versions of ``requirements.lock`` where both need a package.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build" / "peers"
LOCK = ROOT / "requirements.lock"
PIP = ("-m", "pip", "--disable-pip-version-check", "--quiet", "install", "--only-binary", ":all:")


class UnavailablePeerError(RuntimeError):
    """A peer that can't be installed or started here; the message says why."""


@dataclass(frozen=True)
class Peer:
    """A contestant.

    Attributes:
        name: of its environment.
        title: of the peer, for people.
        module: below this folder.
        requirement: what to install for it; empty for what runs in our own environment.
    """

    name: str
    title: str
    module: str
    requirement: str = ""


PEERS = (
    Peer("ours", "Slidetune", "ours"),
    Peer("pinocchio", "Pinocchio", "numpy_on_pinocchio"),
    Peer("mujoco", "MuJoCo", "arms.mujoco", "mujoco>=4,<5"),
    Peer("drake", "Drake", "arms.drake", "drake>=1.40,<2"),
    Peer("pybullet", "PyBullet", "arms.bullet", "pybullet>=3.2.6,<4"),
    Peer("toolbox", "Robotics Toolbox", "arms.toolbox", "roboticstoolbox-python>=1.5,<2"),
)


def _said(process: subprocess.CompletedProcess[str]) -> str:
    """Return the line that tells most of what a command said in vain."""
    lines = [line.strip() for line in process.stderr.splitlines() if line.strip()]
    errors = [line for line in lines if line.startswith("ERROR:")]
    line = errors[0].removeprefix("ERROR: ") if errors else (lines or ["no reason given"])[-1]
    return line.rstrip(".")


def _interpreter(folder: Path) -> Path:
    return folder / "bin" / "python"


def is_ready(peer: Peer) -> bool:
    """Whether nothing needs installing for a peer."""
    if not peer.requirement:
        return True
    mark = FOLDER / peer.name / "installed"
    return mark.is_file() and mark.read_text(encoding="utf-8") == _contents(peer)


def _contents(peer: Peer) -> str:
    return f"{peer.requirement}\n{sys.version}\n{LOCK.read_text(encoding='utf-8')}"


def versions() -> str:
    """Return the locked versions without their hashes, with which pip takes nothing unlocked."""
    return re.sub(r" \\\n +--hash=\S+", "", LOCK.read_text(encoding="utf-8"))


def interpreter(peer: Peer) -> Path:
    """Return the Python that has a peer, installing it first if it is not there yet.

    Raises:
        UnavailablePeerError: if it can't be installed on this platform.
    """
    if not peer.requirement:
        return Path(sys.executable)
    folder = FOLDER / peer.name
    if is_ready(peer):
        return _interpreter(folder)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    constraints = folder / "versions"
    constraints.write_text(versions(), encoding="utf-8")
    install = [*PIP, "--constraint", str(constraints), "numpy", peer.requirement]
    steps = ([sys.executable, "-m", "venv", str(folder)], [str(_interpreter(folder)), *install])
    for step in steps:
        process = subprocess.run(
            step, capture_output=True, encoding="utf-8", env={**os.environ, "PYTHONPATH": ""}
        )
        if process.returncode:
            raise UnavailablePeerError(f"{peer.requirement} can't be installed: {_said(process)}")
    (folder / "installed").write_text(_contents(peer), encoding="utf-8")
    return _interpreter(folder)
