"""The lenses of the right column, in a real Chromium."""

from __future__ import annotations

import re
import time
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Locator, Page, Request, expect

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import LaneRun, simulate
from tests.browser.conftest import Dashboard

LANE = "RBFNN-NFTSM"
DEADLINE = 60.0
SHORT = {"simulation": {"horizon": 1.0}}


def experiment(dashboard: Dashboard) -> dict[str, Any]:
    document: dict[str, Any] = dashboard.client.get("api/experiment").json()["experiment"]
    return document


def patch(dashboard: Dashboard, change: dict[str, Any]) -> int:
    revision: int = dashboard.client.patch("api/experiment", json=change).json()["revision"]
    return revision


def run_of(dashboard: Dashboard, lane: str) -> LaneRun:
    return simulate(Experiment.from_document(experiment(dashboard))).lanes[lane]


def until(dashboard: Dashboard, lane: str, gain: str, value: Any) -> None:
    end = time.monotonic() + DEADLINE
    while (now := experiment(dashboard)["lanes"][lane][gain]) != value:
        assert time.monotonic() < end, f"{lane}.{gain} stayed {now}"
        time.sleep(0.05)


def open_lens(page: Page, dashboard: Dashboard, title: str, preset: str = "paper") -> None:
    """Open the page on a lens, with runs of one second."""
    dashboard.client.post(f"api/presets/{preset}/load")
    revision = patch(dashboard, SHORT)
    page.goto(dashboard.url)
    page.get_by_role("tab", name="Lenses").click()
    page.get_by_role("tab", name=title).click()
    looked(page, revision)


def looked(page: Page, revision: int) -> None:
    expect(page.locator(".lens-status")).to_have_text(f"whole response, rev {revision}")
    expect(page.locator(".lenses.is-busy")).to_have_count(0)


def card(page: Page, title: str) -> Locator:
    return page.get_by_role("region", name=title)


def fact(page: Page, title: str, name: str) -> Locator:
    facts = card(page, title).locator(".lens-facts > div")
    return facts.filter(has=page.get_by_text(name, exact=True)).locator("dd")


def trace(page: Page, title: str, uid: str) -> dict[str, Any]:
    """Return a trace of a card's picture, once it is drawn."""
    graph = card(page, title).locator(".lens-graph").first
    expect(graph.locator(".main-svg").first).to_be_attached()
    found: dict[str, Any] = graph.evaluate(
        "(graph, uid) => { const one = graph.data.find((each) => each.uid === uid);"
        " return {x: [...one.x], y: [...one.y], mode: one.mode ?? ''}; }",
        uid,
    )
    return found


def test_right_column_is_switched_by_tabs_and_arrow_keys(page: Page, dashboard: Dashboard) -> None:
    open_lens(page, dashboard, "Sliding mode")
    tab = page.get_by_role("tab", name="Lenses")
    expect(tab).to_have_attribute("aria-selected", "true")
    expect(page.locator(".plots-stage").first).to_be_hidden()
    tab.focus()
    page.keyboard.press("Home")
    expect(page.get_by_role("tab", name="Live", exact=True)).to_be_focused()
    expect(page.locator(".plots-stage").first).to_be_visible()
    expect(page.locator(".lenses")).to_be_hidden()
    page.keyboard.press("End")
    page.reload()
    expect(page.get_by_role("tab", selected=True).first).not_to_have_text("Live")


def test_sliding_lens_shows_the_run_of_simulate(page: Page, dashboard: Dashboard) -> None:
    open_lens(page, dashboard, "Sliding mode")
    run = run_of(dashboard, LANE)
    page.keyboard.press("2")
    button = page.locator(".lens-choice", has_text="2")
    expect(button.first).to_have_attribute("aria-pressed", "true")
    expect(page.locator(".lens-words").first).to_contain_text("joint 2")
    inside = 100 * np.mean(np.abs(run.S[:, 1]) <= run.layer[1])
    shown = fact(page, "Where the error goes", "inside")
    expect(shown).to_have_text(f"{inside:.0f} % of the time")
    # Words are there at once, a picture with the next frame that has time for it.
    last, end = pytest.approx((run.e[-1, 1], run.de[-1, 1]), rel=1e-5), time.monotonic() + DEADLINE
    shown = None
    while shown != last:
        assert time.monotonic() < end, (shown, last)
        page.wait_for_timeout(50)
        path = trace(page, "Where the error goes", "path")
        shown = path["x"][-1], path["y"][-1]


def test_live_point_moves_and_stays_on_its_lane(page: Page, dashboard: Dashboard) -> None:
    open_lens(page, dashboard, "Sliding mode")
    title, end = "Where the error goes", time.monotonic() + DEADLINE
    before = trace(page, title, "live")
    while trace(page, title, "live")["x"] == before["x"]:
        assert time.monotonic() < end, "the live point stands still"
        time.sleep(0.2)
    dashboard.client.post("api/session/pause")


def test_a_gain_turned_elsewhere_is_looked_at_anew(page: Page, dashboard: Dashboard) -> None:
    open_lens(page, dashboard, "Sliding mode")
    line = fact(page, "Where the error goes", "on the line")
    expect(line).to_have_text("time constant 33.3 s")
    looked(page, patch(dashboard, {"lanes": {LANE: {"nu": 5.0}}}))
    expect(line).to_have_text("time constant 2.00 s")


def test_nothing_is_computed_while_the_lenses_are_hidden(page: Page, dashboard: Dashboard) -> None:
    open_lens(page, dashboard, "Sliding mode")
    asked: list[Request] = []
    page.on("request", lambda one: asked.append(one) if one.url.endswith("/api/lens") else None)
    page.get_by_role("tab", name="Live", exact=True).click()
    revision = patch(dashboard, {"lanes": {LANE: {"nu": 5.0}}})
    expect(page.locator(".status-revision")).to_have_text(f"rev {revision}")
    assert asked == []
    page.get_by_role("tab", name="Lenses").click()
    looked(page, revision)
    assert len(asked) == 1


def test_network_lens_shows_what_the_run_has_learnt(page: Page, dashboard: Dashboard) -> None:
    open_lens(page, dashboard, "Network")
    run = run_of(dashboard, LANE)
    weights = trace(page, "What the weights store", "weights")["y"]
    assert weights == pytest.approx(run.final_weights[:, 0].tolist(), rel=1e-5)
    assert trace(page, "What f has learnt", "f")["y"][-1] == pytest.approx(run.f[-1, 0], rel=1e-5)
    expect(fact(page, "What the Gaussians see", "independent")).to_have_text("1.00 of 10")
    page.locator(".metrics-lane", has_text="NFTSM").last.click()
    expect(page.locator(".lens-message")).to_contain_text("has no network")


def test_chattering_lens_agrees_with_the_metrics(page: Page, dashboard: Dashboard) -> None:
    open_lens(page, dashboard, "Chattering", "chattering-sign")
    metrics = run_of(dashboard, "sign").metrics
    numbers = fact(page, "Torque over frequency", "all joints")
    shown = [float(text) for text in re.findall(r"[\d.]+", numbers.inner_text())]
    assert metrics.high_frequency_torque is not None
    assert shown[0] == pytest.approx(metrics.chattering, rel=5e-3)
    assert shown[2] == pytest.approx(metrics.high_frequency_torque, rel=5e-3)


def test_points_of_the_curve_set_epsilon_by_mouse_and_by_key_and_undo(
    page: Page, dashboard: Dashboard
) -> None:
    open_lens(page, dashboard, "Chattering", "chattering-sign")
    costs = card(page, "What smoothing costs")
    costs.get_by_role("button", name="Measure the curve").click()
    expect(costs.get_by_role("button", name="Measure again")).to_be_visible(timeout=60_000)
    costs.get_by_text("All points as a table").focus()
    page.keyboard.press("Enter")
    use = costs.get_by_role("button", name="Set ε to 0.1", exact=True)
    use.focus()
    page.keyboard.press("Enter")
    until(dashboard, "sign", "epsilon", 0.1)
    assert experiment(dashboard)["lanes"]["sign"]["switching"] == "tanh"
    # The way back is there when the answer has come.
    expect(page.get_by_role("button", name="Undo")).to_be_enabled()
    page.keyboard.press("Control+z")
    until(dashboard, "sign", "epsilon", 0.03)
    assert experiment(dashboard)["lanes"]["sign"]["switching"] == "sign"
    values = trace(page, "What smoothing costs", "curve")
    point = costs.locator(".lens-graph .scatterlayer .trace").first.locator(".point").last
    # What the undo changed is drawn anew and moves all below: who misses then aims once more.
    hovered, deadline = costs.locator(".hoverlayer"), time.monotonic() + 60.0
    while experiment(dashboard)["lanes"]["sign"]["epsilon"] != 1.0:
        assert time.monotonic() < deadline, "no click sets what the point says"
        point.scroll_into_view_if_needed()
        place = point.bounding_box()
        assert place is not None
        middle = place["x"] + place["width"] / 2, place["y"] + place["height"] / 2
        page.mouse.move(middle[0] + 1.0, middle[1])
        page.mouse.move(*middle)
        page.wait_for_timeout(100)
        if "click to set" in (hovered.text_content() or ""):
            page.mouse.click(*middle)
            page.wait_for_timeout(300)
    assert len(values["x"]) == 13
    expect(costs.locator(".lens-finding")).to_contain_text("The knee is at ε")


def test_three_switching_functions_are_compared(page: Page, dashboard: Dashboard) -> None:
    open_lens(page, dashboard, "Chattering", "chattering-sign")
    three = card(page, "Sign, saturation, tanh")
    three.get_by_role("button", name="Compare the three").click()
    rows = three.locator("tbody tr")
    expect(rows).to_have_count(3, timeout=60_000)
    expect(rows.first).to_contain_text("sign (now)")
    metrics = run_of(dashboard, "sign").metrics
    mae = float(rows.first.locator("td").first.inner_text())
    assert mae == pytest.approx(1000 * np.mean(metrics.mae), rel=5e-3)
    expect(three.locator(".lens-finding")).to_contain_text("times as much as tanh")
    expect(three.locator(".legendtext")).to_have_text(["sign", "saturation", "tanh"])


def test_a_comparison_survives_that_its_lane_goes_away(page: Page, dashboard: Dashboard) -> None:
    open_lens(page, dashboard, "Chattering", "chattering-sign")
    three = card(page, "Sign, saturation, tanh")

    def load_another(request: Request) -> None:
        if "saturation" in (request.post_data or ""):
            return
        dashboard.client.post("api/presets/paper/load").raise_for_status()

    answers: list[int] = []
    page.on("response", lambda one: answers.append(one.status) if "/lens" in one.url else None)
    page.once("request", load_another)
    three.get_by_role("button", name="Compare the three").click()
    expect(page.locator(".lens-lane")).not_to_have_text("sign")
    expect(three.get_by_role("button", name="Compare the three")).to_be_visible(timeout=60_000)
    expect(page.locator(".lenses.is-busy")).to_have_count(0, timeout=60_000)
    assert answers
    assert set(answers) <= {200, 204}


def test_sign_in_continuous_mode_runs_and_says_where_it_would_chatter(
    page: Page, dashboard: Dashboard
) -> None:
    open_lens(page, dashboard, "Chattering")
    three = card(page, "Sign, saturation, tanh")
    three.get_by_role("button", name="Compare the three").click()
    expect(three.locator("tbody tr")).to_have_count(3, timeout=60_000)
    expect(three.locator(".lens-finding")).to_contain_text("times as much as tanh", timeout=60_000)
    expect(three).to_contain_text("sign(S) holds S at zero")
    three.get_by_role("button", name="Load the preset chattering-tanh").click()
    expect(page.locator(".preset-name")).to_have_text("chattering-tanh")
    # The way back is there when the answer has come.
    expect(page.get_by_role("button", name="Undo")).to_be_enabled()
    page.keyboard.press("Control+z")
    expect(page.locator(".preset-name")).to_have_text("paper")


def test_noise_of_the_sensors_is_not_called_chattering(page: Page, dashboard: Dashboard) -> None:
    open_lens(page, dashboard, "Chattering", "realistic")
    title = "Torque over frequency"
    quiet = card(page, title).locator(".lens-facts").get_by_text("without sensor noise")
    verdict = card(page, title).locator(".lens-finding")
    for lane in experiment(dashboard)["lanes"]:
        page.locator(".metrics-lane").get_by_text(lane, exact=True).click()
        expect(page.locator(".lens-lane")).to_have_text(lane)
        expect(verdict).to_contain_text("Sensor noise, not chattering")
        expect(verdict).to_contain_text("k_d" if lane == "Computed torque" else "ε")
        expect(quiet).to_have_count(1)
    # The law that was looked at last has neither a layer nor anything that switches.
    expect(verdict).not_to_contain_text("ε")
    page.get_by_role("tab", name="Sliding mode").click()
    turning = card(page, "Does V fall?")
    expect(turning.locator(".lens-facts")).to_contain_text("without sensor noise")
    expect(turning).to_contain_text("that is measurement noise, not switching")
    expect(turning).not_to_contain_text("chattering")


def test_a_restless_law_that_never_switches_is_not_told_to_widen_its_layer(
    page: Page, dashboard: Dashboard
) -> None:
    page.goto(dashboard.url)
    told = page.evaluate(
        """async () => {
          const {chatteringFinding, energyFinding} = (
            await import('/static/lenses/verdicts.js'));
          const seen = {frequency: [1], switches: 9, above: 3, mae: 1e-3, quiet: null};
          const sliding = {turns: 400, quiet_turns: null, outside: 0, joints: []};
          const exact = {kp: 100, kd: 900};
          const thin = {k1: 8, k2: 5, epsilon: 1e-3, switching: 'tanh'};
          return [chatteringFinding(seen, exact), energyFinding(sliding, 1, exact),
            energyFinding(sliding, 1, thin)];
        }"""
    )
    assert all("Nothing switches" in text or "nothing that switches" in text for text in told)
    assert "ε" not in told[0] + told[1]
    assert not any("That is chattering" in text for text in told)


def test_gain_of_sign_is_told_to_have_no_bound(page: Page, dashboard: Dashboard) -> None:
    open_lens(page, dashboard, "Chattering", "chattering-sign")
    row = page.locator(".metrics-table tbody tr", has_text="sign")
    margin = row.locator(".metrics-gamma")
    expect(margin).to_have_text("∞")
    expect(margin).to_have_attribute("title", re.compile("no bound"))


def test_knee_is_the_point_that_bends_farthest(page: Page, dashboard: Dashboard) -> None:
    page.goto(dashboard.url)
    found = page.evaluate(
        """async () => {
          const {knee} = await import('/static/lenses/knee.js');
          const rows = (list) => list.map(([value, mae, chattering]) => ({value, mae, chattering}));
          return [knee(rows([[1, 1, 1e5], [2, 1.1, 1e4], [3, 1.2, 100], [4, 4, 90], [5, 40, 80]])),
            knee(rows([[1, 1, 1000], [2, 10, 100], [3, 100, 10]]))];
        }"""
    )
    assert found[0]["value"] == 3
    assert found[1] is None


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_pictures_take_the_pages_colours(page: Page, dashboard: Dashboard, theme: str) -> None:
    page.emulate_media(color_scheme="dark" if theme == "dark" else "light")
    open_lens(page, dashboard, "Sliding mode")
    color = page.evaluate("getComputedStyle(document.documentElement).getPropertyValue('--text')")
    title = "Where the error goes"
    trace(page, title, "curve")
    drawn = (
        card(page, title)
        .locator(".lens-graph")
        .evaluate("(graph) => graph.data.find((one) => one.uid === 'curve').line.color")
    )
    assert drawn == color.strip()


def test_lenses_fit_a_narrow_screen(page: Page, dashboard: Dashboard) -> None:
    page.set_viewport_size({"width": 390, "height": 844})
    page.goto(dashboard.url)
    page.locator("#tabs").get_by_role("tab", name="Plots").click()
    page.get_by_role("tab", name="Lenses").click()
    trace(page, "Where the error goes", "curve")
    overflow = page.locator(".lens-scroller").evaluate("(one) => one.scrollWidth - one.clientWidth")
    assert overflow <= 0
