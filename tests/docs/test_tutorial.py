"""The figures that the tutorial quotes are those of its runs."""

from __future__ import annotations

from typing import Any

import numpy as np

from docs.site.written_pages import DOCS
from slidetune import Experiment, load_preset, simulate
from slidetune.robot.loop.metrics import Metrics

PAGE = " ".join((DOCS / "tutorial.md").read_text(encoding="utf-8").split())
LANE = "RBFNN-NFTSM"


def metrics(experiment: Experiment, lane: str, since: float = 0.0) -> Metrics:
    run = simulate(experiment, estimate=False).lanes[lane]
    return run.metrics_since(since) if since else run.metrics


def milli(values: Any) -> list[str]:
    """Return three digits of each number, in thousandths."""
    return [f"{1000 * value:#.3g}".rstrip(".") for value in values]


def test_the_errors_before_and_after_are_those_of_the_runs() -> None:
    paper = load_preset("paper")
    one, two, three = milli(metrics(paper, LANE).mae[:3])
    assert f"were {one}, {two} and {three} mrad" in PAGE
    stiffer = paper.patched({"lanes": {LANE: {"nu": 30}}})
    one, two, three = milli(metrics(stiffer, LANE).mae[:3])
    assert f"they are {one}, {two} and {three} mrad" in PAGE
    gains = paper.document()["lanes"][LANE]
    assert f"that is {gains['c'] / gains['nu']:.0f} s, so" in PAGE
    assert f"With ν = 30 it is {gains['c'] / 30:.2f} s" in PAGE


def test_without_a_disturbance_the_law_with_the_model_is_exact() -> None:
    calm = load_preset("paper").patched({"disturbance": {"constant": 0}})
    assert "below a microradian" in PAGE
    assert metrics(calm, "NFTSM").mae.max() < 1e-6
    one, two, three = milli(metrics(calm, LANE).mae[:3])
    assert f"{one}, {two} and {three} mrad for RBFNN-NFTSM" in PAGE


def test_the_sign_chatters_as_much_as_it_says() -> None:
    sampled = load_preset("chattering-sign")
    sign, tanh = (metrics(sampled, name, 1.0) for name in ("sign", "tanh"))
    varies = [f"{one.chattering / 1000:.3g}".lstrip() for one in (sign, tanh)]
    assert f"varies by {varies[0]} kN·m/s" in PAGE
    assert f"by {float(varies[1]):.2f} kN·m/s" in PAGE
    errors = [f"{1000 * np.mean(one.mae):.2f}" for one in (sign, tanh)]
    assert f"{errors[0]} against {errors[1]} mrad on average, from 1 s on" in PAGE
