"""The notebooks of the documentation: kept without outputs, run as they are, their claims hold."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

from slidetune.server.notebook.display import PLOTLY

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))


def read(path: Path) -> nbformat.NotebookNode:
    return nbformat.read(path, as_version=4)  # type: ignore[no-untyped-call,no-any-return]


def code_cells(notebook: nbformat.NotebookNode) -> list[nbformat.NotebookNode]:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def test_there_are_two_notebooks() -> None:
    assert [path.stem for path in NOTEBOOKS] == [
        "epsilon-against-chattering",
        "tuning-against-a-log",
    ]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_outputs_and_asserts_what_it_claims(path: Path) -> None:
    notebook = read(path)
    nbformat.validate(notebook)  # type: ignore[no-untyped-call]
    cells = code_cells(notebook)
    assert {(cell.execution_count, len(cell.outputs)) for cell in cells} == {(None, 0)}
    assert sum("\nassert " in cell.source for cell in cells) >= 4


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_from_its_first_cell_to_its_last(path: Path, tmp_path: Path) -> None:
    folders = ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR")
    own = {name: str(tmp_path / name.lower()) for name in folders}
    own |= {"PYTHONPATH": str(ROOT), "JUPYTER_PLATFORM_DIRS": "1"}
    done = subprocess.run(
        [sys.executable, "-m", "tests.notebooks.execute", str(path), "executed.ipynb"],
        cwd=tmp_path,
        env={**os.environ, **own},
        capture_output=True,
        encoding="utf-8",
        timeout=1000,
    )
    assert done.returncode == 0, done.stderr
    notebook = read(tmp_path / "executed.ipynb")
    outputs = [output for cell in code_cells(notebook) for output in cell.outputs]
    assert [output for output in outputs if output.get("name") == "stderr"] == []
    shown = [output.data for output in outputs if output.output_type == "execute_result"]
    first, *_, last = shown
    assert {"text/html", "text/plain"} == set(first)  # the experiment
    assert {PLOTLY, "text/html", "text/plain"} == set(last)  # the run at the end
    assert "estimated error of the angles" in last["text/html"]
