"""The Dockerfile's steps by hand: first process, no rights, a file system that can't be written."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import pytest

from tests.deploy.conftest import Installation
from tests.deploy.dockerfile import environment, of
from tests.deploy.served import address_of, get

SETUP = """
set -e
mount --make-rprivate /
for folder in "$TOP/tmp" "$TOP/data"; do mount -t tmpfs -o mode=1777 tmpfs "$folder"; done
mount -o remount,bind,ro /
! touch "$TOP/written" 2>/dev/null
cd "$TOP/data"
exec env -i "$@"
"""
"""As a container's runtime does it: all is read-only but two folders in memory."""


def allowed() -> str:
    """Why this can't be tried here, or an empty text."""
    if sys.platform != "linux" or os.getuid() != 0:
        return "needs root on Linux, for namespaces"
    missing = [name for name in ("unshare", "setpriv", "mount") if not shutil.which(name)]
    if missing:
        return f"needs {', '.join(missing)}"
    script = "mount --make-rprivate / && mount -o remount,bind,ro /"
    tried = subprocess.run(
        ["unshare", "--mount", "--pid", "--fork", "/bin/sh", "-c", script], capture_output=True
    )
    return "" if tried.returncode == 0 else f"namespaces are refused: {tried.stderr.decode()}"


def first_process(unshare: int) -> int:
    """Process outside of the namespace for the first one in it."""
    children = Path(f"/proc/{unshare}/task/{unshare}/children").read_text(encoding="ascii")
    (child,) = children.split()
    return int(child)


def test_the_image_serves_reads_only_and_ends_when_it_is_told_to(
    installation: Installation, tmp_path: Path
) -> None:
    if reason := allowed():
        pytest.skip(reason)
    (user,), (command,), (health,) = of("USER"), of("CMD"), of("HEALTHCHECK")
    top, log = installation.top, tmp_path / "log"
    for name in ("tmp", "data"):
        (top / name).mkdir(exist_ok=True)
    image = environment()
    settings = {
        "PATH": image["PATH"].replace("/opt/slidetune/bin", str(installation.bin)),
        "PYTHONDONTWRITEBYTECODE": image["PYTHONDONTWRITEBYTECODE"],
        "XDG_CACHE_HOME": str(installation.cache),
        "XDG_DATA_HOME": str(top / "data"),
        "TMPDIR": str(top / "tmp"),
    }
    settings["PATH"] = settings["PATH"].replace("$PATH", "/usr/bin:/bin")
    words = [word if word != "8000" else "0" for word in command.command()]
    # It may read what the interpreter of this test needs, wherever that lies; it may write nothing.
    rights = ["--inh-caps", "-all,+dac_read_search", "--ambient-caps", "+dac_read_search"]
    person = ["--reuid", user.text, "--regid", user.text, "--clear-groups", "--no-new-privs"]
    with log.open("wb") as file:
        process = subprocess.Popen(
            [
                *("unshare", "--mount", "--pid", "--fork", "--kill-child", "--mount-proc"),
                *("/bin/sh", "-c", SETUP, "sh"),
                *(f"{name}={value}" for name, value in settings.items()),
                *("setpriv", *person, *rights),
                *(str(installation.bin / "slidetune"), *words),
            ],
            env={**os.environ, "TOP": str(top)},
            stdout=file,
            stderr=file,
        )
    try:
        address = address_of(process, log)
        first = first_process(process.pid)
        _check_rights(first, int(user.text))
        _check_answers(address)
        _check_health(installation, health.command(), address)
        written = [path.name for path in Path(f"/proc/{first}/root{top}/tmp").iterdir()]
        assert f"slidetune-{user.text}" in written  # kernels, taken over from the image
        os.kill(first, signal.SIGTERM)
        assert process.wait(60) == 0
    finally:
        process.kill()
        process.wait()
    text = log.read_text(encoding="utf-8")
    assert "Traceback" not in text
    assert "Compiling" not in text  # the first start is a quick one
    assert not (top / "written").exists()


def _check_rights(first: int, user: int) -> None:
    """It is the first process of its namespace, and has neither root's number nor its rights."""
    lines = Path(f"/proc/{first}/status").read_text(encoding="ascii").splitlines()
    parts = [line.partition(":") for line in lines]
    status = {name: rest.split() for name, _, rest in parts}
    assert status["NSpid"][-1] == "1"
    assert set(status["Uid"]) == set(status["Gid"]) == {str(user)}
    assert status["NoNewPrivs"] == ["1"]


def _check_answers(address: str) -> None:
    """The token of its address opens the page and the studies; without one there is 401."""
    (token,) = parse_qs(urlsplit(address).query)["token"]
    assert get(address, "/")[0] == get(address, "/api/health")[0] == 401
    status, page = get(address, "/", token)
    assert status == 200
    assert "<title>Slidetune" in page
    assert get(address, "/api/studies", token)[0] == 200  # which are kept in the data folder


def _check_health(installation: Installation, command: list[str], address: str) -> None:
    """The image's own check passes while the server is there, and fails where there is none."""
    port = urlsplit(address).port
    program, option, script = command
    assert program == "python"
    python = installation.bin / program
    there = subprocess.run([python, option, script.replace("8000", str(port))], timeout=60)
    assert there.returncode == 0
    gone = subprocess.run(
        [python, option, script.replace("8000", "1")], timeout=60, capture_output=True
    )
    assert gone.returncode != 0
