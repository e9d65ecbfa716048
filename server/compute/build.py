"""What the result of a run depends on beside its arguments: this program and what it stands on."""

from __future__ import annotations

import hashlib
import sys
from pathlib import Path

import numba
import numpy
import pinocchio

import slidetune.robot
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.laws import own_versions
from slidetune.robot.version import __version__

Build = dict[str, str]


def _sources() -> str:
    """Return a digest of everything in `robot/` that a result depends on, wherever it lies."""
    root = Path(slidetune.robot.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*"), key=lambda path: path.relative_to(root).as_posix()):
        if path.suffix in (".py", ".urdf"):
            digest.update(path.relative_to(root).as_posix().encode() + b"\0")
            digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:12]


# As it was when this process loaded it, whatever becomes of the files.
BUILD: Build = {
    "slidetune": __version__,
    "sources": _sources(),
    "python": f"{sys.version_info.major}.{sys.version_info.minor}",
    "numpy": numpy.__version__,
    "numba": numba.__version__,
    "pin": pinocchio.__version__,
}
"""What a result depends on beside its arguments: workers and coordinator must agree in it."""
VERSION = f"{BUILD['slidetune']} ({BUILD['sources']})"
"""Version and sources, as people are told of them."""


def version_of(experiment: Experiment) -> str:
    """Return version and sources, those of its laws' own files among them."""
    own = own_versions(experiment.lanes).items()
    return ", ".join([VERSION, *(f"{name} {version}" for name, version in own)])


def difference(has: Build, wanted: Build) -> str:
    """Return in words in what a build differs from the wanted one; empty if in nothing."""
    return ", ".join(
        f"{name} {has.get(name, 'none')} (wanted {value})"
        for name, value in wanted.items()
        if has.get(name) != value
    )
