"""Finds a Chromium that starts, or installs one: ``python -m tests.browser.chromium``.

Prints its path; what is tried, and why it fails, goes to standard error.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

VARIABLE = "CHROMIUM"
"""Environment variable that names the Chromium to use."""
_ALONE = (
    "--no-sandbox",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)
"""Nothing that talks to anybody else."""
FLAGS = (*_ALONE, "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
"""Draws WebGL in software: the 3D scene needs it."""
FLAT_FLAGS = (*_ALONE, "--disable-gpu", "--disable-software-rasterizer")
"""Has no WebGL, and so draws all else in two thirds of the time."""
START_TIME = 60
"""Longest that a Chromium may take to show an empty page in seconds."""
INSTALL_TIME = 900
"""Longest that one way of installing may take in seconds."""

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
_FOLDERS = ("/usr/bin", "/usr/local/bin", "/opt/homebrew/bin", "/snap/bin")
_MAC_PROGRAMS = (
    "Google Chrome.app/Contents/MacOS/Google Chrome",
    "Chromium.app/Contents/MacOS/Chromium",
    "Google Chrome for Testing.app/Contents/MacOS/Google Chrome for Testing",
)


class NoChromiumError(RuntimeError):
    """No Chromium here starts; the message says what was tried."""


class Installer(NamedTuple):
    """One way to get a Chromium."""

    title: str
    commands: tuple[tuple[str, ...], ...]


def installed() -> Iterator[Path]:
    """Yield every Chromium and Chrome of this machine, the system's before Playwright's."""
    folders = os.pathsep.join((os.environ.get("PATH", ""), *_FOLDERS))
    found = [shutil.which(name, path=folders) for name in _NAMES]
    yield from dict.fromkeys(Path(program) for program in found if program)
    for folder in (Path("/Applications"), Path.home() / "Applications"):
        yield from (folder / program for program in _MAC_PROGRAMS if (folder / program).exists())
    downloaded = _downloaded()
    if downloaded.exists():
        yield downloaded


def _downloaded() -> Path:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        return Path(playwright.chromium.executable_path)


def driver_problem() -> str:
    """Say why Playwright itself doesn't start, or nothing where it does."""
    command = [sys.executable, "-m", "playwright", "--version"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    return last_line(run.stderr) if run.returncode else ""


def last_line(text: str) -> str:
    """Return the last line of what a program complained of."""
    lines = text.strip().splitlines()
    return lines[-1].strip() if lines else "it doesn't say why"


def problem(program: Path) -> str:
    """Start a Chromium and say why it doesn't work, or nothing where it does."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        page = "data:text/html,<p>ready</p>"
        command = [
            str(program),
            "--headless",
            *FLAGS,
            f"--user-data-dir={profile}",
            "--dump-dom",
            page,
        ]
        try:
            run = subprocess.run(
                command, capture_output=True, text=True, timeout=START_TIME, check=False
            )
        except subprocess.TimeoutExpired:
            return f"shows no page within {START_TIME} s"
        except OSError as error:
            return str(error)
    if "ready" in run.stdout:
        return ""
    return f"code {run.returncode}: {last_line(run.stderr)}"


def find() -> Path:
    """Return the Chromium that CHROMIUM names, or else the first of this machine that starts.

    Raises:
        NoChromiumError: if there is none, or if Playwright can't drive any.
    """
    if reason := driver_problem():
        raise NoChromiumError(f"Playwright doesn't start: {reason}")
    named = os.environ.get(VARIABLE)
    problems = []
    for program in [Path(named)] if named else installed():
        reason = problem(program)
        if not reason:
            return program
        problems.append(f"{program} doesn't start: {reason}")
    raise NoChromiumError("\n".join(problems) or "no Chromium or Chrome is installed")


def installers() -> Iterator[Installer]:
    """Yield the ways to install one on this machine, the least intrusive first."""
    root = () if os.geteuid() == 0 else ("sudo",)
    apt = (*root, "env", "DEBIAN_FRONTEND=noninteractive", "apt-get")
    dnf = (*root, "dnf", "install", "-y")
    playwright = (sys.executable, "-m", "playwright")
    if driver_problem() and shutil.which("apt-get"):
        commands = ((*apt, "update"), (*apt, "install", "-y", "libatomic1"))
        yield Installer("what Playwright needs from apt-get", commands)
    if driver_problem() and shutil.which("dnf"):
        yield Installer("what Playwright needs from dnf", ((*dnf, "libatomic"),))
    yield Installer("Playwright's download", ((*playwright, "install", "chromium"),))
    if shutil.which("brew"):
        yield Installer("Homebrew", (("brew", "install", "--cask", "google-chrome"),))
    if shutil.which("apt-get"):
        yield Installer("apt-get", ((*apt, "update"), (*apt, "install", "-y", "chromium")))
        yield Installer("Playwright's libraries", ((*playwright, "install-deps", "chromium"),))
    if shutil.which("dnf"):
        yield Installer("dnf", ((*dnf, "chromium"),))
    if shutil.which("pacman"):
        yield Installer("pacman", ((*root, "pacman", "-S", "--noconfirm", "chromium"),))


def install(installer: Installer) -> str:
    """Run an installer and say why it failed, or nothing where it didn't."""
    for command in installer.commands:
        say(f"  {' '.join(command)}")
        try:
            run = subprocess.run(
                command,
                stdin=subprocess.DEVNULL,
                stdout=sys.stderr,
                timeout=INSTALL_TIME,
                check=False,
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            return str(error)
        if run.returncode:
            return f"it failed with code {run.returncode}, see above"
    return ""


def find_or_install() -> Path:
    """Return a Chromium that starts; installs one where there is none.

    Raises:
        NoChromiumError: if none can be had, with everything that was tried.
    """
    try:
        return find()
    except NoChromiumError as error:
        if os.environ.get(VARIABLE):
            raise
        problems = [str(error)]
    say(f"The tests in a browser need Chromium: {problems[0]}.")
    for installer in installers():
        say(f"Trying {installer.title}:")
        try:
            if reason := install(installer):
                raise NoChromiumError(reason)
            return find()
        except NoChromiumError as error:
            problems.append(f"after {installer.title}: {error}")
            say(problems[-1])
    raise NoChromiumError("\n".join(problems))


def say(text: str) -> None:
    """Tell the person at the terminal; standard output is for the path alone."""
    print(text, file=sys.stderr, flush=True)


def main() -> int:
    """Print the path of a Chromium that starts."""
    try:
        print(find_or_install())
    except NoChromiumError as error:
        say(f"\nNo Chromium for the tests in a browser:\n{error}\n")
        say(f"Install Chromium or Chrome, or name one: {VARIABLE}=/path/to/chromium make test")
        say("The other tests: .venv/bin/python -m pytest --ignore tests/browser")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
