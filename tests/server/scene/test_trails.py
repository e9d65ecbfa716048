"""Trails, the desired path, and how deviations are drawn larger than they are."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slidetune.robot.arm.arm import flange_positions, shipped_places
from slidetune.server.scene.desired_path import DASH, PIECES, dashes
from slidetune.server.scene.exaggeration import WIDEST, exaggerated_angles
from slidetune.server.scene.trails import POINTS, SPAN, Stretch, Trail

Array = np.ndarray

PERIOD = 0.001
SPACING = round(SPAN / POINTS / PERIOD)
"""Rows between two points of a trail."""


def straight(first: int, last: int, deviation: float = 0.02) -> Stretch:
    """Return rows `first + 1` to `last` of joints that turn evenly, one of them lagging behind."""

    def angles(rows: Array) -> tuple[Array, Array]:
        q_d = np.outer(rows * PERIOD, [0.3, -0.2, 0.1, 0.2, 0.1, 0.3])
        return q_d, q_d - [deviation, 0.0, 0.0, 0.0, 0.0, 0.0]

    q_d, q = angles(np.arange(first + 1, last + 1))
    ends_d, ends = angles(np.array([first, last]))
    return Stretch(
        flange_positions(q_d, shipped_places()),
        flange_positions(q, shipped_places()),
        ends_d,
        ends,
        PERIOD,
    )


def trail_of(rows: int, factor: float = 1.0, chunk: int = 33) -> Trail:
    trail = Trail(shipped_places())
    for first in range(0, rows, chunk):
        trail.extend(straight(first, min(first + chunk, rows)), factor)
    return trail


def test_a_trail_has_one_length_for_ever() -> None:
    lengths = {trail_of(rows).points.shape for rows in (1, 500, 20_000)}
    assert lengths == {(POINTS, 3)}
    assert POINTS <= 300


def test_a_trail_is_where_the_flange_was() -> None:
    points, actual = trail_of(8000).points, straight(0, 8000).actual
    distances = np.linalg.norm(points[:, None] - actual[-round(SPAN / PERIOD) :], axis=2)
    assert distances.min(axis=1).max() < 1e-12


def test_a_trail_reaches_back_as_far_as_it_says() -> None:
    trail, actual = trail_of(20_000), straight(0, 20_000).actual
    back = round(SPAN / PERIOD)
    assert np.linalg.norm(trail.points[0] - actual[-back]) < 1.1 * SPACING * PERIOD
    assert np.linalg.norm(trail.points[-1] - actual[-1]) < 1.1 * SPACING * PERIOD


@given(st.lists(st.integers(1, 400), min_size=1, max_size=40), st.sampled_from([1.0, 10.0]))
def test_it_makes_no_difference_how_often_pictures_are_taken(
    chunks: list[int], factor: float
) -> None:
    often, rows = Trail(shipped_places()), 0
    for chunk in chunks:
        often.extend(straight(rows, rows + chunk), factor)
        rows += chunk
    seldom = trail_of(rows, factor, chunk=rows)
    assert often.empty == seldom.empty
    assert often.points == pytest.approx(seldom.points, abs=1e-9)


def test_a_trail_leads_to_the_flange_that_is_drawn() -> None:
    factor, stretch = 12.0, straight(0, 1 + 40 * SPACING)
    trail = Trail(shipped_places())
    trail.extend(stretch, factor)
    drawn = flange_positions(exaggerated_angles(stretch.q_d, stretch.q, factor), shipped_places())[
        -1
    ]
    assert np.linalg.norm(stretch.actual[-1] - drawn) > 0.1
    assert np.linalg.norm(trail.points[-1] - drawn) < 1e-6


def test_a_new_factor_redraws_the_whole_trail() -> None:
    changed = trail_of(3000, 1.0)
    changed.stretch_to(7.0)
    assert changed.points == pytest.approx(trail_of(3000, 7.0).points, abs=1e-12)
    changed.stretch_to(1.0)
    assert changed.points == pytest.approx(trail_of(3000, 1.0).points, abs=1e-12)


def test_a_coarse_simulation_loses_no_point() -> None:
    slow = straight(0, 10)
    coarse = Stretch(slow.desired, slow.actual, slow.q_d, slow.q, 2.0 * SPAN / POINTS)
    trail = Trail(shipped_places())
    trail.extend(coarse, 1.0)
    assert trail.points[-10:] == pytest.approx(slow.actual)


def test_a_cleared_trail_forgets() -> None:
    trail = trail_of(3000)
    trail.clear()
    assert trail.empty
    trail.extend(straight(5000, 5001), 1.0)
    assert trail.points == pytest.approx(np.tile(straight(5000, 5001).actual, (POINTS, 1)))


angles = st.lists(st.floats(-6.0, 6.0), min_size=6, max_size=6).map(np.array)


@given(angles, angles)
def test_a_factor_of_one_is_the_truth(q_d: Array, q: Array) -> None:
    assert exaggerated_angles(q_d, q, 1.0) == pytest.approx(q, abs=1e-12)


@given(angles, angles, st.floats(1.0, 50.0))
def test_exaggeration_never_turns_a_joint_back_or_past_half_a_turn(
    q_d: Array, q: Array, factor: float
) -> None:
    drawn, true = exaggerated_angles(q_d, q, factor) - q_d, q - q_d
    assert (np.abs(drawn) >= np.abs(true) - 1e-12).all()
    assert (np.abs(drawn) <= np.maximum(WIDEST, np.abs(true)) + 1e-12).all()
    assert (drawn * true >= 0.0).all()


@given(angles, st.floats(1.0, 50.0))
def test_small_deviations_are_drawn_in_proportion(q_d: Array, factor: float) -> None:
    deviation = np.array([0.01, -0.02, 0.03, 0.0, 0.05, -0.06])
    drawn = exaggerated_angles(q_d, q_d + deviation, factor) - q_d
    assert drawn == pytest.approx(factor * deviation, abs=1e-9)


def test_half_of_a_path_is_dashes() -> None:
    path = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0]])
    length = np.linalg.norm(np.diff(dashes(path), axis=1), axis=2).sum()
    assert length == pytest.approx(1.5, abs=2 * DASH)


def test_a_path_that_returns_on_itself_stays_dashed() -> None:
    angle = np.linspace(0.0, 15.0, 400)
    swing = np.column_stack([np.sin(angle), np.zeros(400), np.zeros(400)])
    length = np.linalg.norm(np.diff(dashes(swing), axis=1), axis=2).sum()
    assert length == pytest.approx(0.5 * 2.0, rel=0.1)


def test_a_long_path_has_no_more_dashes_than_allowed() -> None:
    path = np.array([[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]])
    assert len(dashes(path)) == PIECES // 2


@pytest.mark.parametrize("points", [0, 1, 50])
def test_a_path_that_stands_still_has_no_dashes(points: int) -> None:
    assert dashes(np.ones((points, 3))).shape == (0, 2, 3)
