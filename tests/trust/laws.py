"""Every law and switching function on one task, as a page's table: error, chattering, effort."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import typer

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import LaneRun, simulate
from tests.trust.report import provenance, record, table

Patch = dict[str, Any]

SETTLED = 1.0
"""From when on figures count in [s] (*ours*): the start is the same for all."""
_TORQUES = {"k1": [80, 80, 40, 8, 8, 8], "k2": [40, 40, 25, 5, 5, 5]}
_MODEL: Patch = {"law": "smc", "lambda_": 10, **_TORQUES}
_NETWORK: Patch = {"learning_rate": [160, 160, 80, 16, 16, 16], **_TORQUES}
_TERMINAL: Patch = {"nu": 10, "c": 1, "mu": 0.1, **_TORQUES}
_LAYER = {"epsilon": 0.06}
LANES: dict[str, tuple[Patch, str]] = {
    "RBFNN-NFTSM, tanh": ({"law": "rbfnn_nftsm", **_NETWORK, **_TERMINAL, **_LAYER}, ""),
    "RBFNN-SMC, tanh": ({"law": "rbfnn_smc", "lambda_": 10, **_NETWORK, **_LAYER}, ""),
    "NFTSM, tanh": ({"law": "nftsm", **_TERMINAL, **_LAYER}, ""),
    "SMC, sign": ({**_MODEL, "switching": "sign"}, "OpenSMC, MathWorks"),
    "SMC, tanh": ({**_MODEL, **_LAYER}, "MathWorks"),
    "SMC, saturation": ({**_MODEL, **_LAYER, "switching": "saturation"}, "OpenSMC, MathWorks"),
    "SMC, implicit": ({**_MODEL, "switching": "implicit"}, ""),
    "SMC, tanh, momentum observer": (
        {**_MODEL, **_LAYER, "k2": [4, 4, 2.5, 0.5, 0.5, 0.5], "observer": "momentum"},
        "",
    ),
    "super-twisting": ({"law": "super_twisting", "lambda_": 10}, "OpenSMC"),
    "integral SMC, tanh": (
        {"law": "integral_smc", "kp": 100, "kd": 20, "k1": 20, "k2": 20, "epsilon": 0.1},
        "OpenSMC, by saturation",
    ),
    "adaptive SMC, tanh": ({"law": "adaptive_smc", "lambda_": 10, "k1": 20, "k2": 100}, ""),
    "computed torque PD": ({"law": "computed_torque", "kp": 400, "kd": 40}, "OpenSMC"),
}
"""Gains of every row (*ours*), and who else has the law: OpenSMC 2.0, as ``make opensmc`` found,
and MathWorks' sliding-mode blocks (R2025a), as far as we know."""
_EXACT: Patch = {"disturbance": {"sensor_noise": {"position": 0.0, "velocity": 0.0}}}
_PROMPT: Patch = {"simulation": {"input_delay": 0.0}}
CONDITIONS: dict[str, tuple[Patch, ...]] = {
    "1 kHz": (_EXACT, _PROMPT),
    "1 kHz, lag": (_EXACT, _PROMPT, {"robot": {"lag": 0.004}}),
    "1 kHz, delay": (_EXACT,),
    "1 kHz, noise": (_PROMPT,),
    "1 kHz, all three": ({"robot": {"lag": 0.004}},),
    "250 Hz": (_EXACT, _PROMPT, {"simulation": {"control_rate": 250.0}}),
    "250 Hz, lag": (
        _EXACT,
        _PROMPT,
        {"robot": {"lag": 0.004}, "simulation": {"control_rate": 250.0}},
    ),
}
"""The preset ``realistic`` with what is named: a lag of 4 ms, its delay of 1 ms, its noise."""


def task(condition: str, lane: Patch) -> Experiment:
    """Return the experiment of one law in one condition."""
    experiment = load_preset("realistic")
    others = dict.fromkeys(experiment.lanes)
    experiment = experiment.patched({"lanes": {**others, "A": lane}})
    for patch in CONDITIONS[condition]:
        experiment = experiment.patched(patch)
    return experiment


def figures(run: LaneRun) -> str:
    """Return error, chattering and effort of a lane, or when it diverged."""
    if run.freeze is not None:
        return f"diverged at {run.freeze.time:.2g} s"
    found = run.metrics_since(SETTLED)
    error, effort = 1e3 * float(np.mean(found.mae)), float(np.linalg.norm(found.rms_torque))
    chattering = float(f"{found.chattering:.2g}")
    return f"{error:.2g} / {chattering:,.0f} / {effort:.0f}"


def rows() -> Iterator[list[str]]:
    """Yield every row of the table."""
    for name, (lane, known) in LANES.items():
        found = [
            figures(simulate(task(one, lane), estimate=False).lanes["A"]) for one in CONDITIONS
        ]
        yield [name, *found, known or "–"]


def main(keep: bool = typer.Option(False, "--record", help="Write docs/laws.md.")) -> None:
    """Run every law in every condition and print the table as Markdown."""
    shown = table(["law", *CONDITIONS, "also in"], list(rows()))
    shown += f"\n\n{provenance('python -m tests.trust.laws --record')}"
    typer.echo(shown)
    if keep:
        record("laws.md", "laws", shown)


if __name__ == "__main__":
    typer.run(main)
