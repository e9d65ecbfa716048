"""A log of the real arm is dropped, shown beside the lanes, shifted, fitted and followed."""

from __future__ import annotations

import base64
import re
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Locator, Page, expect

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import Run, simulate
from tests.browser.api.test_watch_only import open_as_viewer, owner
from tests.browser.conftest import LOGS, Complaints, Dashboard, StartDashboard
from tests.browser.inspector import Inspector
from tests.server.scene.viser_client import until

VISCOUS = [6.0, 6.0, 4.0, 2.0, 1.5, 1.0]
LATE = 0.8
"""Time in [s] by which the log begins after the motion."""
BARE: dict[str, Any] = {
    "title": "Without friction",
    "lanes": {"A": {"law": "smc", "k1": 20.0, "k2": 5.0}},
    "trajectory": {"kind": "sine"},
    "disturbance": {"constant": 0.0},
    "robot": {"inertials": "datasheet"},
    "simulation": {"horizon": 5.0, "initial_error": 0.0, "initial_velocity": "desired"},
}
DROP = """([name, data]) => {
  const bytes = Uint8Array.from(atob(data), character => character.charCodeAt(0));
  const transfer = new DataTransfer();
  transfer.items.add(new File([bytes], name));
  window.dispatchEvent(new DragEvent('drop', {
    dataTransfer: transfer, cancelable: true, bubbles: true,
  }));
}"""


@lru_cache(maxsize=1)
def run() -> Run:
    """The arm as it is: with friction."""
    robot = {**BARE["robot"], "viscous_friction": VISCOUS}
    return simulate(Experiment.from_document({**BARE, "robot": robot}))


def log_text(angle: str = "q{}", desired: str = "q_d{}") -> bytes:
    """Return a log of the run from ``LATE`` on; it knows what was asked of the arm."""
    lane, first = run().lanes["A"], round(LATE / (run().time[1] - run().time[0]))
    rows = slice(first, None, 2)
    heads = ["t [s]", *(f.format(j) for f in (angle, "tau{}", desired) for j in range(1, 7))]
    columns = [run().time[rows] - run().time[first], lane.q[rows], lane.tau[rows], run().q_d[rows]]
    lines = [",".join(f"{value:.9g}" for value in row) for row in np.column_stack(columns)]
    return "\n".join([",".join(heads), *lines, ""]).encode()


def drop(page: Page, text: bytes, name: str = "monday.csv") -> Locator:
    """Drop a file on the window; return the dialog that tells what was read."""
    page.evaluate(DROP, [name, base64.b64encode(text).decode()])
    dialog = page.get_by_role("dialog", name=name)
    expect(dialog.get_by_role("button", name="Remove")).to_be_visible()
    return dialog


def experiment(dashboard: Dashboard) -> dict[str, Any]:
    return dict(dashboard.client.get("/api/experiment").json()["experiment"])


@pytest.fixture
def bare(page: Page, dashboard: Dashboard) -> Dashboard:
    """A dashboard with an arm without friction, opened at its response."""
    dashboard.client.put("/api/experiment", json=BARE).raise_for_status()
    page.goto(dashboard.url)
    page.locator("[data-view=response]").click()
    expect(page.locator(".response-status")).to_have_attribute("data-estimated", "true")
    return dashboard


def lines_of_logs(page: Page) -> Locator:
    return page.locator(".response .trace[class*='tracelog'] path.js-line")


def test_a_log_is_shown_beside_the_lanes_and_shifted(page: Page, bare: Dashboard) -> None:
    dialog = drop(page, log_text())
    expect(dialog).to_contain_text("at 500 Hz: angles, torques, desired angles")
    expect(dialog.get_by_role("button", name="Show beside the lanes")).to_be_focused()
    page.keyboard.press("Enter")
    expect(lines_of_logs(page)).to_have_count(3)
    box = page.get_by_role("spinbutton", name="Shift of monday.csv in s")
    find = page.get_by_role("button", name="find")
    expect(box).to_have_value(re.compile(r"0\.(8|79999?|8000?\d?)"))
    expect(find).to_have_attribute("aria-pressed", "true")
    # Its figures, to three digits, are those of the run that it was.
    lane, later = run().lanes["A"], run().time >= LATE - 1e-9
    mae = 1e3 * np.abs(lane.e[later, 0]).mean()
    head = page.locator(".response-figures .response-lane").filter(has_text="monday.csv")
    cell = head.locator("xpath=ancestor::tr").locator(".metrics-mae1")
    expect(cell).to_have_text(re.compile(r"\d"))
    assert float(cell.inner_text()) == pytest.approx(mae, rel=0.02)

    first = lines_of_logs(page).first.get_attribute("d")
    box.fill("1.5")
    box.press("Enter")
    expect(find).to_have_attribute("aria-pressed", "false")
    expect(lines_of_logs(page).first).not_to_have_attribute("d", str(first))
    page.reload()
    expect(box).to_have_value("1.5")
    expect(lines_of_logs(page)).to_have_count(3)
    find.click()
    expect(box).to_have_value(re.compile(r"0\.(8|79999?|8000?\d?)"))
    expect(page.locator(".notice")).to_contain_text("monday.csv: ")
    page.locator(".response").get_by_role("tab", name="Torque").click()
    expect(lines_of_logs(page)).to_have_count(3)
    page.get_by_role("button", name="Show monday.csv").click()
    expect(lines_of_logs(page)).to_have_count(0)
    page.get_by_role("button", name="Remove monday.csv").click()
    expect(page.locator(".log-chip")).to_have_count(0)


def test_its_friction_is_fitted_and_used_by_one_edit(page: Page, bare: Dashboard) -> None:
    drop(page, log_text()).get_by_role("button", name="Fit friction and payload").click()
    dialog = page.get_by_role("dialog", name="What monday.csv says of the arm")
    for joint, true in enumerate(VISCOUS):
        cells = dialog.locator(f"[data-path='robot.viscous_friction.{joint}'] td")
        expect(cells.first).to_have_text("0")
        assert float(cells.nth(1).inner_text()) == pytest.approx(true, rel=0.1)
    expect(dialog.locator(".lens-graph path.js-line")).to_have_count(12)
    inspector = Inspector(page)
    inspector.start()
    inspector.look("fit", "dialog")
    assert inspector.found == []
    dialog.get_by_role("button", name="Use these").click()
    expect(page.locator(".notice")).to_contain_text("of monday.csv now")
    used = experiment(bare)["robot"]["viscous_friction"]
    assert used == pytest.approx(VISCOUS, rel=0.1)
    page.locator(".notice").get_by_role("button", name="Undo").click()
    expect(page.get_by_role("button", name="Redo", exact=True)).to_be_enabled()
    assert experiment(bare)["robot"] == {**experiment(bare)["robot"], "viscous_friction": 0.0}


def test_it_becomes_the_trajectory_by_one_edit(page: Page, bare: Dashboard) -> None:
    before = experiment(bare)["trajectory"]
    drop(page, log_text()).get_by_role("button", name="Use as trajectory").click()
    dialog = page.get_by_role("dialog", name="monday.csv as trajectory")
    expect(dialog.locator("tbody tr")).to_have_count(6)
    expect(dialog).to_contain_text("comes to rest in 0.5 s more")
    bare.client.post("/api/session/pause").raise_for_status()
    until(lambda: not bare.client.get("/api/session").json()["playing"])
    assert bare.client.get("/api/session").json()["time"] > 0.0
    dialog.get_by_role("button", name="Follow this motion").click()
    expect(page.locator(".notice")).to_contain_text("The desired motion is monday.csv now")
    until(lambda: bare.client.get("/api/session").json()["time"] == 0.0)
    bare.client.post("/api/session/play").raise_for_status()
    followed = experiment(bare)["trajectory"]
    assert (followed["kind"], followed["origin"]) == ("recorded", "monday.csv")
    page.keyboard.press("Control+z")
    expect(page.get_by_role("button", name="Redo", exact=True)).to_be_enabled()
    assert experiment(bare)["trajectory"] == before


def test_columns_that_nobody_names_are_mapped_by_hand(page: Page, bare: Dashboard) -> None:
    page.evaluate(
        DROP, ["odd.csv", base64.b64encode(log_text("axis {} place", "axis {} aim")).decode()]
    )
    refused = page.get_by_role("dialog", name="odd.csv was not read")
    expect(refused).to_contain_text("joint_1")
    refused.get_by_role("button", name="Say which columns").click()
    columns = page.get_by_role("dialog", name="Columns of odd.csv")
    expect(columns.get_by_label("Torque of joint_2")).to_have_value("tau2")
    inspector = Inspector(page)
    inspector.start()
    inspector.look("columns", "dialog")
    assert inspector.found == []
    for joint in range(1, 7):
        select = columns.get_by_label(f"Angle of joint_{joint}")
        expect(select).to_have_value("")
        select.select_option(f"axis {joint} place")
    columns.get_by_role("button", name="Read").click()
    read = page.get_by_role("dialog", name="odd.csv")
    expect(read.get_by_role("button", name="Show beside the lanes")).to_be_visible()


def test_what_is_wrong_is_told_by_row_and_column(
    page: Page, bare: Dashboard, complaints: Complaints
) -> None:
    complaints.allow("422")
    wrong = log_text().replace(b"\n0.004,", b"\noops,")
    page.evaluate(DROP, ["bad.csv", base64.b64encode(wrong).decode()])
    dialog = page.get_by_role("dialog", name="bad.csv was not read")
    expect(dialog).to_contain_text("row 4, column t [s]: 'oops' is no number")
    dialog.get_by_role("button", name="Close").click()
    page.evaluate(DROP, ["empty.csv", ""])
    expect(page.locator(".notice.is-error")).to_contain_text("No log was read: empty.csv: is empty")


def test_a_viewer_sees_the_log_and_can_move_nothing(
    page: Page, start_dashboard: StartDashboard, request: pytest.FixtureRequest
) -> None:
    guarded = start_dashboard("--token")
    request.node.stash.setdefault(LOGS, []).append(guarded.log)
    with owner(guarded) as hand:
        asked = open_as_viewer(page, guarded)
        hand.put("/api/experiment", json=BARE).raise_for_status()
        page.locator("[data-view=response]").click()
        log = hand.post("/api/logs", files={"file": ("monday.csv", log_text())}).json()["log"]
        chip = page.locator(".log-chip")
        expect(chip).to_contain_text("monday.csv")
        hand.patch(f"/api/logs/{log['number']}", json={"shown": True}).raise_for_status()
        hand.post(f"/api/logs/{log['number']}/curves", json={"shift": 0.5}).raise_for_status()
        expect(lines_of_logs(page)).to_have_count(3)
        expect(chip.get_by_role("spinbutton")).to_have_value("0.5")
        expect(chip.locator(":enabled")).to_have_count(0)
        expect(page.locator(".log-bring")).to_be_hidden()
    assert asked == []
