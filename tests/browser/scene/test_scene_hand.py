"""A hand in the scene that the real Viser draws: it pushes the arm, turns the camera and back."""

from __future__ import annotations

import io
import time
from collections.abc import Iterator
from contextlib import contextmanager
from urllib.parse import urlsplit

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page, expect

from slidetune.robot.arm.known import SHIPPED
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.kernels.workspace import Q
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.server.live.pull import Grip
from slidetune.server.scene.shape import shape_of
from slidetune.server.scene.viewer import CAMERA, FIELD_OF_VIEW, LOOK_AT
from tests.browser.conftest import Complaints, Dashboard
from tests.server.scene.viser_client import ViserClient

Array = np.ndarray

ARROW = "/pull_arrow"
UPPER_ARM = 2
DEADLINE = 90.0
"""Longest wait for a picture in [s]: it is drawn in software."""


def upper_arm() -> Array:
    """Return a point in the upper arm as it stands at the beginning in [m]. Shape (3,)."""
    loop = ClosedLoop(pack(load_preset("paper")), 1)
    vertices = shape_of(SHIPPED).ghosts[1][0]
    middle = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    return Grip(UPPER_ARM, middle).place(loop.packed.model, loop.lanes["RBFNN-NFTSM"].work[Q])


def pixel(page: Page, point: Array) -> tuple[float, float]:
    """Return where the home view shows a point."""
    box = page.locator(".scene-frame").bounding_box()
    assert box is not None
    ahead = np.subtract(LOOK_AT, CAMERA)
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    ray = point - CAMERA
    scale = 0.5 * box["height"] / np.tan(0.5 * FIELD_OF_VIEW) / (ray @ ahead)
    middle = box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]
    return middle[0] + scale * (ray @ right), middle[1] - scale * (ray @ np.cross(right, ahead))


@contextmanager
def drag(page: Page, start: tuple[float, float], shift: bool = False) -> Iterator[None]:
    """Hold the pointer to the right of and above where it went down."""
    page.mouse.move(*start)
    if shift:
        page.keyboard.down("Shift")
    page.mouse.down()
    page.mouse.move(start[0] + 90, start[1] - 60, steps=6)
    yield
    page.mouse.up()
    if shift:
        page.keyboard.up("Shift")


def picture(page: Page) -> Array:
    shot = page.frame_locator(".scene-frame").locator("canvas").last.screenshot()
    return np.asarray(Image.open(io.BytesIO(shot)).convert("L"), dtype=float)


def difference(page: Page, before: Array) -> float:
    """Return the share of pixels that are not what they were."""
    return float((np.abs(picture(page) - before) > 30.0).mean())


def until_still(page: Page) -> None:
    """Wait until the scene is drawn and its camera has come to rest."""
    end = time.monotonic() + DEADLINE
    before = picture(page)
    page.wait_for_timeout(500)
    while before.std() < 1.0 or difference(page, before) > 0.0:
        assert time.monotonic() < end, "the scene did not come to rest"
        before = picture(page)
        page.wait_for_timeout(500)


def pushed(page: Page, scene: ViserClient, start: tuple[float, float], shift: bool) -> Array | None:
    """Drag; return where the arrow of the push begins, or nothing if there was none for long."""
    with drag(page, start, shift):
        end = time.monotonic() + 3.0
        while not scene.visible[ARROW]:
            if time.monotonic() > end:
                return None
            page.wait_for_timeout(100)
        tail: Array = scene.nodes[ARROW]["points"].reshape(2, 3)[0]
    end = time.monotonic() + DEADLINE
    while scene.visible[ARROW]:
        assert time.monotonic() < end, "the push went on after the hand had let go"
        page.wait_for_timeout(100)
    return tail


def until_pushed(page: Page, scene: ViserClient, start: tuple[float, float], shift: bool) -> Array:
    end = time.monotonic() + DEADLINE
    while (tail := pushed(page, scene, start, shift)) is None:
        assert time.monotonic() < end, "nothing was pushed"
    return tail


@pytest.mark.scene
def test_shift_pushes_the_arm_where_it_is_taken_and_v_brings_the_camera_home(
    page: Page, dashboard: Dashboard, complaints: Complaints
) -> None:
    complaints.allow("Unable to preventDefault")  # Viser's own, at every drag of a node
    for command in ("pause", "reset"):
        dashboard.client.post(f"/api/session/{command}").raise_for_status()
    page.goto(dashboard.url)
    inside = page.frame_locator(".scene-frame")
    expect(inside.locator("canvas").first).to_be_visible()
    until_still(page)
    taken = upper_arm()
    start = pixel(page, taken)
    with ViserClient(urlsplit(dashboard.url).port or 80, "/scene/") as scene:
        tail = until_pushed(page, scene, start, shift=True)
        # The pointer meets the arm's skin, in front of the point within.
        assert np.linalg.norm(tail - taken) < 0.1
        home = picture(page)
        # With the camera where it was the same pixel is the same point of the arm.
        again = until_pushed(page, scene, start, shift=True)
        assert np.linalg.norm(again - tail) < 0.005
        assert difference(page, home) < 0.01
        # Without Shift it is the camera that turns.
        assert pushed(page, scene, start, shift=False) is None
        assert difference(page, home) > 0.05
        page.keyboard.press("v")
        end = time.monotonic() + DEADLINE
        while difference(page, home) > 0.01:
            assert time.monotonic() < end, "the camera did not come home"
            page.wait_for_timeout(200)
        # A finger has no Shift: the switch stands for it.
        page.locator(".scene-bar").get_by_text("push").click()
        finger = until_pushed(page, scene, start, shift=False)
        assert np.linalg.norm(finger - tail) < 0.005
        # Of Viser's own page there is the picture, and what it warns of.
        expect(inside.get_by_text("Reset View")).to_be_hidden()
        expect(inside.locator("input").first).to_be_hidden()
