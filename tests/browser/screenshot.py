"""Takes the README's picture: ``python -m tests.browser.screenshot [folder]``.

Starts a dashboard of its own with the paper's preset, lets it run, and photographs it in light and
in dark.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

from tests.browser.chromium import FLAGS, find
from tests.browser.conftest import running

SIZE = {"width": 1440, "height": 900}
SECONDS = 14


def _photograph(page: Page, url: str, path: Path) -> None:
    page.goto(url)
    page.wait_for_timeout(6_000)
    scene = page.frame_locator("#scene iframe")
    # Viser says that WebGL runs in software, which is true of this script alone.
    note = scene.locator("text=Software WebGL").locator("xpath=ancestor::*[@role='alert'][1]")
    if note.count():
        note.locator("button").first.click()
    page.wait_for_timeout(SECONDS * 1000)
    page.screenshot(path=path)
    print(f"wrote {path}")


def main(folder: Path) -> None:
    """Write ``dashboard-light.png`` and ``dashboard-dark.png``."""
    folder.mkdir(parents=True, exist_ok=True)
    with (
        tempfile.TemporaryDirectory() as place,
        running((), Path(place) / "log.txt") as dashboard,
        sync_playwright() as playwright,
    ):
        browser = playwright.chromium.launch(executable_path=find(), args=list(FLAGS))
        for scheme in ("light", "dark"):
            context = browser.new_context(viewport=SIZE, color_scheme=scheme)
            _photograph(context.new_page(), dashboard.url, folder / f"dashboard-{scheme}.png")
            context.close()
        browser.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("docs"))
