"""The live session says where its steps are too long."""

from __future__ import annotations

import re
from typing import Any

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.server.live.roughness import WINDOW, Roughness

WILD = {"law": "computed_torque", "kp": 9000.0, "kd": 0.2}
CALM = {"law": "computed_torque"}


def stepped(
    lanes: dict[str, Any], seconds: float, **simulation: Any
) -> tuple[ClosedLoop, Roughness]:
    document = {
        "robot": {"armature": 0.3},
        "lanes": lanes,
        "simulation": {"initial_error": 0.3, "step": 0.005, **simulation},
    }
    loop = ClosedLoop(pack(Experiment.from_document(document)), 512)
    roughness = Roughness()
    for _ in range(round(seconds / loop.period)):
        loop.step()
        roughness.look(loop)
    return loop, roughness


def test_a_lane_that_asks_for_shorter_steps_is_told_of_and_no_other() -> None:
    _, roughness = stepped({"Wild": WILD, "Calm": CALM}, 1.5 * WINDOW)
    said = roughness.remark("Wild")
    assert said is not None
    assert re.match(r"(9\d|100)% of its live steps", said)
    assert "approximate" in said
    assert roughness.remark("Calm") is None
    assert roughness.remark("nobody") is None


def test_nothing_is_said_before_enough_was_seen() -> None:
    _, roughness = stepped({"Wild": WILD}, 0.5 * WINDOW)
    assert roughness.remark("Wild") is None


def test_a_remark_goes_when_its_reason_does() -> None:
    loop, roughness = stepped({"Wild": WILD}, 1.5 * WINDOW)
    loop.adopt(pack(loop.packed.experiment.patched({"lanes": {"Wild": {"kp": 400.0, "kd": 40.0}}})))
    for _ in range(round(2.5 * WINDOW / loop.period)):
        loop.step()
        roughness.look(loop)
    assert roughness.remark("Wild") is None


def test_a_start_with_a_jolt_is_not_worth_a_remark() -> None:
    _, roughness = stepped({"A": {"law": "rbfnn_nftsm"}}, 2.0, step=0.001, initial_velocity="rest")
    assert roughness.remark("A") is None


def test_going_back_in_time_begins_to_count_anew() -> None:
    loop, roughness = stepped({"Wild": WILD}, 1.5 * WINDOW)
    early, _ = stepped({"Wild": WILD}, 0.5 * WINDOW)
    # A lane that was not there then keeps what it counted; no row is left of it.
    wild = early.packed.experiment.lanes["Wild"].model_dump()
    loop.adopt(pack(loop.packed.experiment.patched({"lanes": {"New": wild}})), {"New": "Wild"})
    for _ in range(round(0.4 * WINDOW / loop.period)):
        loop.step()
        roughness.look(loop)
    loop.restore(early.state())
    loop.step()
    roughness.look(loop)
    assert roughness.remark("Wild") is None
    assert roughness.remark("New") is None
    for _ in range(round(1.1 * WINDOW / loop.period)):
        loop.step()
        roughness.look(loop)
    said = roughness.remark("Wild")
    assert said is not None
    assert re.match(r"(9\d|100)% of its live steps", said)


def test_a_restart_forgets() -> None:
    _, roughness = stepped({"Wild": WILD}, 1.5 * WINDOW)
    roughness.restart()
    assert roughness.remark("Wild") is None
