"""Pulling the arm: real messages of a browser to a real Viser."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from server.gizmo import PATIENCE, STIFFNESS, STRONGEST, Gizmo
from server.viewer import Viewer, close_viewer, open_viewer
from tests.server.viser_client import ViserClient, until

Array = np.ndarray

FLANGE = np.array([0.4, -0.2, 0.6])
HANDLE = "/pull"


class Clock:
    """A clock that stands until it is set."""

    time = 100.0

    def __call__(self) -> float:
        return self.time


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def viewer() -> Iterator[Viewer]:
    viewer = open_viewer(None)
    yield viewer
    close_viewer(viewer)


@pytest.fixture
def gizmo(viewer: Viewer, clock: Clock) -> Gizmo:
    gizmo = Gizmo(viewer, clock)
    gizmo.follow(FLANGE)
    return gizmo


@pytest.fixture
def browser(viewer: Viewer, gizmo: Gizmo) -> Iterator[ViserClient]:
    with ViserClient(viewer.get_port()) as browser:
        until(lambda: len(viewer.get_clients()) == 1)
        yield browser


def beside(x: float, y: float, z: float) -> Array:
    there: Array = FLANGE + np.array([x, y, z])
    return there


def pulled(gizmo: Gizmo, force: Array) -> bool:
    now = gizmo.force()
    return now is not None and np.allclose(now, force)


def hold(browser: ViserClient, gizmo: Gizmo, offset: tuple[float, float, float]) -> None:
    browser.drag("start", HANDLE)
    browser.drag("update", HANDLE, beside(*offset))
    until(lambda: pulled(gizmo, STIFFNESS * np.array(offset)))


def test_nothing_pulls_until_somebody_takes_the_handle(gizmo: Gizmo) -> None:
    assert gizmo.force() is None


def test_the_force_is_that_of_the_spring(gizmo: Gizmo, browser: ViserClient) -> None:
    hold(browser, gizmo, (0.1, -0.05, 0.2))


def test_the_force_follows_both_ends_of_the_spring(gizmo: Gizmo, browser: ViserClient) -> None:
    hold(browser, gizmo, (0.1, 0.0, 0.0))
    gizmo.follow(beside(0.02, 0.0, 0.0))
    assert pulled(gizmo, np.array([0.08 * STIFFNESS, 0.0, 0.0]))
    browser.drag("update", HANDLE, beside(0.02, 0.0, 0.1))
    until(lambda: pulled(gizmo, np.array([0.0, 0.0, 0.1 * STIFFNESS])))


def test_the_force_has_a_ceiling_and_keeps_its_direction(
    gizmo: Gizmo, browser: ViserClient
) -> None:
    browser.drag("start", HANDLE)
    browser.drag("update", HANDLE, beside(3.0, 0.0, -4.0))
    until(lambda: pulled(gizmo, STRONGEST * np.array([0.6, 0.0, -0.8])))


@pytest.mark.parametrize("nonsense", [np.nan, np.inf, 1e300])
def test_nonsense_from_a_browser_is_not_believed(
    gizmo: Gizmo, browser: ViserClient, nonsense: float
) -> None:
    hold(browser, gizmo, (0.1, 0.0, 0.0))
    browser.drag("update", HANDLE, (0.0, nonsense, 0.0))
    until(lambda: gizmo._handle.position[0] == 0.0)
    assert pulled(gizmo, np.array([0.1 * STIFFNESS, 0.0, 0.0]))


def test_a_touched_handle_does_not_pull(gizmo: Gizmo, browser: ViserClient) -> None:
    browser.drag("start", HANDLE)
    until(lambda: pulled(gizmo, np.zeros(3)))


def test_letting_go_ends_the_pull_and_returns_the_handle(
    gizmo: Gizmo, browser: ViserClient
) -> None:
    hold(browser, gizmo, (0.1, 0.1, 0.1))
    browser.drag("end", HANDLE)
    until(lambda: gizmo.force() is None)
    there = beside(0.0, 0.0, 0.01)
    gizmo.follow(there)
    until(lambda: np.allclose(browser.poses[HANDLE]["position"], there))


def test_a_browser_that_leaves_pulls_no_more(gizmo: Gizmo, browser: ViserClient) -> None:
    hold(browser, gizmo, (0.1, 0.0, 0.0))
    browser.close()
    until(lambda: gizmo.force() is None)


def test_a_steady_hand_pulls_on_and_a_forgotten_one_does_not(
    gizmo: Gizmo, browser: ViserClient, clock: Clock
) -> None:
    hold(browser, gizmo, (0.1, 0.0, 0.0))
    clock.time += 0.9 * PATIENCE
    assert gizmo.force() is not None
    clock.time += 0.2 * PATIENCE
    assert gizmo.force() is None
    browser.drag("update", HANDLE, beside(0.2, 0.0, 0.0))
    until(lambda: pulled(gizmo, np.array([0.2 * STIFFNESS, 0.0, 0.0])))


def test_the_handle_stays_with_the_hand_while_the_arm_moves(
    viewer: Viewer, gizmo: Gizmo, browser: ViserClient
) -> None:
    with ViserClient(viewer.get_port()) as watcher:
        until(lambda: len(viewer.get_clients()) == 2)
        hold(browser, gizmo, (0.1, 0.0, 0.0))
        until(lambda: np.allclose(watcher.poses[HANDLE]["position"], beside(0.1, 0.0, 0.0)))
        for step in range(5):
            gizmo.follow(beside(0.0, 0.0, 0.01 * step))
        viewer.scene.add_frame("/after")
        until(lambda: "/after" in watcher.nodes)
        assert np.allclose(watcher.poses[HANDLE]["position"], beside(0.1, 0.0, 0.0))


def test_the_handle_belongs_to_the_first_hand(
    viewer: Viewer, gizmo: Gizmo, browser: ViserClient
) -> None:
    with ViserClient(viewer.get_port()) as other:
        until(lambda: len(viewer.get_clients()) == 2)
        hold(browser, gizmo, (0.1, 0.0, 0.0))
        other.drag("start", HANDLE)
        other.drag("update", HANDLE, beside(0.0, 0.3, 0.0))
        other.drag("end", HANDLE)
        # What the first one is sent on its account says that Viser has heard the second.
        until(lambda: np.allclose(browser.poses[HANDLE]["position"], beside(0.0, 0.3, 0.0)))
        assert pulled(gizmo, np.array([0.1 * STIFFNESS, 0.0, 0.0]))


def test_the_arrow_shows_the_force_while_there_is_one(gizmo: Gizmo, browser: ViserClient) -> None:
    arrow = "/pull_arrow"
    assert not browser.visible[arrow]
    hold(browser, gizmo, (0.3, 0.0, 0.0))
    gizmo.follow(FLANGE)
    until(lambda: browser.visible[arrow])
    tail, head = browser.nodes[arrow]["points"].reshape(2, 3)
    assert tail == pytest.approx(FLANGE)
    assert STIFFNESS * (head - tail) == pytest.approx([0.3 * STIFFNESS, 0.0, 0.0], abs=1e-3)
    browser.drag("end", HANDLE)
    until(lambda: not browser.visible[arrow], lambda: gizmo.follow(FLANGE))
