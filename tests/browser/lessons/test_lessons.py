"""Lessons as a learner goes through them, in a real Chromium."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.loop.metrics import measure_lane
from slidetune.server.compute.arm_kernels import load_kernels
from tests.browser.conftest import Dashboard

DEADLINE = 60.0


@pytest.fixture
def learner(dashboard: Dashboard, page: Page) -> Page:
    """The dashboard's page with the list of lessons open, opened by key."""
    page.goto(dashboard.url)
    expect(page.locator(".lane")).to_have_count(3)
    page.keyboard.press("l")
    expect(page.locator(".lesson-row")).to_have_count(10)
    return page


def begin(page: Page, name: str) -> None:
    page.locator(f"[data-lesson={name}]").click()
    at_step(page, 1)


def at_step(page: Page, number: int) -> None:
    expect(page.locator(".lesson-title small")).to_contain_text(f"Step {number} of")
    expect(page.locator(".lesson-title")).to_be_focused()
    expect(page.locator(".lesson[data-waiting]")).to_have_count(0)


def live(dashboard: Dashboard) -> dict[str, Any]:
    experiment: dict[str, Any] = dashboard.client.get("api/experiment").json()["experiment"]
    return experiment


def chattering(dashboard: Dashboard, lane: str, since: float) -> float:
    """Return a lane's chattering once the session has run for so long since its reset."""
    end = time.monotonic() + DEADLINE
    while dashboard.client.get("api/session").json()["time"] < since:
        assert time.monotonic() < end
        time.sleep(0.1)
    while lane not in (lanes := dashboard.client.get("api/metrics").json()["lanes"]):
        assert time.monotonic() < end
        time.sleep(0.1)
    value: float = lanes[lane]["total"]["chattering"]
    return value


def test_the_lesson_on_chattering_goes_to_its_end_and_back(
    learner: Page, dashboard: Dashboard
) -> None:
    page, before = learner, live(dashboard)
    steps = dashboard.client.get("api/lessons/chattering").json()["steps"]
    begin(page, "chattering")
    for number, step in enumerate(steps, start=1):
        at_step(page, number)
        question = step["question"]
        if question:
            # The prediction comes first: until then everything is as the last step left it.
            assert live(dashboard) == steps[number - 2]["experiment"]
            guess = question["answer"] if number % 2 else 0
            page.locator(".lesson-choice").nth(guess).click()
            page.get_by_role("button", name="See what happens").click()
            verdict = "Right." if guess == question["answer"] else "Not quite."
            expect(page.locator(".lesson-verdict")).to_contain_text(verdict)
            expect(page.locator(".lesson-choice.is-answer")).to_contain_text("what happens")
            expect(page.locator(".lesson-reveal")).to_contain_text(question["explanation"][0][:40])
        assert live(dashboard) == step["experiment"]
        if step["view"]:
            tab = page.get_by_role("tab", name=step["view"].capitalize(), exact=True)
            expect(tab).to_have_attribute("aria-selected", "true")
        if number == 2:
            assert chattering(dashboard, "sign", 1.0) > 100_000
            assert chattering(dashboard, "tanh", 1.0) < 1_000
        if number < len(steps):
            page.keyboard.press("ArrowRight")
    page.get_by_role("button", name="Finish").click()
    expect(page.locator("[data-lesson=chattering]")).to_contain_text("done")
    assert live(dashboard) == before
    expect(page.locator(".preset-name")).to_have_text("paper")


PANELS = """() => {
  const graph = document.querySelector('#plots .plots-graph');
  if (!graph?.data) return null;
  const [from, to] = graph.layout.xaxis.range;
  const lines = graph.data.filter(({yaxis, mode, uid}) => (
    yaxis === 'y' && mode === 'lines' && uid.startsWith('actual')));
  return {samples: Math.round(1000 * (to - from)), points: lines.map(({x}) => x.length),
    shapes: lines.map(({line}) => line.shape), names: lines.map(({name}) => name)};
}"""
"""What the first panel of the live plots shows."""


def panels(page: Page, **wanted: Any) -> dict[str, Any]:
    """Return what the plots show once they show this."""
    end = time.monotonic() + DEADLINE
    while not (seen := page.evaluate(PANELS)) or not wanted.items() <= seen.items():
        assert time.monotonic() < end, seen
        time.sleep(0.1)
    shown: dict[str, Any] = seen
    return shown


def test_the_lesson_on_chattering_zooms_to_twenty_steps_of_torque_and_lets_go(
    learner: Page, dashboard: Dashboard
) -> None:
    page = learner
    begin(page, "chattering")
    page.keyboard.press("ArrowRight")
    at_step(page, 2)
    page.get_by_role("button", name="Skip the guess").click()
    expect(page.locator(".lesson-verdict")).to_contain_text("What happens")
    # The block of the lane that chatters lies behind, the calm lane in front.
    panels(page, samples=10_000, names=["sign", "tanh"])
    page.keyboard.press("ArrowRight")
    at_step(page, 3)
    close = panels(page, samples=20)
    assert close["shapes"] == ["hv", "hv"]
    assert close["points"] == [21, 21]
    page.get_by_role("button", name="Close").click()
    expect(page.locator(".lesson")).to_have_count(0)
    panels(page, samples=10_000)


def test_a_quoted_figure_stands_beside_the_live_one_of_the_same_time(
    learner: Page, dashboard: Dashboard
) -> None:
    page = learner
    dashboard.client.patch("api/session", json={"speed": 10.0}).raise_for_status()
    lesson = dashboard.client.get("api/lessons/chattering").json()
    for number, kind in ((1, "figures"), (2, "question")):
        page.keyboard.press("ArrowRight") if number > 1 else begin(page, "chattering")
        at_step(page, number)
        if kind == "question":
            page.get_by_role("button", name="Skip the guess").click()
        step = lesson["steps"][number - 1]
        figures = step["figures"] if kind == "figures" else step["question"]["figures"]
        rows = page.locator(".lesson-figures tbody tr")
        expect(rows).to_have_count(len(figures))
        expect(page.locator(".lesson-figures .is-final")).to_have_count(
            len(figures), timeout=60_000
        )
        for row, figure in zip(rows.all(), figures, strict=True):
            text = row.locator("td").last.inner_text().split()[0]
            shown = float(text.replace(",", ""))
            assert ("," in text) == (shown >= 10_000)
            number = float(figure["quoted"].strip("<> ").replace(",", ""))
            if figure["quoted"].startswith(">"):
                assert shown > number
            else:
                assert shown == pytest.approx(number, rel=0.025)


def test_a_lesson_can_be_left_at_any_step_and_survives_a_reload(
    learner: Page, dashboard: Dashboard
) -> None:
    page, before = learner, live(dashboard)
    begin(page, "convergence")
    page.keyboard.press("ArrowRight")
    at_step(page, 2)
    # An open question doesn't let one pass, and arrows choose among its answers.
    page.keyboard.press("ArrowRight")
    expect(page.locator(".lesson-choice input").first).to_be_focused()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    expect(page.locator(".lesson-verdict")).to_contain_text("three quarters")
    page.reload()
    expect(page.locator(".lesson-verdict")).to_contain_text("three quarters")
    page.get_by_role("button", name="Close").click()
    expect(page.locator(".lesson")).to_have_count(0)
    assert live(dashboard) == before
    page.keyboard.press("l")
    expect(page.locator("[data-lesson=convergence]")).to_contain_text("step 2 of")


def test_what_was_tuned_in_a_lesson_can_be_kept(learner: Page, dashboard: Dashboard) -> None:
    page = learner
    begin(page, "sliding-surface")
    number = len(dashboard.client.get("api/lessons/sliding-surface").json()["steps"])
    for step in range(1, number):
        if page.locator(".lesson-guess").count():
            page.get_by_role("button", name="Skip the guess").click()
            expect(page.locator(".lesson-verdict")).to_contain_text("What happens")
        page.get_by_role("button", name="Next", exact=True).click()
        at_step(page, step + 1)
    page.get_by_role("button", name="Keep this experiment").click()
    expect(page.locator(".lesson-row")).to_have_count(10)
    assert list(live(dashboard)["lanes"]) == ["NFTSM"]


@pytest.mark.parametrize("width", [1440, 390])
def test_a_step_opens_its_lens_and_the_next_its_plots(
    learner: Page, dashboard: Dashboard, width: int
) -> None:
    page = learner
    page.set_viewport_size({"width": width, "height": 844})
    begin(page, "drive-lag")
    page.get_by_role("button", name="Next", exact=True).click()
    at_step(page, 2)
    page.get_by_role("button", name="Skip the guess").click()
    page.get_by_role("button", name="Next", exact=True).click()
    at_step(page, 3)
    expect(page.get_by_role("heading", name="What the pencil says")).to_be_visible()
    table = page.get_by_role("region", name="Limit cycles of the joints")
    expect(table.locator("tbody tr")).to_have_count(6, timeout=60_000)
    page.get_by_role("button", name="Next", exact=True).click()
    at_step(page, 4)
    expect(table).to_be_hidden()
    expect(page.get_by_role("tab", name="Torque", exact=True).first).to_be_visible()


SIZES = [(1440, 900), (1024, 768), (420, 860)]


def test_a_lesson_covers_no_other_part_of_the_screen(learner: Page) -> None:
    page = learner
    begin(page, "chattering")
    for width, height in SIZES:
        page.set_viewport_size({"width": width, "height": height})
        lesson = page.locator(".lesson").bounding_box()
        assert lesson is not None
        boxes = [
            box
            for part in page.locator(".workspace > .part, .workspace > .transport").all()
            if (box := part.bounding_box()) is not None
        ]
        assert len(boxes) >= 2
        for box in boxes:
            beside = box["x"] >= lesson["x"] + lesson["width"] - 1
            above = box["y"] + box["height"] <= lesson["y"] + 1
            below = box["y"] >= lesson["y"] + lesson["height"] - 1
            assert beside or above or below, (width, box, lesson)


def test_the_torque_of_the_live_session_is_measured_as_that_of_a_run(
    page: Page, dashboard: Dashboard
) -> None:
    page.goto(dashboard.url)
    # In multiples of 0.004 N m: a number of half the bits is on the same side of the deadband.
    steps = np.random.default_rng(7).integers(-4, 5, size=(1500, JOINTS))
    torque = 0.004 * np.cumsum(steps, axis=0)
    columns = dict.fromkeys(("e", "de", "S"), np.zeros_like(torque))
    columns |= dict.fromkeys(("flange", "flange_desired"), np.zeros((len(torque), 3)))
    time = 0.001 * np.arange(len(torque))
    figures = measure_lane(time, {**columns, "tau": torque}, np.ones(JOINTS), 50.0)
    shown = page.evaluate(
        """async (torque) => {
          const [{measured}, {Ring}] = await Promise.all([
            import('/static/lessons/measure.js'), import('/static/curves/ring.js')]);
          const ring = new Ring();
          const joints = torque.map((_, index) => index + 1);
          ring.configure(joints.map((joint) => ({lane: 'A', group: 'tau', joint})));
          const rows = torque[0].length;
          const data = new Float32Array(torque.flat());
          ring.append(
            {rows, columns: joints.length, time: 0, dt: 0.001, revision: 1, epoch: 0, data});
          const whole = {lane: 'A', since: 0, until: (rows - 1) * 0.001, at: null, factor: 1};
          return ['switches', 'rms_torque'].map((metric) => [
            ...joints.map((joint) => measured(ring, {...whole, metric, joint}).value),
            ...['greatest', 'mean'].map((reduced) => (
              measured(ring, {...whole, metric, joint: null, reduced}).value)),
          ]);
        }""",
        torque.T.tolist(),
    )
    for name, found in zip(("switches", "rms_torque"), shown, strict=True):
        known = getattr(figures, name)
        np.testing.assert_allclose(found, [*known, known.max(), known.mean()], rtol=1e-5)
    assert (figures.switches > 50.0).all()


def test_a_lesson_about_another_arm_begins_and_gives_the_former_one_back(
    learner: Page, dashboard: Dashboard
) -> None:
    load_kernels("pendulum")
    page, before = learner, live(dashboard)
    begin(page, "sliding-surface")
    expect(page.locator(".arm-name")).to_have_text("Pendulum")
    page.get_by_role("button", name="Next", exact=True).click()
    at_step(page, 2)
    page.get_by_role("button", name="Close").click()
    expect(page.locator(".arm-name")).to_have_text("JAKA Zu 5")
    expect(page.locator(".lesson")).to_have_count(0)
    assert live(dashboard) == before
