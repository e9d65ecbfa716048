"""Dashed lines of whole responses, in a real Viser."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
import viser

from slidetune.server.scene.frame import LaneStyle
from slidetune.server.scene.response_paths import ResponsePaths
from slidetune.server.scene.viewer import close_viewer, open_viewer

LANES = [LaneStyle("A", "#0072B2"), LaneStyle("B", "#D55E00")]


def circle(radius: float) -> np.ndarray:
    angle = np.linspace(0.0, 6.0, 200)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), 0.0 * angle], axis=1)


@pytest.fixture
def viewer() -> Iterator[viser.ViserServer]:
    viewer = open_viewer(None)
    yield viewer
    close_viewer(viewer)


def names(viewer: viser.ViserServer) -> list[str]:
    return sorted(name for name in viewer.scene._handle_from_node_name if "/response" in name)


def test_a_thousand_responses_need_as_many_nodes_as_lanes(viewer: viser.ViserServer) -> None:
    paths = ResponsePaths(viewer.scene, "/response")
    for index in range(1000):
        paths.draw({"A": circle(0.1 + index / 1e4), "B": circle(0.2)}, LANES)
    assert len(names(viewer)) == 2


def test_a_lane_without_a_path_has_no_line(viewer: viser.ViserServer) -> None:
    paths = ResponsePaths(viewer.scene, "/response")
    paths.draw({"A": circle(0.1), "B": circle(0.2)}, LANES)
    paths.draw({"B": circle(0.2)}, LANES)
    shown = [viewer.scene._handle_from_node_name[name].visible for name in names(viewer)]
    assert shown == [True, False]
    paths.draw({}, LANES)
    assert not any(viewer.scene._handle_from_node_name[name].visible for name in names(viewer))


def test_hidden_lines_come_back_as_they_were(viewer: viser.ViserServer) -> None:
    paths = ResponsePaths(viewer.scene, "/response")
    paths.draw({"A": circle(0.1)}, LANES)
    paths.show(False)
    assert not viewer.scene._handle_from_node_name[names(viewer)[0]].visible
    paths.show(True)
    assert viewer.scene._handle_from_node_name[names(viewer)[0]].visible
