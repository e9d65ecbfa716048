"""The table of figures: whole, and the only place that says what a figure is."""

from __future__ import annotations

import json
import re
from dataclasses import FrozenInstanceError, fields
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.loop.accuracy import Accuracy
from slidetune.robot.loop.figures import FIGURES, STUDIED, Figure, Source, figures_of
from slidetune.robot.loop.metrics import Metrics, no_figures
from slidetune.robot.margins.margin import Margin

ROOT = Path(__file__).resolve().parents[3]
TABLE = ROOT / "robot" / "loop" / "figures.py"
COMMENT = re.compile(r"/\*.*?\*/|^\s*//.*?$", re.DOTALL | re.MULTILINE)
KEYS = {*FIGURES, *get_args(Source)}
SIX = np.arange(1.0, JOINTS + 1.0)


def sources() -> dict[Path, str]:
    """Every file of code beside the table, without the comments of scripts."""
    files = [path for top in ("robot", "server", "web") for path in (ROOT / top).rglob("*.*")]
    code = [path for path in files if path.suffix in (".py", ".js", ".html") and path != TABLE]
    return {path: COMMENT.sub("", path.read_text(encoding="utf-8")) for path in code}


def test_every_figure_of_a_run_has_an_entry_and_every_entry_is_a_figure() -> None:
    assert [figure.name for figure in figures_of("run")] == [each.name for each in fields(Metrics)]
    margin = Margin(radius=0.5, bounded=True, gamma=0.1, limit=2.0)
    assert {figure.name for figure in figures_of("accuracy")} <= Accuracy().document().keys()
    assert {figure.name for figure in figures_of("margin")} <= margin.document().keys()


@pytest.mark.parametrize("figure", figures_of("run"), ids=lambda figure: figure.name)
def test_an_entry_says_truly_whether_there_are_six(figure: Figure) -> None:
    value = getattr(no_figures(6), figure.name)
    assert figure.per_joint == (np.shape(value) == (JOINTS,))
    assert (figure.reduced != "none") == figure.per_joint


@pytest.mark.parametrize("figure", FIGURES.values(), ids=lambda figure: figure.name)
def test_an_entry_is_whole(figure: Figure) -> None:
    assert figure.title
    assert figure.short
    assert figure.meaning[0].isupper()
    assert not figure.meaning.endswith(".")
    assert (figure.factor == 1.0) == (figure.unit == figure.shown_unit)
    assert figure.digits >= 1
    # Of a column the live table says why it is empty there.
    assert bool(figure.not_live) == (figure.column and not figure.live)
    assert figure.column or not (figure.extra or figure.unknown)
    json.dumps(figure.document(), allow_nan=False)


def test_the_table_can_not_be_changed() -> None:
    entries: Any = FIGURES
    with pytest.raises(TypeError):
        entries["mae"] = FIGURES["max_error"]
    with pytest.raises(FrozenInstanceError):
        FIGURES["mae"].title = "x"  # type: ignore[misc]


def test_six_become_one_as_the_entry_says() -> None:
    assert FIGURES["mae"].overall(SIX) == 3.5
    assert FIGURES["max_error"].overall(SIX) == 6.0
    assert FIGURES["chattering"].overall(7.0) == 7.0
    assert FIGURES["high_frequency_torque"].overall(None) is None
    assert FIGURES["reaching_time"].overall((0.1, None, 0.2, 0.3, 0.4, 0.5)) is None


def test_less_is_better_of_every_figure_by_which_gains_are_judged() -> None:
    assert STUDIED
    assert {FIGURES[name].better for name in STUDIED} == {"less"}
    assert {FIGURES[name].source for name in STUDIED} == {"run"}


def test_no_other_file_says_what_a_figure_means() -> None:
    for path, text in sources().items():
        said = [figure.name for figure in FIGURES.values() if figure.meaning in text]
        assert said == [], path


def test_no_other_file_names_a_figure_for_people() -> None:
    found = []
    for path, text in sources().items():
        for figure in FIGURES.values():
            # Keys have to stand where they are asked for, and a letter may be anybody's.
            named = {figure.title, figure.short, figure.symbol} - KEYS
            quoted = {rf"['\"`]{re.escape(name)}[ '\"`]" for name in named if len(name) > 1}
            found += [(path, name) for name in quoted if re.search(name, text)]
    assert found == []


def test_no_page_and_no_report_converts_a_figure_by_itself() -> None:
    """No curve is drawn in mrad: where that stands, a figure is written."""
    copies = [
        path.relative_to(ROOT).as_posix()
        for path, text in sources().items()
        if not path.is_relative_to(ROOT / "robot") and re.search(r"\bmrad", text)
    ]
    assert copies == []
