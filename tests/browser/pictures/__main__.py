"""Takes every picture of the documentation: ``python -m tests.browser.pictures [FOLDER]``.

Starts a dashboard of its own, does in the page what each page of the documentation tells, and
photographs it. The 3D scene is drawn in software: it takes two minutes or so.
"""

from __future__ import annotations

import argparse
import os
import tempfile
from pathlib import Path

from playwright.sync_api import Browser, ViewportSize, sync_playwright

from tests.browser.chromium import FLAGS, find
from tests.browser.conftest import ROOT, Dashboard, running
from tests.browser.pictures.small_png import write_small
from tests.browser.pictures.steps import STEPS, Step

SIZE: ViewportSize = {"width": 1440, "height": 900}
FOLDER = ROOT / "docs" / "pictures"


def _take(browser: Browser, dashboard: Dashboard, step: Step, folder: Path) -> None:
    context = browser.new_context(viewport=SIZE, color_scheme=step.scheme)
    page = context.new_page()
    page.set_default_timeout(240_000)
    try:
        picture = step.take(page, dashboard)
    finally:
        context.close()
    path = folder / f"{step.name}.png"
    size = write_small(picture, path)
    print(f"{path.name}: {size / 1000:.0f} kB", flush=True)


def main() -> None:
    """Take the pictures, or those that are named."""
    parser = argparse.ArgumentParser(prog="python -m tests.browser.pictures", description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, default=FOLDER)
    parser.add_argument("--only", action="append", choices=[step.name for step in STEPS])
    wanted = parser.parse_args()
    wanted.folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as place, sync_playwright() as playwright:
        names = ("PRESETS", "STUDIES", "ARMS")
        own = {f"SLIDETUNE_{name}": str(Path(place) / name.lower()) for name in names}
        with running((), Path(place) / "log.txt", {**os.environ, **own}) as dashboard:
            browser = playwright.chromium.launch(executable_path=find(), args=list(FLAGS))
            for step in STEPS:
                if not wanted.only or step.name in wanted.only:
                    _take(browser, dashboard, step, wanted.folder)
            browser.close()


if __name__ == "__main__":
    main()
