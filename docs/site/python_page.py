"""The public face from Python, which mkdocstrings reads from the docstrings.

What `slidetune` exports is listed by itself. What its functions return, and raise, is listed here:
one line in `RETURNED` or `ERRORS` adds a class.
"""

from __future__ import annotations

import inspect
import shutil
from pathlib import Path

import slidetune
from docs.site.table import page

RETURNED = (
    "slidetune.robot.loop.simulate.LaneRun",
    "slidetune.robot.loop.metrics.Metrics",
    "slidetune.robot.loop.accuracy.Accuracy",
    "slidetune.server.notebook.tuned.Tuned",
    "slidetune.server.client.dashboard.Dashboard",
    "slidetune.server.client.telemetry.Telemetry",
    "slidetune.server.client.telemetry.TelemetryStream",
    "slidetune.server.client.whole_response.WholeResponse",
    "slidetune.server.client.whole_response.LaneResponse",
)
"""What the functions return, but for what `slidetune` itself exports."""
ERRORS = (
    "slidetune.robot.errors.SlidetuneError",
    "slidetune.robot.errors.InvalidExperimentError",
    "slidetune.robot.errors.FieldError",
    "slidetune.robot.errors.UnknownPresetError",
    "slidetune.robot.errors.PresetConflictError",
    "slidetune.robot.errors.PresetStorageError",
    "slidetune.robot.errors.LawChangedError",
    "slidetune.robot.loop.simulate.CancelledError",
    "slidetune.server.client.refusal.DashboardError",
)
"""What is raised on purpose."""


def exported() -> list[str]:
    """Return what `slidetune` exports and has a docstring of its own, functions first."""
    names = [name for name in slidetune.__all__ if not name.startswith("_")]
    functions = [name for name in names if inspect.isfunction(getattr(slidetune, name))]
    return [*functions, *(name for name in names if name not in functions)]


def _entries(names: list[str]) -> list[str]:
    return [f"::: {name}" for name in names]


def python_page() -> str:
    """Return the page of the Python interface; mkdocstrings puts the docstrings in."""
    return page(
        "# Python",
        "The stable face: what `slidetune` exports. Arrays are NumPy's, in SI units, with one row "
        "for each instant and one column for each joint. Whatever is refused raises an error that "
        "names the field, the value and what is allowed.",
        "## slidetune",
        *_entries([f"slidetune.{name}" for name in exported()]),
        "## What they return",
        *_entries(list(RETURNED)),
        "## Errors",
        *_entries(list(ERRORS)),
    )


def stage_sources(into: Path) -> None:
    """Copy the package for mkdocstrings: it follows no links, nor folders without `__init__.py`."""
    source = Path(slidetune.__file__).parent
    for path in sorted(source.iterdir()):
        if path.name in ("robot", "server"):
            shutil.copytree(
                path.resolve(),
                into / "slidetune" / path.name,
                ignore=lambda folder, names: [
                    name
                    for name in names
                    if name == "__pycache__"
                    or not (name.endswith(".py") or Path(folder, name).is_dir())
                ],
            )
        elif path.suffix == ".py":
            (into / "slidetune").mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, into / "slidetune" / path.name)
    for folder in [into / "slidetune", *(into / "slidetune").rglob("*/")]:
        if folder.is_dir():
            (folder / "__init__.py").touch()
