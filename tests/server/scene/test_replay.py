"""Two runs side by side in the scene: their rows are shown, then the session again."""

from __future__ import annotations

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.robot.loop.simulate import simulate
from slidetune.server.live.lane_colors import LaneColors
from slidetune.server.scene.feed import SceneFeed
from slidetune.server.scene.replay import NOMINAL, OTHER, replay_of
from slidetune.server.scene.scene import Scene

LANES = {"A": {"law": "nftsm"}, "B": {"law": "rbfnn_smc"}}


def experiment(mass: float = 0.0) -> Experiment:
    payload = {"payload": {"mass": mass}}
    document = {"lanes": LANES, "simulation": {"horizon": 0.5}, "robot": payload}
    return Experiment.from_document(document)


def test_what_is_shown_is_what_both_runs_did() -> None:
    replay = replay_of(experiment(), experiment(3.0), "A", "#112233")
    for name, mass in ((NOMINAL, 0.0), (OTHER, 3.0)):
        run = simulate(experiment(mass), estimate=False)
        frame = replay.frame(100, 133)
        np.testing.assert_array_equal(frame.q[name], run.lanes["A"].q[133])
        np.testing.assert_array_equal(frame.paths[name], run.lanes["A"].flange[100:133])
        np.testing.assert_array_equal(frame.q_d, run.q_d[133])
    assert not replay.frame(0, 10).frozen
    assert replay.row(0.2504) == 250
    assert replay.row(0.6) is None
    assert [style.name for style in replay.styles] == [NOMINAL, OTHER]


def test_a_run_that_left_its_bounds_stands_where_it_stopped() -> None:
    gains = {"law": "smc", "k1": 900.0, "k2": 900.0, "switching": "sign"}
    simulation = {"horizon": 0.5, "mode": "sampled", "control_rate": 250.0}
    bad = Experiment.from_document({"lanes": {"A": gains}, "simulation": simulation})
    freeze = simulate(bad, estimate=False).lanes["A"].freeze
    assert freeze is not None
    replay = replay_of(bad, bad, "A", "#112233")
    last = len(replay.q_d) - 1
    frame = replay.frame(last - 5, last)
    assert frame.frozen == {NOMINAL, OTHER}
    assert np.isfinite(frame.q[NOMINAL]).all()
    assert len(frame.paths[NOMINAL]) == 0


@pytest.mark.scene
def test_the_session_is_shown_again_after_a_replay() -> None:
    colors = LaneColors()
    colors.assign(list(LANES))
    scene = Scene()
    try:
        feed = SceneFeed(scene, colors)
        loop = ClosedLoop(pack(experiment()), 64)
        shown: list[list[str]] = []
        configure = scene.configure

        def spy(styles, *rest):  # type: ignore[no-untyped-def]
            shown.append([style.name for style in styles])
            configure(styles, *rest)

        scene.configure = spy  # type: ignore[method-assign]
        feed.new_lanes([])
        replay = replay_of(experiment(), experiment(3.0), "A", "#112233")
        feed._draw_replay(0.0)
        feed.show_replay(replay)
        assert feed._draw_replay(10.0)
        assert feed._draw_replay(10.3)
        assert feed.replaying
        feed.show_replay(again := replay_of(experiment(), experiment(1.0), "A", "#112233"))
        assert feed._draw_replay(10.4)  # begins anew
        assert feed._draw_replay(10.8)
        assert not feed._draw_replay(11.0)
        assert not feed.replaying
        assert again.row(0.55) is None
        feed._configure(loop.packed, list(loop.lanes))
        assert shown == [[NOMINAL, OTHER], [NOMINAL, OTHER], ["A", "B"]]
    finally:
        scene.close()
