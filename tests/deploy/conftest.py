"""The wheel, and an installation of it as `pipx`, `uv tool` or an image would make one."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import venv
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pinocchio
import pytest
from numba.core.caching import UserProvidedCacheLocator

import slidetune.robot
from slidetune.robot.kernels.compiler import CACHE

ROOT = Path(__file__).resolve().parents[2]
HOSTILE = "raise RuntimeError('this file belongs to the user')\n"
WARM_UP = "from slidetune.robot.loop.warmup import warm_up; warm_up()"
"""Has the control laws compiled for arms of six joints; the Dockerfile does so for more."""


@dataclass(frozen=True)
class Installation:
    """The wheel in an environment of its own.

    Attributes:
        top: folder of all of it, open to every user.
        bin: where its commands are.
        cache: folder for compiled kernels, which are there.
    """

    top: Path
    bin: Path
    cache: Path

    def settings(self, home: Path) -> dict[str, str]:
        """An environment that knows nothing of the checkout."""
        return {
            "HOME": str(home),
            "PATH": f"{self.bin}:/usr/bin:/bin",
            "XDG_CACHE_HOME": str(self.cache),
            "XDG_DATA_HOME": str(home / "data"),
            "PYTHONIOENCODING": "utf-8",
        }


def build(kind: str, source: Path, target: Path) -> Path:
    """Build a distribution of a kind, without a network; returns its file."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", str(target)]
    subprocess.run(command, cwd=source, check=True, capture_output=True)
    (built,) = target.iterdir()
    return built


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build("wheel", ROOT, tmp_path_factory.mktemp("wheel"))


@pytest.fixture
def hostile(tmp_path: Path) -> Path:
    """A user's folder in which everything is called as our folders are."""
    (tmp_path / "robot.py").write_text(HOSTILE)
    for name in ("server", "web", "presets"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text(HOSTILE)
        (tmp_path / name / "__main__.py").write_text(HOSTILE)
    return tmp_path


@pytest.fixture(scope="session")
def installation(wheel: Path) -> Iterator[Installation]:
    """The wheel, installed by pip into a new environment; what it depends on is that of here.

    Not in pytest's folder, which other users can't enter.
    """
    with tempfile.TemporaryDirectory(prefix="slidetune-installed-") as name:
        top = Path(name)
        top.chmod(0o755)
        venv.create(top / "venv", symlinks=True)
        made = Installation(top, top / "venv" / "bin", top / "cache")
        pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
        install = ["--python", str(made.bin / "python"), "install", "--no-deps", "--no-index"]
        subprocess.run([*pip, *install, str(wheel)], check=True, capture_output=True)
        site = next((top / "venv").glob("lib/python*/site-packages"))
        # A path in such a file is searched last, and its own such files are not: no link leads
        # from there to the checkout. Pinocchio's wheels have a folder beside the others.
        others = (sysconfig.get_path("purelib"), str(Path(pinocchio.__file__).parents[1]))
        (site / "dependencies.pth").write_text("\n".join(others) + "\n")
        _hand_kernels_on(made, site)
        command = [made.bin / "python", "-c", WARM_UP]
        subprocess.run(command, env=made.settings(top), cwd=top, check=True, capture_output=True)
        yield made


def _hand_kernels_on(made: Installation, site: Path) -> None:
    """Give an installation the kernels that are compiled for the same sources here.

    Where Numba would not take them, for whatever reason, it compiles them: in half a minute more.
    """
    here = Path(slidetune.robot.__file__).parent
    there = site / "slidetune" / "robot"
    script = "from slidetune.robot.kernels.compiler import CACHE; print(CACHE)"
    command = [made.bin / "python", "-c", script]
    environment = made.settings(made.top)
    done = subprocess.run(
        command, env=environment, cwd=made.top, check=True, capture_output=True, text=True
    )
    cache = Path(done.stdout.strip())
    place = UserProvidedCacheLocator.get_suitable_cache_subpath
    for source in here.rglob("*.py"):
        copy = there / source.relative_to(here)
        os.utime(copy, ns=(source.stat().st_mtime_ns, source.stat().st_mtime_ns))
        compiled = CACHE / place(str(source))
        if compiled.is_dir():
            shutil.copytree(compiled, cache / place(str(copy)), dirs_exist_ok=True)
    for mark in CACHE.glob("warm-*"):
        shutil.copy(mark, cache)
