"""The wheel installed as a tool: its command works in a folder of the user, whatever lies there."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np

import slidetune
from tests.deploy.conftest import Installation
from tests.deploy.served import address_of, get


def command(installation: Installation, folder: Path, *arguments: str) -> str:
    """Run the installed command in a folder; returns what it prints."""
    done = subprocess.run(
        [installation.bin / "slidetune", *arguments],
        cwd=folder,
        env=installation.settings(folder),
        capture_output=True,
        encoding="utf-8",
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    assert "Compiling" not in done.stderr
    return done.stdout


def test_the_command_tells_its_version(installation: Installation, hostile: Path) -> None:
    assert command(installation, hostile, "--version").strip() == slidetune.__version__


def test_the_command_runs_the_paper_to_the_last_digit(
    installation: Installation, hostile: Path
) -> None:
    report = json.loads(command(installation, hostile, "run", "paper", "--json", "-"))
    run = slidetune.simulate(slidetune.load_preset("paper"))
    assert list(report["lanes"]) == list(run.lanes)
    for name, lane in run.lanes.items():
        assert np.array_equal(report["lanes"][name]["metrics"]["mae"], lane.metrics.mae)
        accuracy = report["lanes"][name]["accuracy"]
        assert accuracy["error_estimate"] == lane.accuracy.error_estimate


def test_the_command_serves_the_page_and_ends_when_it_is_told_to(
    installation: Installation, hostile: Path
) -> None:
    log = hostile / "log"
    with log.open("wb") as file:
        process = subprocess.Popen(
            [installation.bin / "slidetune", "serve", "--no-browser", "--port", "0"],
            cwd=hostile,
            env=installation.settings(hostile),
            stdout=file,
            stderr=file,
        )
    try:
        address = address_of(process, log)
        status, page = get(address, "/")
        assert status == 200
        assert "<title>Slidetune" in page
        script = page.partition('src="')[2].partition('"')[0]
        assert get(address, script if script.startswith("/") else f"/{script}")[0] == 200
        status, health = get(address, "/api/health")
        assert (status, json.loads(health)["version"]) == (200, slidetune.__version__)
        process.terminate()
        assert process.wait(60) == 0
    finally:
        process.kill()
        process.wait()
    assert "Traceback" not in log.read_text(encoding="utf-8")
