"""The wheel: one import name, whatever else lies in the folder where it is used."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest

from tests.deploy.conftest import ROOT, build

FOLDERS = ("robot", "server", "web", "presets")


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of packages with the wheel in it."""
    folder = tmp_path_factory.mktemp("installed")
    with ZipFile(wheel) as archive:
        archive.extractall(folder)
    return folder


def run_python(arguments: list[str], folder: Path, packages: Path) -> str:
    """Run Python in a folder, after its own files with the packages; returns what it prints."""
    environment = {
        "PYTHONPATH": str(packages),
        "HOME": str(folder),
        "XDG_CACHE_HOME": str(folder / "cache"),
        "SLIDETUNE_PRESETS": str(folder / "mine"),
        "NUMBA_DISABLE_JIT": "1",  # what is tried here is where modules come from
    }
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def names(wheel: Path) -> set[str]:
    with ZipFile(wheel) as archive:
        return set(archive.namelist())


def test_the_wheel_brings_one_package_with_every_file(wheel: Path) -> None:
    tracked = subprocess.run(
        ["git", "ls-files", "--", *FOLDERS], cwd=ROOT, capture_output=True, text=True, check=True
    )
    wanted = {f"slidetune/{name}" for name in tracked.stdout.splitlines()}
    assert wanted <= names(wheel)
    assert {name.partition("/")[0] for name in names(wheel)} == {
        "slidetune",
        f"{wheel.name.removesuffix('-py3-none-any.whl')}.dist-info",
    }


def test_a_wheel_from_the_source_distribution_is_the_same(wheel: Path, tmp_path: Path) -> None:
    source = build("sdist", ROOT, tmp_path / "sdist")
    subprocess.run(["tar", "xzf", str(source), "-C", str(tmp_path)], check=True)
    unpacked = tmp_path / source.name.removesuffix(".tar.gz")
    assert names(build("wheel", unpacked, tmp_path / "wheel")) == names(wheel)


def test_files_of_the_user_are_not_taken_for_ours(hostile: Path, installed: Path) -> None:
    script = (
        "import slidetune\n"
        "from slidetune import load_preset, simulate\n"
        "import slidetune.robot.laws, slidetune.server.app, sys\n"
        "short = load_preset('paper').patched({'simulation': {'horizon': 0.1}})\n"
        "print(slidetune.__file__, len(short.lanes))\n"
        "print(*sorted({'robot', 'server', 'web', 'presets'} & sys.modules.keys()))\n"
    )
    first, second = run_python(["-c", script], hostile, installed).splitlines()
    assert first == f"{installed / 'slidetune' / '__init__.py'} 3"
    assert second == ""


def test_the_command_line_runs_in_a_folder_of_the_user(hostile: Path, installed: Path) -> None:
    assert run_python(["-m", "slidetune", "--version"], hostile, installed).strip()
    report = run_python(["-m", "slidetune", "serve", "--help"], hostile, installed)
    assert "--preset" in report
