"""The live plots on a screen that changes: no axis is ever drawn before it has its place."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Dashboard

RESIZE_THEN_CHOOSE = """
async ([height, tab]) => {
  const stage = document.querySelector('#plots .plots-stage');
  const resized = new Promise((resolve) => new ResizeObserver((_, watch) => {
    if (stage.clientHeight !== height) return;
    watch.disconnect();
    resolve();
  }).observe(stage));
  stage.style.flex = 'none';
  stage.style.height = `${height}px`;
  await resized;
  [...document.querySelectorAll('#plots [role=tab]')]
    .find((each) => each.textContent === tab).click();
}
"""
"""Gives the plots another height and other panels before the next frame is drawn."""


DRAW = """
async (turns) => {
  const [{figure, themeOf}, {PlotRedraw}] = await Promise.all([
    import('/static/plots/figure.js'), import('/static/plots/redraw.js'),
  ]);
  const graph = document.createElement('div');
  document.body.append(graph);
  const redraw = new PlotRedraw(graph);
  const x = Float32Array.from({length: 300}, (_, index) => index / 30);
  const lanes = ['A', 'B'];
  const known = {};
  const values = (lane, size, gap) => (known[[lane, size, gap]] ??= x.map((time, index) => (
    index > gap && index < gap + 9 ? NaN : size * Math.sin((2 + lane) * time)
  )));
  const curve = (lane, {size, second = size, gap, end, steps}) => ({
    trace: {lane: lanes[lane], role: 'actual'}, x, y: values(lane, lane ? second : size, gap),
    cross: end ? {x: end, y: 0, text: 'stopped'} : null, steps,
  });
  const sheet = (turn) => figure({
    panels: [0, 1].map((id) => ({
      panel: {id, title: `joint ${id}`, quantity: 'e', unit: 'rad', traces: []},
      curves: [0, 1].map((lane) => curve(lane, turn)), range: turn.range ?? [-1, 1],
    })),
    window: [0, 10], spectrum: false, marks: [], selected: 'A',
    colors: new Map(lanes.map((lane) => [lane, 'red'])),
    width: 600, height: 400, zoomed: new Map(), touch: false,
    theme: themeOf(document.body), title: '',
  });
  const library = window.Plotly;
  const asked = {count: 0};
  window.Plotly = {...library};
  for (const name of ['react', 'update', 'restyle']) {
    window.Plotly[name] = (...how) => { asked.count += 1; return library[name](...how); };
  }
  const watch = new MutationObserver(() => {});
  watch.observe(graph, {subtree: true, attributeFilter: ['d']});
  const seen = turns.map((turn) => {
    asked.count = 0;
    watch.takeRecords();
    redraw.draw(sheet(turn), {passing: turn.passing});
    const lines = [...graph.querySelectorAll('.js-line')].map((line) => line.getAttribute('d'));
    const crosses = [...graph.querySelectorAll('.point')]
      .map((point) => point.getAttribute('transform'));
    const touched = [...new Set(watch.takeRecords().map(({target}) => (
      target.closest('.trace')?.getAttribute('class')
    )))];
    return {asked: asked.count, lines, crosses, touched};
  });
  window.Plotly = library;
  graph.remove();
  return seen;
}
"""
"""Draws the same figure at one turn after the other; says what was drawn, and who drew it."""


def points(line: str) -> np.ndarray:
    """Return the corners of an SVG path in pixels. Shape (n, 2)."""
    return np.array([pair.split(",") for pair in re.findall(r"[^ML]+", line)], dtype=float)


def stairs(line: str) -> np.ndarray:
    """Return the corners of an SVG path of level and upright lines. Shape (n, 2)."""
    across, down, corners = 0.0, 0.0, []
    for kind, rest in re.findall(r"([MHVL])([^MHVL]+)", line):
        numbers = [float(number) for number in rest.split(",")]
        across = across if kind == "V" else numbers[0]
        down = down if kind == "H" else numbers[-1]
        corners.append((across, down))
    return np.array(corners)


def between(corners: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return the height of a curve at places across. Shape (n,)."""
    return np.interp(places, corners[:, 0], corners[:, 1])


def open_page(page: Page, dashboard: Dashboard) -> None:
    page.goto(dashboard.url)
    expect(page.locator("#plots path.js-line").nth(8)).to_be_attached()


def panels(page: Page) -> list[float]:
    """Return the heights of the axis lines of all panels, as far as they are numbers."""
    drawn = page.locator("#plots .ylines-above").evaluate_all(
        "lines => lines.map(line => line.getAttribute('d'))"
    )
    ends = [re.fullmatch(r"M[\d.]+,([\d.]+)V([\d.]+)", line) for line in drawn]
    return [float(end[2]) - float(end[1]) for end in ends if end]


def test_axes_that_come_with_another_size_and_no_data_have_a_place(
    page: Page, dashboard: Dashboard
) -> None:
    open_page(page, dashboard)
    page.keyboard.press("Space")
    expect(page.locator("#header")).to_contain_text("paused")
    page.keyboard.press("Backspace")
    expect(page.locator("#plots .plots-message:visible")).to_contain_text("No data yet")
    page.get_by_role("tab", name="Flange error").click()
    expect(page.locator("#plots .ylines-above")).to_have_count(1)
    page.evaluate(RESIZE_THEN_CHOOSE, [500, "Error"])
    expect(page.locator("#plots .ylines-above")).to_have_count(3)
    assert [round(height) for height in panels(page)] == [144] * 3


def test_a_stage_of_almost_no_width_waits_until_there_is_room(
    page: Page, dashboard: Dashboard
) -> None:
    open_page(page, dashboard)
    plots, clock = page.locator("#plots"), page.locator("#header .status-time")
    plots.evaluate("part => { part.style.width = '20px'; }")
    for _ in range(5):
        expect(clock).not_to_have_text(clock.inner_text())
    plots.evaluate("part => { part.style.width = ''; }")
    expect(page.locator("#plots .ylines-above")).to_have_count(3)
    assert len(panels(page)) == 3


def test_curves_in_passing_lie_where_the_library_draws_them(
    page: Page, dashboard: Dashboard
) -> None:
    open_page(page, dashboard)
    turns: list[dict[str, Any]] = [{"size": 0.5}, {"size": 0.9, "passing": True}, {"size": 0.9}]
    turns.append({"size": 0.7, "second": 0.9, "passing": True})
    first, passing, settled, still = page.evaluate(DRAW, turns)
    assert [each["asked"] for each in (first, passing, settled, still)] == [1, 0, 1, 0]
    # A curve that holds still is left alone.
    assert still["touched"] == [f"trace scatter traceactual-{panel}-0" for panel in range(2)]
    assert len(settled["lines"]) == 4
    places = np.linspace(0.0, 500.0, 900)
    for before, moved, drawn in zip(
        *(seen["lines"] for seen in (first, passing, settled)), strict=True
    ):
        assert between(points(moved), places) == pytest.approx(
            between(points(drawn), places), abs=0.15
        )
        assert np.abs(between(points(moved), places) - between(points(before), places)).max() > 20


def test_steps_in_passing_are_those_of_the_library(page: Page, dashboard: Dashboard) -> None:
    open_page(page, dashboard)
    turns = [{"size": 0.5}, {"size": 0.9, "passing": True}, {"size": 0.9}]
    seen = page.evaluate(DRAW, [{**turn, "steps": True} for turn in turns])
    assert [each["asked"] for each in seen] == [1, 0, 1]
    for moved, drawn in zip(seen[1]["lines"], seen[2]["lines"], strict=True):
        ours, theirs = stairs(moved), stairs(drawn)
        level = np.isclose(np.diff(ours[:, 1]), 0.0)
        assert np.all(level | np.isclose(np.diff(ours[:, 0]), 0.0))
        places = np.linspace(1.0, 500.0, 901)
        for corners in (ours, theirs):
            before = np.searchsorted(corners[:, 0], places, side="right") - 1
            assert corners[before, 1] == pytest.approx(
                ours[np.searchsorted(ours[:, 0], places, side="right") - 1, 1], abs=0.15
            )


def test_a_held_torque_is_steps_and_its_decimated_extremes_are_lines(
    page: Page, dashboard: Dashboard
) -> None:
    open_page(page, dashboard)
    drawn = page.evaluate(
        """async () => {
          const [{timePanels}, {Ring}, {YRanges}] = await Promise.all([
            import('/static/curves/panel_curves.js'), import('/static/curves/ring.js'),
            import('/static/curves/y_range.js'),
          ]);
          const ring = new Ring();
          const channels = ['wild', 'calm'].map((lane) => ({lane, group: 'tau', joint: 1}));
          ring.configure(channels);
          const rows = 4000;
          const data = new Float32Array(2 * rows);
          for (let row = 0; row < rows; row += 1) {
            data[row] = row % 2 ? 40 : -40;
            data[rows + row] = row / rows;
          }
          ring.append({rows, columns: 2, time: 0, dt: 0.001, revision: 1, epoch: 0, data});
          const traces = channels.map(({lane}) => ({
            lane, label: lane, places: [ring.place(lane, 'tau', 1)], role: 'actual', rule: 'value',
            scale: 1, held: true,
          }));
          traces.reverse();
          const panels = [{id: 'tau1', title: '', quantity: '', unit: '', traces}];
          const draw = (window, hold) => timePanels({
            ring, panels, window, pixels: 400, ranges: new YRanges(), freezes: new Map(), hold,
          })[0].curves.map(({trace, steps, y}) => ({
            lane: trace.lane, steps, low: Math.min(...y), high: Math.max(...y),
          }));
          return [draw([1, 1.02], 0.001), draw([0, 4], 0.001), draw([1, 1.02], 0)];
        }"""
    )
    close, whole, continuous = drawn
    assert [one["steps"] for one in close] == [True, True]
    assert [one["steps"] for one in whole + continuous] == [False] * 4
    # Neither loses its peaks, and the calm one lies in front of the block.
    for curves in drawn:
        assert [one["lane"] for one in curves] == ["wild", "calm"]
        assert (curves[0]["low"], curves[0]["high"]) == (-40, 40)


@pytest.mark.parametrize(
    "turn",
    [{"size": 0.4, "range": [-0.5, 0.5]}, {"size": 0.4, "end": 5}],
    ids=["another range", "a cross that moves"],
)
def test_the_library_draws_what_is_more_than_a_moved_curve(
    page: Page, dashboard: Dashboard, turn: dict[str, Any]
) -> None:
    open_page(page, dashboard)
    begin = {"size": 0.9, "end": 4} if "end" in turn else {"size": 0.9}
    seen = page.evaluate(DRAW, [begin, {**turn, "passing": True}, turn])
    assert seen[1]["asked"] == 1
    assert seen[1]["lines"] == seen[2]["lines"]
    assert seen[1]["crosses"] == seen[2]["crosses"]


def test_a_gap_that_comes_and_goes_in_passing_stays_a_gap(page: Page, dashboard: Dashboard) -> None:
    open_page(page, dashboard)
    whole, gap = {"size": 0.9}, {"size": 0.9, "gap": 100}
    seen = page.evaluate(DRAW, [whole, {**gap, "passing": True}, gap, {**whole, "passing": True}])
    assert [each["asked"] for each in seen] == [1, 0, 1, 1]
    assert [line.count("M") for line in seen[1]["lines"]] == [2] * 4
    assert [line.count("M") for line in seen[2]["lines"]] == [1] * 8
    assert seen[3]["lines"] == seen[0]["lines"]
