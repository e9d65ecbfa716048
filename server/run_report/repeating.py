"""How a report is made again: the command, what else that takes, and with which versions."""

from __future__ import annotations

import json
import platform
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version

from slidetune.robot.arm.known import arm_named
from slidetune.robot.arm.known_arm import is_own_name
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import link_to, read_link
from slidetune.robot.law_files.law_file import file_of
from slidetune.robot.laws import own_versions
from slidetune.robot.version import __version__

REPORT = "report.html"
YAML = "experiment.yaml"
"""Names of the files in the command."""


@dataclass(frozen=True)
class Repeating:
    """How a run is repeated.

    Attributes:
        preset: the shipped preset from which the experiment differs least, or an empty text.
        baseline: its experiment, the one that was run where there is no preset.
        same: whether the preset is the experiment, with nothing changed.
        command: the command.
        needs: what else it takes, in sentences.
    """

    preset: str
    baseline: Experiment
    same: bool
    command: str
    needs: tuple[str, ...]


def repeating(experiment: Experiment, since: float = 0.0, arm: Sequence[str] = ()) -> Repeating:
    """Return how an experiment's report is made again.

    Args:
        experiment: what was run.
        since: beginning of the span that the figures cover in [s].
        arm: the options that named the arm on the command line.
    """
    preset, baseline, needs = "", experiment, []
    try:
        link = link_to(experiment)
    except InvalidExperimentError:
        source = YAML
        needs.append(f"The experiment is too long for a link: save the YAML below as {YAML} first.")
    else:
        linked = read_link(link)
        preset, baseline, source = linked.preset, linked.baseline, link
    same = bool(preset) and _written(baseline) == _written(experiment)
    words = ["python", "-m", "slidetune", "run", preset if same else source]
    if since:
        words += ["--since", f"{since:.12g}"]
    for law, digest in own_versions(experiment.lanes).items():
        file = file_of(digest)
        words += ["--law", file]
        needs.append(
            f"The law {law} is one of its author's own, from the file {file}, which has to be "
            f"there: the first 16 digits of its SHA-256 are {digest}."
        )
    if is_own_name(experiment.robot.model):
        words += arm
        needs.append(_arm_text(experiment, bool(arm)))
    return Repeating(preset, baseline, same, shlex.join([*words, "--report", REPORT]), tuple(needs))


def _arm_text(experiment: Experiment, named: bool) -> str:
    arm = arm_named(experiment.robot.model)
    text = f"The arm {arm.name} is not one that ships: {arm.meaning}"
    if named:
        return f"{text} Its URDF has to be there."
    return f"{text} Where it is not kept, add --urdf FILE with its URDF."


def _written(experiment: Experiment) -> str:
    return json.dumps(
        experiment.document()
    )  # equal experiments may have their lanes in another order


def versions() -> dict[str, str]:
    """Return the versions of what the figures depend on, by name, and the machine's kind."""
    packages = {name: version(name) for name in ("numpy", "pin", "numba")}
    return {
        "slidetune": __version__,
        "Python": platform.python_version(),
        **packages,
        "on": f"{platform.system()} {platform.machine()}",
    }
