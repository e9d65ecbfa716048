"""``make opensmc``: the laws that OpenSMC has, there and here, on its two-link arm.

Both sides hold the torque of a step of 0.1 ms over a Runge-Kutta step of the arm. OpenSMC runs in
an environment of its own, as the peers of ``make peers`` do.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, NamedTuple

import numpy as np
import typer
from rich.console import Console

from slidetune.server.report.run_bar import progress_bar
from tests.peers.environments import ROOT, Peer, UnavailablePeerError, interpreter, is_ready
from tests.peers.opensmc import ours
from tests.peers.opensmc.pairs import PAIRS, Pair
from tests.peers.opensmc.tasks import SECONDS, STEP, TASKS, Array
from tests.trust.report import provenance, record, table

OPENSMC = Peer("opensmc", "OpenSMC", "opensmc.theirs", "opensmc>=2,<3")
AGREEMENT = 1e-6
"""Greatest difference of an angle [rad] and of a torque [N m] that one law may have (*ours*)."""
HEADINGS = ("law here", "in OpenSMC", "angles [rad]", "torques [N·m]")


class Difference(NamedTuple):
    """How far one law is from the other.

    Attributes:
        name: key of ``PAIRS``.
        angle: greatest difference of an angle in [rad].
        torque: greatest difference of a torque in [N m].
    """

    name: str
    angle: float
    torque: float

    @property
    def agrees(self) -> bool:
        """Whether both are the same law."""
        return self.angle <= AGREEMENT and self.torque <= AGREEMENT


def their_runs(seconds: float) -> tuple[str, dict[str, Array]]:
    """Return OpenSMC's version, and its runs by pair and task.

    Raises:
        UnavailablePeerError: if it can't be installed or fails.
    """
    with TemporaryDirectory() as folder:
        file = Path(folder) / "runs.npz"
        command = [interpreter(OPENSMC), "-m", f"tests.peers.{OPENSMC.module}", str(seconds), file]
        environment = {**os.environ, "PYTHONPATH": ""}
        process = subprocess.run(
            command, cwd=ROOT, env=environment, capture_output=True, encoding="utf-8"
        )
        if process.returncode:
            said = process.stderr.strip().splitlines()
            raise UnavailablePeerError(f"it ended: {said[-1] if said else 'no reason given'}")
        with np.load(file) as runs:
            return str(runs["version"]), {name: runs[name] for name in runs if name != "version"}


def differences(theirs: dict[str, Array], seconds: float) -> Iterator[Difference]:
    """Run every law here and yield how far it is from the same one there."""
    for name, pair in PAIRS.items():
        apart = [
            np.abs(ours.run(pair.ours, key, seconds) - theirs[f"{name}|{key}"]).max(axis=0)
            for key in pair.tasks
        ]
        # A number that is none makes the greatest one none, and agrees with nothing.
        found = np.max(apart, axis=0)
        yield Difference(name, float(found[:2].max()), float(found[4:].max()))


def _known_as(pair: Pair) -> str:
    parts = [part[0] for part in (pair.theirs, pair.surface, pair.reaching) if part is not None]
    return ", ".join(f"`{part}`" for part in parts)


def main(
    write: Annotated[
        bool, typer.Option("--record", help="Write the table into docs/laws.md.")
    ] = False,
    seconds: Annotated[float, typer.Option(min=0.1, max=60.0, help="Length of a run.")] = SECONDS,
) -> None:
    """Run the laws that OpenSMC has, there and here."""
    console = Console()
    if not is_ready(OPENSMC):
        console.print(f"Installing OpenSMC into build/peers/{OPENSMC.name} …")
    try:
        with console.status("Its runs"):
            version, theirs = their_runs(seconds)
    except UnavailablePeerError as error:
        console.print(f"OpenSMC does not run here: {error}.", style="red", markup=False)
        raise typer.Exit(1) from None
    found: list[Difference] = []
    with progress_bar(console, "Our runs") as show:
        for one in differences(theirs, seconds):
            found.append(one)
            show(len(found) / len(PAIRS))
    rows = [
        [one.name, _known_as(PAIRS[one.name]), f"{one.angle:.0e}", f"{one.torque:.0e}"]
        for one in found
    ]
    motions = " and ".join(task.title for task in TASKS.values())
    about = (
        f"Greatest differences over {seconds:g} s in steps of {1e3 * STEP:g} ms from OpenSMC "
        f"{version}; motions: {motions}."
    )
    given = "" if seconds == SECONDS else f' ARGS="--seconds {seconds:g}"'
    body = "\n\n".join([table(HEADINGS, rows), about, provenance(f"make opensmc{given}")])
    console.print(body, markup=False, soft_wrap=True)
    if write:
        record("laws.md", "opensmc", body)
    strays = [one.name for one in found if not one.agrees]
    for name in strays:
        console.print(f"Not the same law: {name}", markup=False, style="red")
    raise typer.Exit(1 if strays else 0)


if __name__ == "__main__":
    typer.run(main)
