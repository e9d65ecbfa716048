"""The report of a run, opened from disk without a network."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import FrameLocator, Page, expect

from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import simulate
from slidetune.server.report.run_report import report
from slidetune.server.run_report.page import run_report
from slidetune.server.run_report.recording import record
from tests.browser.conftest import PATIENCE
from tests.browser.inspector import Inspector

CURVES = 6 * 4 + 4 * 6 * 3 + 3
"""Of the three lanes: positions beside the desired ones, four other quantities, the flange."""
DRAWN = "() => document.querySelectorAll('.plot .scatterlayer .trace').length"
LARGEST = 8_000_000
"""Most bytes of the report on the paper's experiment."""
NO_WEBGL = """
const context = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
  return kind.startsWith('webgl') ? null : context.call(this, kind, ...rest);
};
"""


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("report") / "report.html"
    run = simulate(load_preset("paper"))
    path.write_text(run_report(run, report(run), record).html, encoding="utf-8")
    return path


@pytest.fixture
def offline(page: Page) -> Iterator[Page]:
    page.context.set_offline(True)
    yield page
    page.context.set_offline(False)


def shown_time(replay: FrameLocator) -> float:
    return float(replay.locator("input").first.input_value())


@pytest.mark.scene
def test_plots_and_replay_run_from_disk_without_a_network(file: Path, offline: Page) -> None:
    assert file.stat().st_size < LARGEST
    asked: list[str] = []
    offline.set_viewport_size({"width": 480, "height": 480})  # few pixels to draw in software
    offline.on("request", lambda request: asked.append(request.url))
    offline.goto(file.as_uri())
    offline.wait_for_function(f"({DRAWN})() === {CURVES}")
    expect(offline.locator("#replay iframe")).to_have_count(0)
    offline.locator("#replay").scroll_into_view_if_needed()
    replay = offline.frame_locator("#replay iframe")
    expect(replay.locator("canvas").first).to_be_visible()
    first = shown_time(replay)
    expect(replay.locator("input").first).not_to_have_value(f"{first:.1f}")
    drawn = replay.locator("canvas").first.screenshot()
    # Playing, it writes its own time over what is typed.
    replay.locator(".tabler-icon-player-pause-filled").click()
    expect(replay.locator(".tabler-icon-player-play-filled")).to_be_visible()
    replay.locator("input").first.fill("5.0")
    expect(replay.locator("input").first).to_have_value("5.0")
    end = time.monotonic() + PATIENCE / 1000
    while replay.locator("canvas").first.screenshot() == drawn:
        assert time.monotonic() < end, "the picture stays what it was"
    assert [url for url in asked if not url.startswith(("blob:", "data:"))] == [file.as_uri()]


@pytest.mark.fresh
def test_without_webgl_the_rest_is_whole_and_says_so(file: Path, offline: Page) -> None:
    offline.add_init_script(NO_WEBGL)
    offline.set_viewport_size({"width": 390, "height": 800})
    offline.goto(file.as_uri())
    offline.wait_for_function(f"({DRAWN})() === {CURVES}")
    offline.locator("#replay").scroll_into_view_if_needed()
    expect(offline.locator("#replay")).to_contain_text("This browser has no WebGL")
    expect(offline.locator("#command")).to_have_text(
        "python -m slidetune run paper --report report.html"
    )
    offline.locator("summary", has_text="The whole experiment").click()
    expect(offline.locator("#yaml-text")).to_be_visible()
    with offline.expect_download() as saved:
        offline.get_by_role("button", name="Save it as experiment.yaml").click()
    saved.value.save_as(file.with_name("saved.yaml"))
    assert load_preset(file.with_name("saved.yaml")) == load_preset("paper")
    assert offline.evaluate("document.documentElement.scrollWidth") <= 390
    inspector = Inspector(offline)
    inspector.start()
    inspector.look("the report")
    assert not inspector.found, "\n\n".join(inspector.found)
