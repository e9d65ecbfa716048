"""What `slidetune` offers to Python is kept stable: names, signatures and fields of its results.

A change here is a change for everybody's scripts: add, and say so in the changelog; don't rename.
"""

from __future__ import annotations

import dataclasses
import inspect
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import pytest

import slidetune
from slidetune.robot.loop.simulate import LaneRun
from slidetune.server.client.dashboard import Dashboard
from slidetune.server.client.whole_response import LaneResponse, WholeResponse
from slidetune.server.notebook.tuned import Judged, Tuned

FUNCTIONS = {
    "connect": "(address: 'str' = 'http://127.0.0.1:8000/', token: 'str | None' = None)"
    " -> 'Dashboard'",
    "load_preset": "(name_or_path: 'str | os.PathLike[str]') -> 'Experiment'",
    "save_preset": "(name: 'str', experiment: 'Experiment', overwrite: 'bool' = False) -> 'Path'",
    "simulate": "(experiment: 'Experiment', progress: 'Tell | None' = None,"
    " stop: 'Array | None' = None, estimate: 'bool' = True) -> 'Run'",
    "tune": "(experiment: 'Experiment', lane: 'str | None' = None, *,"
    " gains: 'Mapping[str, tuple[float, float] | Mapping[str, Any]] | None' = None,"
    " trials: 'int | None' = None, draws: 'int | None' = None, sampler: 'str | None' = None,"
    " judged_by: 'str | None' = None, quiet: 'bool | None' = None, seed: 'int | None' = None,"
    " workers: 'int | None' = None, progress: 'Callable[[Tuned], object] | None' = None)"
    " -> 'Tuned'",
}
METHODS = {
    "close": "(self) -> 'None'",
    "load": "(self, preset: 'str') -> 'Experiment'",
    "metrics": "(self) -> 'dict[str, Any]'",
    "patch": "(self, patch: 'Document') -> 'Experiment'",
    "pause": "(self) -> 'None'",
    "play": "(self) -> 'None'",
    "preview": "(self, patch: 'Document | None' = None, experiment: 'Experiment | None' = None)"
    " -> 'WholeResponse'",
    "record": "(self, seconds: 'float') -> 'Telemetry'",
    "replace": "(self, experiment: 'Experiment | Document') -> 'Experiment'",
    "reset": "(self, lane: 'str | None' = None) -> 'None'",
    "telemetry": "(self) -> 'TelemetryStream'",
}
OF_EXPERIMENT = {
    "document": "(self) -> 'dict[str, Any]'",
    "from_document": "(document: 'Mapping[str, Any]') -> 'Experiment'",
    "patched": "(self, patch: 'Mapping[str, Any]') -> 'Experiment'",
}
FIELDS: dict[type, str] = {
    slidetune.Run: "experiment time q_d v_d lanes",
    LaneRun: "q v tau S f weights final_weights e de flange flange_desired layer high_frequency "
    "freeze time accuracy",
    Tuned: "experiment settings trials interrupted",
    Judged: "number gains figures ratios score kept diverged_at draws",
    WholeResponse: "revision horizon lanes",
    LaneResponse: "time columns metrics frozen accuracy goals",
}


def methods(kind: type) -> dict[str, str]:
    """Signatures of what a class has of its own for others, by name."""
    found = {name: getattr(kind, name) for name in vars(kind) if not name.startswith("_")}
    return {name: str(inspect.signature(one)) for name, one in found.items() if callable(one)}


def test_the_names_are_these() -> None:
    classes = ["Experiment", "Run", "__version__"]
    assert sorted(slidetune.__all__) == sorted([*FUNCTIONS, *classes])
    assert {name for name in FUNCTIONS if not callable(getattr(slidetune, name))} == set()


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_function_is_called_as_before(name: str) -> None:
    function: Callable[..., Any] = getattr(slidetune, name)
    assert str(inspect.signature(function)) == FUNCTIONS[name]
    assert inspect.getdoc(function)


def test_methods_are_called_as_before() -> None:
    assert methods(Dashboard) == METHODS
    mine = methods(slidetune.Experiment)
    assert {name: mine[name] for name in OF_EXPERIMENT} == OF_EXPERIMENT
    assert methods(Tuned) == {"document": "(self) -> 'dict[str, Any]'"}
    properties = {name for name, one in vars(Tuned).items() if isinstance(one, property)}
    assert properties >= {"best", "before", "after", "columns"}


@pytest.mark.parametrize("kind", FIELDS)
def test_results_have_the_same_fields_and_tell_what_each_is(kind: type) -> None:
    assert [field.name for field in dataclasses.fields(kind)] == FIELDS[kind].split()
    told = inspect.getdoc(kind) or ""
    assert {name for name in FIELDS[kind].split() if f"{name}: " not in told} == set()


def test_the_name_alone_loads_neither_the_server_nor_a_sampler() -> None:
    script = "import sys, slidetune; print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    loaded = set(done.stdout.split())
    assert "slidetune.robot.loop.simulate" in loaded
    slow = {"fastapi", "httpx", "optuna", "plotly", "viser", "slidetune.server.notebook"}
    assert loaded & slow == set()
