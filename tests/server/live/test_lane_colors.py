"""Colours of lanes."""

from __future__ import annotations

from slidetune.server.live.lane_colors import PALETTE, LaneColors


def colors_of(*steps: list[str]) -> dict[str, str]:
    colors = LaneColors()
    for lanes in steps:
        colors.assign(lanes)
    return {entry["name"]: entry["color"] for entry in colors.document()}


def test_six_lanes_have_six_colours() -> None:
    assert len(set(colors_of(list("ABCDEF")).values())) == len(PALETTE) == 6


def test_a_lane_keeps_its_colour_when_others_go() -> None:
    assert colors_of(["A", "B", "C"], ["B", "C"], ["C"])["C"] == PALETTE[2]


def test_a_new_lane_takes_a_free_colour() -> None:
    colors = colors_of(["A", "B", "C"], ["B", "C"], ["B", "C", "D"])
    assert colors["D"] == PALETTE[0]


def test_a_renamed_lane_keeps_its_colour() -> None:
    assert colors_of(["A", "B"], ["A", "X"])["X"] == PALETTE[1]
