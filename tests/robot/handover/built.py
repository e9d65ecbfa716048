"""Builds a hand-over as somebody who got it would."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import pytest

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-Wconversion")
ALIKE = ("-ffp-contract=off",)
SANITIZED = ("-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")


@cache
def compilers() -> tuple[str, ...]:
    """C compilers of this machine."""
    found = tuple(name for name in ("gcc", "clang") if shutil.which(name))
    return found or tuple(name for name in ("cc",) if shutil.which(name))


@cache
def sanitizes(compiler: str) -> bool:
    """Whether programs of a compiler can be run with its sanitizers here."""
    with tempfile.TemporaryDirectory() as folder:
        program = f"{folder}/empty"
        build = [compiler, *SANITIZED, "-x", "c", "-", "-o", program]
        text = "int main(void) { return 0; }"
        done = subprocess.run(build, input=text, capture_output=True, text=True)
        return not done.returncode and not subprocess.run([program]).returncode


def written(files: Mapping[str, str], folder: Path) -> Path:
    """Write a package to a folder, which it returns."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8", newline="")
    return folder


def run_c(folder: Path, compiler: str, *flags: str) -> subprocess.CompletedProcess[str]:
    """Compile a package's law and its check without a warning, and run that."""
    build = [compiler, *STRICT, *ALIKE, *flags, "-o", "check-law", "law.c", "check.c", "-lm"]
    done = subprocess.run(build, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return run("./check-law", "vectors.csv", folder=folder)


def run_python(folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a package's check in a Python that finds nothing of ours."""
    return run(sys.executable, "-W", "error", "check.py", "vectors.csv", folder=folder)


def run(*command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command there; our own packages are out of reach."""
    known = {"PATH": "/usr/local/bin:/usr/bin:/bin"}
    return subprocess.run(command, cwd=folder, env=known, capture_output=True, text=True)


def check_everywhere(folder: Path) -> None:
    """Check a package's law with every C compiler, with sanitizers where they work."""
    if not compilers():
        pytest.skip("no C compiler: neither gcc nor clang nor cc is there")
    for compiler in compilers():
        flags = SANITIZED if sanitizes(compiler) else ("-O2",)
        done = run_c(folder, compiler, *flags)
        assert done.returncode == 0, done.stdout + done.stderr
        assert "they agree" in done.stdout
