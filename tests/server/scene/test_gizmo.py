"""Pulling the arm: real messages of a browser to a real Viser."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from slidetune.robot.arm.arm import flange_positions, shipped_places
from slidetune.robot.arm.known import SHIPPED
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.kernels.workspace import PUSH, Q
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.server.live.pull import Grip, Pull, flange_grip, grip_at
from slidetune.server.live.push import Push
from slidetune.server.scene.arm import SolidArm
from slidetune.server.scene.gizmo import PATIENCE, STIFFNESS, STRONGEST, Gizmo
from slidetune.server.scene.shape import shape_of
from slidetune.server.scene.viewer import Viewer, close_viewer, open_viewer
from tests.server.scene.viser_client import ViserClient, until

Array = np.ndarray

FLANGE = np.array([0.4, -0.2, 0.6])
HANDLE, ARROW = "/pull", "/pull_arrow"
ANGLES = np.array([0.3, -0.8, 1.1, 0.4, -0.6, 0.2])
FOREARM = 3


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
    gizmo, shape = Gizmo(viewer, clock), shape_of(SHIPPED)
    gizmo.take(shape, SolidArm(viewer.scene, "/arm", shape).links)
    gizmo.follow(FLANGE, ANGLES)
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
    now = gizmo.pull()
    return now is not None and np.allclose(now.force, force)


def arrow(browser: ViserClient) -> Array:
    """Return tail and head of the arrow as the browser knows them in [m]. Shape (2, 3)."""
    ends: Array = browser.nodes[ARROW]["points"].reshape(2, 3)
    return ends


def hold(browser: ViserClient, gizmo: Gizmo, offset: tuple[float, float, float]) -> None:
    browser.drag("start", HANDLE)
    browser.drag("update", HANDLE, beside(*offset))
    until(lambda: pulled(gizmo, STIFFNESS * np.array(offset)))


def test_nothing_pulls_until_somebody_takes_the_handle(gizmo: Gizmo) -> None:
    assert gizmo.pull() is None


def test_the_handle_is_large_however_far_away_it_is(browser: ViserClient) -> None:
    handle = browser.nodes[HANDLE]
    assert handle["fixed"]
    assert handle["scale"] >= 80.0  # px
    assert handle["line_width"] >= 4.0


def test_the_force_is_that_of_the_spring(gizmo: Gizmo, browser: ViserClient) -> None:
    hold(browser, gizmo, (0.1, -0.05, 0.2))


def test_the_force_follows_both_ends_of_the_spring(gizmo: Gizmo, browser: ViserClient) -> None:
    hold(browser, gizmo, (0.1, 0.0, 0.0))
    gizmo.follow(beside(0.02, 0.0, 0.0), ANGLES)
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
    until(lambda: gizmo.pull() is None)
    there = beside(0.0, 0.0, 0.01)
    gizmo.follow(there, ANGLES)
    until(lambda: np.allclose(browser.poses[HANDLE]["position"], there))


def test_a_browser_that_leaves_pulls_no_more(gizmo: Gizmo, browser: ViserClient) -> None:
    hold(browser, gizmo, (0.1, 0.0, 0.0))
    browser.close()
    until(lambda: gizmo.pull() is None)


def test_a_steady_hand_pulls_on_and_a_forgotten_one_does_not(
    gizmo: Gizmo, browser: ViserClient, clock: Clock
) -> None:
    hold(browser, gizmo, (0.1, 0.0, 0.0))
    clock.time += 0.9 * PATIENCE
    assert gizmo.pull() is not None
    clock.time += 0.2 * PATIENCE
    assert gizmo.pull() is None
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
            gizmo.follow(beside(0.0, 0.0, 0.01 * step), ANGLES)
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
    assert not browser.visible[ARROW]
    hold(browser, gizmo, (0.3, 0.0, 0.0))
    gizmo.follow(FLANGE, ANGLES)
    until(lambda: browser.visible[ARROW])
    pull = beside(0.3, 0.0, 0.0)
    until(lambda: np.allclose(arrow(browser), [FLANGE, pull], atol=1e-6))
    browser.drag("end", HANDLE)
    until(lambda: not browser.visible[ARROW], lambda: gizmo.follow(FLANGE, ANGLES))


def test_a_drag_with_shift_pulls_the_link_at_the_point_that_it_took(
    gizmo: Gizmo, browser: ViserClient
) -> None:
    (forearm,) = (name for name in browser.nodes if name == "/arm/1/2/3")
    bindings = browser.bindings[forearm]
    assert [(each["button"], each["modifier"]) for each in bindings] == [("left", "shift")]
    taken = Grip(FOREARM, np.array([0.1, 0.02, 0.03]))
    start, away = taken.place(shape_of(SHIPPED).model, ANGLES), np.array([0.1, 0.2, -0.05])
    browser.drag_node("start", forearm, start, start, "shift")
    browser.drag_node("update", forearm, start, start + away, "shift")
    until(lambda: pulled(gizmo, STIFFNESS * away))
    now = gizmo.pull()
    assert now is not None
    assert now.grip.joint == FOREARM
    assert now.grip.point == pytest.approx(taken.point)
    # The arm moves on under a hand that stays, and the handle goes with its flange.
    moved = ANGLES + 0.05
    gizmo.follow(beside(0.0, 0.0, 0.01), moved)
    assert pulled(gizmo, STIFFNESS * (start + away - taken.place(shape_of(SHIPPED).model, moved)))
    until(lambda: np.allclose(browser.poses[HANDLE]["position"], beside(0.0, 0.0, 0.01)))
    # The news of two nodes may come in two frames.
    until(lambda: np.allclose(arrow(browser)[0], taken.place(shape_of(SHIPPED).model, moved)))
    for nonsense in (np.nan, 1e300):
        browser.drag_node("update", forearm, start, (0.0, nonsense, 0.0), "shift")
    browser.drag_node("end", forearm, start, start, "shift")
    until(lambda: gizmo.pull() is None)


def test_a_drag_without_shift_leaves_the_arm_alone(gizmo: Gizmo, browser: ViserClient) -> None:
    (forearm,) = (name for name in browser.nodes if name == "/arm/1/2/3")
    browser.drag_node("start", forearm, FLANGE, FLANGE, None)
    browser.drag_node("update", forearm, FLANGE, beside(0.1, 0.0, 0.0), None)
    browser.drag("start", HANDLE)
    until(lambda: pulled(gizmo, np.zeros(3)))  # Viser hears in order


def test_a_pull_does_the_work_of_its_force_on_every_lane() -> None:
    loop = ClosedLoop(pack(load_preset("paper")), 16)
    for _ in range(50):
        loop.step()
    grip, force = Grip(FOREARM, np.array([0.1, 0.02, 0.03])), np.array([20.0, -7.0, 12.0])
    assert Push().apply(loop, Pull(grip, force), 16) == 16
    for lane in loop.lanes.values():
        q, step = lane.work[Q].copy(), 1e-6
        for joint, turn in enumerate(np.eye(6) * step):
            model = loop.packed.model
            moved = (grip.place(model, q + turn) - grip.place(model, q - turn)) / (2 * step)
            assert lane.work[PUSH][joint] == pytest.approx(force @ moved, abs=1e-6)


def test_a_grip_is_found_again_where_it_was_taken() -> None:
    model, tip = shape_of(SHIPPED).model, shape_of(SHIPPED).tip
    assert flange_grip(model, tip).place(model, ANGLES) == pytest.approx(
        flange_positions(ANGLES[None], shipped_places())[0]
    )
    for joint in range(1, 7):
        held = grip_at(model, joint, FLANGE, ANGLES)
        assert held.place(model, ANGLES) == pytest.approx(FLANGE)
