"""What may and what must be in the repository."""

from __future__ import annotations

import importlib
import re
import subprocess
import tomllib
from itertools import chain
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from slidetune.robot.version import __version__

ROOT = Path(__file__).resolve().parents[1]
LARGEST_MESHES = 1_000_000
"""Most bytes that all meshes may have together."""
# Brackets keep a pattern from being what it looks for.
REGISTRY = re.compile(
    r"py[p]i\.(org|python)|python[h]osted\.|npm[j]s\.|yarn[p]kg\.|crates[.]io|jsdel[i]vr|unp[k]g\."
    r"|esm[.]sh|(extra-)?index[-]url|find[-]links"
)
MACHINE_PATH = re.compile(r"(?<![\w.:/}-])/(ro[o]t|wor[k]|tm[p]|ho[m]e/\w+|User[s]/\w+)(/\w|$)")


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


def test_the_files_that_the_documentation_names_exist() -> None:
    named = re.compile(r"`((?:docs|presets|robot|server|slidetune|tests|web)/[\w/.-]*\.\w+)`")
    pages = [path for path in ROOT.glob("*.md") if path.name != "CHANGELOG.md"]
    pages += [*(ROOT / "docs").glob("*.md"), *(ROOT / "robot").rglob("*.md")]
    found = {name for page in pages for name in named.findall(page.read_text(encoding="utf-8"))}
    assert len(found) > 20
    assert {name for name in found if not (ROOT / name).is_file()} == {
        "presets/lessons/your-lesson.yaml"
    }


def test_make_help_explains_every_target() -> None:
    run = subprocess.run(["make", "help"], cwd=ROOT, capture_output=True, text=True, check=True)
    explained = set(re.findall(r"^  ([a-z]+)  ", run.stdout, re.MULTILINE))
    assert targets() - {"always", "libgomp"} == explained


def test_every_module_that_make_runs_can_be_imported() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    modules = set(re.findall(r"-m ((?:tests|slidetune)[\w.]*)", makefile))
    assert {"tests.trust.faults", "tests.trust.fuzz", "tests.trust.soak"} <= modules
    for module in modules:
        found = importlib.import_module(module)
        if hasattr(found, "__path__"):
            importlib.import_module(f"{module}.__main__")


def test_the_version_is_written_once() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert "version" in project["project"]["dynamic"]
    assert project["tool"]["hatch"]["version"]["path"] == "slidetune/robot/version.py"
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


def locked() -> list[tuple[str, str, int]]:
    """Name, version and number of hashes of every entry of the lock; fails on any other line."""
    lines = (ROOT / "requirements.lock").read_text(encoding="utf-8").splitlines()
    lock = "\n".join(line for line in lines if line and not line.startswith("#")) + "\n"
    entry = re.compile(
        r"([\w.-]+)==([\w.]+)(?: ; [^;\n]+?)?((?: \\\n    --hash=sha256:[0-9a-f]{64})*)\n"
    )
    found = list(entry.finditer(lock))
    assert "".join(match[0] for match in found) == lock
    return [(canonicalize_name(match[1]), match[2], match[3].count("--hash")) for match in found]


def test_the_lock_holds_an_exact_version_of_every_dependency() -> None:
    file = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    extras = file["project"]["optional-dependencies"].values()
    asked = [*file["project"]["dependencies"], *chain.from_iterable(extras)]
    asked += [*file["build-system"]["requires"], "editables"]
    versions: dict[str, set[str]] = {}
    for name, version, _ in locked():
        versions.setdefault(name, set()).add(version)
    for requirement in map(Requirement, asked):
        held = versions.get(canonicalize_name(requirement.name), set())
        assert held, f"requirements.lock lacks {requirement}"
        assert all(requirement.specifier.contains(version) for version in held), requirement


def test_every_version_in_the_lock_has_its_hashes() -> None:
    assert [name for name, _, hashes in locked() if not hashes] == []


def test_make_install_takes_no_file_without_a_locked_hash() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    recipe = re.search(r"^\$\(INSTALLED\):.*\n((?:\t.*\n)+)", makefile, re.MULTILINE)
    assert recipe
    assert "pip install" not in recipe[1]
    locked_ones, project = re.findall(r"\$\(PIP\) (.*)", recipe[1])
    assert "--require-hashes --requirement requirements.lock" in locked_ones
    assert "--no-index --no-build-isolation" in project
