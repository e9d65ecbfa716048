"""Curves with fewer points, and the page that holds them."""

from __future__ import annotations

import json
import re

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from slidetune.server.report.figure_page import (
    Curve,
    Figure,
    Section,
    decimated,
    figure_page,
    html_table,
)

CURVES = arrays.arrays(float, st.integers(1, 300), elements=st.floats(-1e6, 1e6))


@given(CURVES, st.integers(1, 40))
def test_fewer_points_keep_ends_and_peaks(values: np.ndarray, buckets: int) -> None:
    rows = decimated(values, buckets)
    assert np.all(np.diff(rows) > 0)
    assert len(rows) <= 2 * buckets + 2
    assert {0, len(values) - 1} <= set(rows.tolist())
    kept = values[rows]
    assert (kept.min(), kept.max()) == (values.min(), values.max())


@given(CURVES, st.integers(0, 299))
def test_a_curve_ends_where_its_lane_stopped(values: np.ndarray, stop: int) -> None:
    values[stop:] = np.nan
    assert np.isfinite(values[decimated(values, 20)]).all()


def page(name: str) -> str:
    time = np.linspace(0.0, 1.0, 5)
    figure = Figure(name, name, name, (Curve(name, "#0072B2", time, time),))
    return figure_page(name, html_table([name], [[name]], name), [Section(name, (figure,))])


def test_no_name_can_become_markup() -> None:
    text = page("</script><b>&")
    assert "<b>" not in text.partition("<script>")[0]
    data = re.search(r'id="data">(.*?)</script>', text, re.DOTALL)
    assert data is not None
    assert json.loads(data[1])[0]["title"] == "</script><b>&"


def test_a_place_named_in_data_stays_data() -> None:
    assert page("<!--place:plotly-->").count("plotly.js v") == page("x").count("plotly.js v")
