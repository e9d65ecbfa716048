"""A lane in the scene while a past moment is shown, and after."""

from __future__ import annotations

import numpy as np

from slidetune.robot.arm.arm import shipped_places
from slidetune.server.scene.frame import SceneFrame, ShownLane
from slidetune.server.scene.trails import POINTS

ORIGIN = np.zeros(6)


def picture(
    angle: float, *, past: bool = False, frozen: bool = False, rows: int = 25
) -> SceneFrame:
    path = np.full((0 if past else rows, 3), angle)
    return SceneFrame(
        q_d=ORIGIN + angle,
        q={"A": ORIGIN + angle + 0.1},
        frozen=frozenset({"A"} if frozen else ()),
        desired_path=path,
        paths={"A": path},
        period=0.001,
        past=past,
    )


def standing(lane: ShownLane) -> tuple[float, float]:
    assert lane.q_d is not None
    assert lane.q is not None
    return float(lane.q_d[0]), float(lane.q[0])


def test_a_lane_stands_where_it_was_with_what_was_desired_then() -> None:
    lane = ShownLane(shipped_places())
    lane.take("A", picture(2.0), 1.0)
    lane.take("A", picture(1.0, past=True), 1.0)
    assert standing(lane) == (1.0, 1.1)


def test_the_trail_does_not_follow_a_look_back() -> None:
    lane = ShownLane(shipped_places())
    lane.take("A", picture(2.0), 1.0)
    before = lane.trail.points.copy()
    for angle in (1.0, 0.5):
        lane.take("A", picture(angle, past=True), 1.0)
    np.testing.assert_array_equal(lane.trail.points, before)
    # Exaggerated or not, what comes next starts from the present and not from the past.
    lane.take("A", picture(2.1), 20.0)
    other = ShownLane(shipped_places())
    for angle in (2.0, 2.1):
        other.take("A", picture(angle), 20.0)
    np.testing.assert_allclose(lane.trail.points[-1], other.trail.points[-1])
    assert len(lane.trail.points) == POINTS


def test_a_stopped_lane_is_seen_moving_and_then_stands_still_again() -> None:
    lane = ShownLane(shipped_places())
    lane.take("A", picture(2.0), 1.0)
    lane.take("A", picture(3.0, frozen=True), 1.0)
    assert standing(lane) == (2.0, 2.1)
    lane.take("A", picture(1.0, past=True), 1.0)
    assert not lane.frozen
    assert standing(lane) == (1.0, 1.1)
    lane.take("A", picture(4.0, frozen=True), 1.0)
    assert lane.frozen
    assert standing(lane) == (2.0, 2.1)
