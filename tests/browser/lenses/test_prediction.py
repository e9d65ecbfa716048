"""The prediction lens, its mark on the slider of the boundary layer, and its button."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Locator, Page, expect

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.lenses import look_through
from tests.browser.conftest import Dashboard
from tests.browser.lenses.test_lenses import (
    card,
    experiment,
    fact,
    looked,
    open_lens,
    patch,
    trace,
    until,
)

TITLE = "What the pencil says"
CURVE = "Where it balances"
LANE = "sign"
LAG = {"robot": {"lag": 0.004, "lag_order": "second"}}
# Half a second in which nothing changes passes when the test says so, however long a drag takes.
HOLD = """() => {
  const [wait, forget, held] = [window.setTimeout, window.clearTimeout, new Map()];
  window.setTimeout = (act, time, ...given) => {
    const id = wait(act, time === 500 ? 1e8 : time, ...given);
    if (time === 500) held.set(id, act);
    return id;
  };
  window.clearTimeout = (id) => { held.delete(id); forget(id); };
  window.let_pass = () => {
    for (const [id, act] of held) { window.clearTimeout(id); act(); }
  };
}"""


def predicted(dashboard: Dashboard, lane: str = LANE) -> dict[str, object]:
    document = Experiment.from_document(experiment(dashboard))
    seen: dict[str, object] = look_through(document, lane, ["prediction"])["prediction"]
    return seen


def open_with_drives(page: Page, dashboard: Dashboard) -> None:
    open_lens(page, dashboard, "Prediction", preset="chattering-sign")
    revision = patch(dashboard, LAG)
    looked(page, revision)


def test_it_shows_what_harmonic_balance_and_the_run_say(page: Page, dashboard: Dashboard) -> None:
    open_with_drives(page, dashboard)
    joints = predicted(dashboard)["joints"]
    rows = card(page, TITLE).locator("tbody tr")
    expect(rows).to_have_count(6)
    page.keyboard.press("3")
    expect(rows.nth(2)).to_have_attribute("aria-current", "true")
    cells = [float(rows.nth(2).locator("td").nth(column).inner_text()) for column in range(5)]
    names = ("frequency", "measured_frequency", "amplitude", "measured_amplitude", "threshold")
    wanted = [joints[2][name] for name in names]  # type: ignore[index]
    assert cells == pytest.approx(wanted, rel=0.01)
    expect(fact(page, CURVE, "κ")).to_contain_text("rad/s²")
    crossing = trace(page, CURVE, "crossing")
    assert crossing["x"][0] == pytest.approx(joints[2]["crossing"][0], rel=1e-4)  # type: ignore[index]


def test_the_button_silences_the_lane_and_undo_brings_it_back(
    page: Page, dashboard: Dashboard
) -> None:
    open_with_drives(page, dashboard)
    layer = predicted(dashboard)["epsilon"]
    button = card(page, TITLE).get_by_role("button", name=re.compile("^Set ε to"))
    button.focus()
    page.keyboard.press("Enter")
    until(dashboard, LANE, "epsilon", layer)
    until(dashboard, LANE, "switching", "tanh")
    expect(card(page, TITLE).locator(".lens-finding")).to_contain_text("Silent")
    for row in card(page, TITLE).locator("tbody tr").all():
        expect(row.locator("td").nth(1)).to_have_text("–")
    page.locator("body").press("Control+z")
    until(dashboard, LANE, "switching", "sign")


def epsilon_of(page: Page, lane: str) -> tuple[Locator, Locator]:
    """Return the slider of a lane's layer and the note below it."""
    control = page.locator(f'.control[data-path="lanes.{lane}.epsilon"]')
    return control.locator(".control-input > .slider"), control.locator(".silence-note")


def threshold(dashboard: Dashboard, lane: str) -> float:
    found: float = predicted(dashboard, lane)["threshold"]  # type: ignore[assignment]
    return found


def test_the_slider_is_marked_without_the_lens_and_anew_for_another_loop(
    page: Page, dashboard: Dashboard
) -> None:
    dashboard.client.post("api/presets/chattering-sign/load").raise_for_status()
    patch(dashboard, {"simulation": {"horizon": 1.0}, **LAG})
    page.goto(dashboard.url)
    slider, note = epsilon_of(page, LANE)
    marked = re.compile("is-silence-marked")
    expect(slider).to_have_class(marked)
    expect(note).to_contain_text(f"tanh would be silent from ε* = {threshold(dashboard, LANE):.3g}")
    # What only moves along the slider leaves the mark where it is, and asks for nothing.
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    patch(dashboard, {"lanes": {LANE: {"epsilon": 0.2, "switching": "tanh"}}})
    expect(note).to_contain_text("Silent from ε*")
    page.wait_for_timeout(1000)
    assert [url for url in asked if "/api/threshold" in url or "/api/lens" in url] == []
    # Another loop has another mark.
    patch(dashboard, {"lanes": {LANE: {"k2": 10.0}}})
    expect(note).to_contain_text(f"Silent from ε* = {threshold(dashboard, LANE):.3g}")
    page.locator(".lane", has_text="tanh").first.click()
    slider, note = epsilon_of(page, "tanh")
    expect(slider).to_have_class(marked)
    expect(note).to_contain_text(f"Silent from ε* = {threshold(dashboard, 'tanh'):.3g}")


def test_a_layer_for_each_joint_is_asked_for_as_soon_as_there_is_one(
    page: Page, dashboard: Dashboard
) -> None:
    dashboard.client.post("api/presets/chattering-sign/load").raise_for_status()
    patch(dashboard, {"simulation": {"horizon": 1.0}, **LAG})
    page.goto(dashboard.url)
    expect(epsilon_of(page, LANE)[1]).to_contain_text("ε*")
    patch(dashboard, {"lanes": {LANE: {"epsilon": [0.03] * 5 + [0.04]}}})
    rows = page.locator(f'.control[data-path="lanes.{LANE}.epsilon"] .joint-row')
    expect(rows.locator(".slider.is-silence-marked")).to_have_count(6)
    expect(epsilon_of(page, LANE)[1]).to_contain_text("each joint")


def test_a_drag_is_over_before_the_threshold_is_asked_for(page: Page, dashboard: Dashboard) -> None:
    dashboard.client.post("api/presets/chattering-sign/load").raise_for_status()
    patch(dashboard, {"simulation": {"horizon": 1.0}, "lanes": {LANE: {"k1": 40.0}}, **LAG})
    page.goto(dashboard.url)
    expect(epsilon_of(page, LANE)[1]).to_contain_text("ε*")
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    control = page.locator(f'.control[data-path="lanes.{LANE}.k1"]')
    slider, box = control.locator(".control-input > .slider"), control.locator(".number-box").first
    page.evaluate(HOLD)
    slider.focus()
    for _ in range(10):
        page.keyboard.press("ArrowRight")
    expect(box).not_to_have_value("40")
    until(dashboard, LANE, "k1", float(box.input_value()))
    revision = dashboard.client.get("api/experiment").json()["revision"]
    expect(page.locator("#header [data-revision]")).to_have_attribute(
        "data-revision", str(revision)
    )
    assert [url for url in asked if "/api/threshold" in url] == []
    with page.expect_request("**/api/threshold"):
        page.evaluate("let_pass()")
    expect(epsilon_of(page, LANE)[1]).to_contain_text("ε*")
    # Known now: nothing is left that would ask.
    page.evaluate("let_pass()")
    page.wait_for_timeout(200)
    assert len([url for url in asked if "/api/threshold" in url]) == 1


def test_the_lens_of_a_silent_loop_has_its_picture_and_says_why(
    page: Page, dashboard: Dashboard
) -> None:
    open_lens(page, dashboard, "Prediction", preset="paper-undisturbed")
    curve = trace(page, CURVE, "curve")
    assert len(curve["x"]) > 50
    expect(card(page, CURVE).locator(".lens-finding")).to_contain_text("Joint 1 is silent")
    expect(card(page, TITLE).locator(".lens-finding")).to_contain_text("No limit cycle")
    expect(card(page, TITLE).get_by_role("button")).to_be_hidden()


def test_a_loop_that_no_layer_holds_is_told_so_and_has_no_limit_cycle(
    page: Page, dashboard: Dashboard
) -> None:
    dashboard.client.post("api/presets/drive-lag/load").raise_for_status()
    others = dict.fromkeys(set(experiment(dashboard)["lanes"]) - {LANE})
    # Far too high for joint 3 alone; joint 6 swings by itself.
    gains = {"k1": [80.0, 80.0, 1000.0, 8.0, 8.0, 8.0]}
    patch(dashboard, {"lanes": {LANE: gains, **others}, "simulation": {"horizon": 1.0}})
    page.goto(dashboard.url)
    page.get_by_role("tab", name="Lenses").click()
    page.get_by_role("tab", name="Prediction").click()
    assert all(joint["amplitude"] is None for joint in predicted(dashboard)["joints"])  # type: ignore[attr-defined]
    expect(card(page, TITLE).locator(".lens-finding")).to_contain_text("farther and farther")
    expect(card(page, TITLE).get_by_role("button")).to_be_hidden()
    for row in card(page, TITLE).locator("tbody tr").all():
        expect(row.locator("td").nth(2)).to_have_text("–")
    expect(card(page, CURVE)).to_contain_text("in a loop that swings farther and farther")
    expect(card(page, CURVE)).to_contain_text("that is no limit cycle")
    expect(card(page, CURVE)).not_to_contain_text("S keeps swinging")
    marks = card(page, CURVE).locator(".annotation-text")
    expect(marks.filter(has_text="limit cycle")).to_have_count(0)


def test_drives_that_differ_much_are_told_of(page: Page, dashboard: Dashboard) -> None:
    dashboard.client.post("api/presets/drive-lag/load").raise_for_status()
    others = dict.fromkeys(set(experiment(dashboard)["lanes"]) - {LANE})
    patch(dashboard, {"lanes": others, "simulation": {"horizon": 1.0}})
    page.goto(dashboard.url)
    page.get_by_role("tab", name="Lenses").click()
    page.get_by_role("tab", name="Prediction").click()
    words = card(page, TITLE).locator(".lens-finding")
    expect(words).to_contain_text("rad/s")
    expect(words).not_to_contain_text("lags differ")
    patch(dashboard, {"robot": {"lag": [0.012, 0.004, 0.004, 0.003, 0.003, 0.003]}})
    expect(words).to_contain_text("lags differ much")


@pytest.mark.parametrize(
    ("gains", "words"),
    [({"reaching": "power"}, "power reaching"), ({"k2": 0.0}, "k₂ of sign is 0")],
)
def test_a_lane_without_a_balance_is_told_why(
    page: Page, dashboard: Dashboard, gains: dict[str, object], words: str
) -> None:
    open_lens(page, dashboard, "Prediction", preset="chattering-sign")
    patch(dashboard, {"lanes": {LANE: gains}})
    expect(page.locator(".lens-message")).to_contain_text(words)


def test_each_joint_of_a_list_has_its_own_mark(page: Page, dashboard: Dashboard) -> None:
    open_with_drives(page, dashboard)
    looked(page, patch(dashboard, {"lanes": {LANE: {"epsilon": [0.03] * 5 + [0.04]}}}))
    control = page.locator(f'.control[data-path="lanes.{LANE}.epsilon"]')
    expect(control.locator(".joint-row .slider.is-silence-marked")).to_have_count(6)
    expect(control.locator(".control-input > .slider.is-silence-marked")).to_have_count(0)
    expect(control.locator(".silence-note")).to_contain_text("each joint")


def test_a_lane_without_a_switching_term_is_told_so(page: Page, dashboard: Dashboard) -> None:
    open_lens(page, dashboard, "Prediction", preset="realistic")
    page.get_by_role("radio", name="Computed torque").check(force=True)
    expect(page.locator(".lens-message")).to_contain_text("no switching term")


def test_it_fits_on_a_phone(page: Page, dashboard: Dashboard) -> None:
    dashboard.client.post("api/presets/chattering-sign/load")
    patch(dashboard, {"simulation": {"horizon": 1.0}, **LAG})
    page.set_viewport_size({"width": 390, "height": 844})
    page.goto(dashboard.url)
    page.locator("#tabs").get_by_role("tab", name="Plots").click()
    page.get_by_role("tab", name="Lenses").click()
    page.get_by_role("tab", name="Prediction").click()
    expect(card(page, TITLE).get_by_role("button", name=re.compile("^Set ε"))).to_be_visible()
    trace(page, CURVE, "curve")
    overflow = page.locator(".lens-scroller").evaluate("(one) => one.scrollWidth - one.clientWidth")
    assert overflow <= 0
