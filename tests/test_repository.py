"""What may and what must be in the repository."""

from __future__ import annotations

import re
import subprocess
import tomllib
from itertools import chain
from pathlib import Path

import pytest

from robot.version import __version__

ROOT = Path(__file__).resolve().parents[1]
LARGEST_MESHES = 1_000_000
"""Most bytes that all meshes may have together."""
# Brackets keep a pattern from being what it looks for.
REGISTRY = re.compile(
    r"py[p]i\.(org|python)|python[h]osted\.|npm[j]s\.|yarn[p]kg\.|crates[.]io|jsdel[i]vr|unp[k]g\."
    r"|esm[.]sh|(extra-)?index[-]url|find[-]links"
)
MACHINE_PATH = re.compile(r"(?<![\w.:/}-])/(ro[o]t|wor[k]|tm[p]|ho[m]e/\w+|User[s]/\w+)(/\w|$)")
COMMANDS = re.compile(r"(?:^\s*(?:\$ )?|`)make ([a-z]+)", re.MULTILINE)


def files() -> list[Path]:
    """Every file that is in the repository, or will be once it is added."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, check=False)
    if run.returncode:
        pytest.skip("not a git checkout")
    paths = [ROOT / name.decode() for name in run.stdout.split(b"\0") if name]
    return [path for path in paths if path.is_file()]


def texts() -> dict[str, str]:
    """Every text file of the repository, by its name."""
    contents = {path.relative_to(ROOT).as_posix(): path.read_bytes() for path in files()}
    return {name: data.decode() for name, data in contents.items() if b"\0" not in data}


def lines_with(pattern: re.Pattern[str]) -> list[str]:
    return [
        f"{name}:{number}: {line.strip()[:120]}"
        for name, text in texts().items()
        for number, line in enumerate(text.splitlines(), 1)
        if pattern.search(line)
    ]


def targets() -> set[str]:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    return set(re.findall(r"^([a-z]+):", makefile, re.MULTILINE))


def test_no_file_names_a_package_registry() -> None:
    assert lines_with(REGISTRY) == []


def test_no_file_names_a_folder_of_one_machine() -> None:
    assert lines_with(MACHINE_PATH) == []


def test_the_meshes_stay_small() -> None:
    meshes = list((ROOT / "robot").rglob("*.glb"))
    assert meshes
    assert sum(mesh.stat().st_size for mesh in meshes) < LARGEST_MESHES


def test_the_commands_of_the_readme_exist() -> None:
    commands = set(COMMANDS.findall((ROOT / "README.md").read_text(encoding="utf-8")))
    assert {"run", "test"} <= commands <= targets()


def test_the_commands_of_the_contribution_guide_exist() -> None:
    commands = set(COMMANDS.findall((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")))
    assert commands
    assert commands <= targets()


def test_make_help_explains_every_target() -> None:
    run = subprocess.run(["make", "help"], cwd=ROOT, capture_output=True, text=True, check=True)
    explained = set(re.findall(r"^  ([a-z]+)  ", run.stdout, re.MULTILINE))
    assert targets() - {"always", "libgomp"} == explained


def test_the_version_is_written_once() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert "version" in project["project"]["dynamic"]
    assert project["tool"]["hatch"]["version"]["path"] == "robot/version.py"
    quoted = re.compile(rf"""["']v?{re.escape(__version__)}["']""")
    holders = [
        name
        for name, text in texts().items()
        if Path(name).suffix in (".py", ".js", ".html", ".toml", ".json") and quoted.search(text)
    ]
    assert holders == ["robot/version.py"]


def test_the_changelog_tells_of_this_version() -> None:
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"## [{__version__}]" in changelog


def test_the_lock_holds_an_exact_version_of_every_dependency() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"].values()
    wanted = [*project["dependencies"], *chain.from_iterable(extras)]
    lock = (ROOT / "requirements.lock").read_text(encoding="utf-8")
    exact = re.findall(r"^([\w.-]+)==[\w.]+(?: ; .+)?$", lock, re.MULTILINE)
    lines = [line for line in lock.splitlines() if line and not line.startswith("#")]
    assert len(lines) == len(exact)
    names = {re.sub(r"[-_.]+", "-", name).lower() for name in exact}
    needed = {re.match(r"[\w.-]+", line)[0] for line in wanted}  # type: ignore[index]
    assert {re.sub(r"[-_.]+", "-", name).lower() for name in needed} <= names
