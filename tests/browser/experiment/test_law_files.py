"""A law of one's own in the page: sliders, errors with their lines, and it goes on when mended."""

from __future__ import annotations

import time
from pathlib import Path

from playwright.sync_api import Page, expect

from tests.browser.conftest import StartDashboard
from tests.own_laws import EXAMPLE, before_torque

PATIENCE = 240_000
"""Milliseconds for a file to be tried on a machine that is busy."""


def test_an_error_is_shown_with_its_lines_and_mended_it_goes_on(
    page: Page, start_dashboard: StartDashboard, tmp_path: Path
) -> None:
    law, preset = tmp_path / "pd.py", tmp_path / "own.yaml"
    law.write_text(EXAMPLE)
    preset.write_text("lanes: {Mine: {law: pd_gravity}, Other: {law: smc}}\n")
    dashboard = start_dashboard("--law", str(law), "--preset", str(preset))
    page.goto(dashboard.url)
    file, gains = page.locator(".law-file"), page.locator(".gains")
    expect(file).to_contain_text("in use")
    expect(gains).to_contain_text("PD with gravity compensation")
    expect(gains).to_contain_text("Position gain")

    law.write_text(before_torque("wrok[S, j] = 0.0"))
    expect(file).to_have_attribute("data-state", "refused", timeout=PATIENCE)
    expect(file.locator(".law-trace")).to_contain_text("wrok[S, j] = 0.0")
    expect(file.locator(".law-trace")).to_contain_text('File "pd.py", line')
    expect(file).to_contain_text("The last good version is in use.")
    states = page.locator(".lane-status")
    expect(states).to_have_text(["running", "running"])

    mended = EXAMPLE.replace('title="Position gain"', 'title="Spring"').replace("kp:", "spring:")
    law.write_text(mended.replace("self.kp", "self.spring"))
    expect(gains).to_contain_text("Spring", timeout=PATIENCE)
    expect(file).to_have_attribute("data-state", "good")
    expect(file.locator(".law-trace")).to_have_count(0)
    slider = gains.get_by_role("slider", name="Spring").first
    slider.focus()
    slider.press("ArrowRight")
    expect(states).to_have_text(["running", "running"])

    def spring() -> float:
        lanes = dashboard.client.get("/api/experiment").json()["experiment"]["lanes"]
        return float(lanes["Mine"]["spring"])

    deadline = time.monotonic() + 30.0
    while spring() <= 400.0:
        assert time.monotonic() < deadline, "the slider moved nothing"
        page.wait_for_timeout(50)
