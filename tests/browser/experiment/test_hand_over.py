"""A lane's menu hands it over: an archive that checks itself."""

from __future__ import annotations

import json
from pathlib import Path
from zipfile import ZipFile

from playwright.sync_api import Page, expect

from tests.browser.conftest import Complaints, Dashboard
from tests.robot.handover.built import run_python

PATCH = {"simulation": {"horizon": 0.3, "mode": "sampled"}, "uncertainty": {"payload": [0.0, 1.0]}}


def test_a_lane_is_handed_over_from_its_menu(
    page: Page, dashboard: Dashboard, tmp_path: Path
) -> None:
    dashboard.client.patch("/api/experiment", json=PATCH).raise_for_status()
    page.goto(dashboard.url)
    expect(page.locator("#header")).to_contain_text("live")
    page.locator(".lane [aria-haspopup=menu]").first.click()
    page.locator("[popover]:popover-open .menu-item", has_text="Hand over").click()
    dialog = page.get_by_role("dialog", name="Hand over RBFNN-NFTSM")
    controller, draws = (dialog.get_by_label(name) for name in ("Name of the controller", "Draws"))
    expect(controller).to_have_value("slidetune_controller")
    controller.fill("my_arm")
    draws.fill("two")
    dialog.get_by_role("button", name="Download").click()
    expect(dialog.get_by_role("alert")).to_have_text(
        "Draws must be a whole number, 0 to 200; got two."
    )
    draws.fill("2")
    with page.expect_download(timeout=180_000) as saved:
        dialog.get_by_role("button", name="Download").click()
    expect(dialog).to_have_count(0)
    assert saved.value.suggested_filename == "RBFNN-NFTSM.zip"
    archive = tmp_path / "lane.zip"
    saved.value.save_as(archive)
    with ZipFile(archive) as opened:
        opened.extractall(tmp_path)
    folder = tmp_path / "RBFNN-NFTSM"
    assert "my_arm:" in (folder / "gains.yaml").read_text(encoding="utf-8")
    conditions = json.loads((folder / "conditions.json").read_text(encoding="utf-8"))
    assert conditions["robustness"]["draws"] == 2
    assert run_python(folder).returncode == 0


def test_what_the_server_refuses_is_said_in_the_dialog(
    page: Page, dashboard: Dashboard, complaints: Complaints
) -> None:
    complaints.allow("422")
    page.goto(dashboard.url)
    expect(page.locator("#header")).to_contain_text("live")
    page.locator(".lane [aria-haspopup=menu]").first.click()
    page.locator("[popover]:popover-open .menu-item", has_text="Hand over").click()
    dialog = page.get_by_role("dialog", name="Hand over RBFNN-NFTSM")
    expect(dialog.get_by_label("Draws")).to_have_count(0)  # nothing is uncertain
    dialog.get_by_label("Name of the controller").fill("my arm")
    dialog.get_by_role("button", name="Download").click()
    expect(dialog.get_by_role("alert")).to_contain_text("must be letters, digits and _")
