"""What is compiled before the first experiment: all that any of them needs."""

from __future__ import annotations

from typing import Any

import pytest
from numba.core import event

from slidetune.robot.advice.advice import advice_on
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset, presets
from slidetune.robot.kernels.compiler import compiled_count, kernel
from slidetune.robot.lenses import look_through
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.robot.loop.response import lane_response
from slidetune.robot.loop.warmup import warm_up

SHIPPED = [preset.name for preset in presets() if preset.shipped]


class Compiled(event.Listener):
    """Keeps what is compiled while it listens."""

    def __init__(self) -> None:
        self.names: list[str] = []

    def on_start(self, event: Any) -> None:
        self.names.append(str(event.data["dispatcher"]))

    def on_end(self, event: Any) -> None:
        pass


@pytest.fixture(scope="module", autouse=True)
def warm() -> None:
    warm_up()


@pytest.mark.parametrize("name", SHIPPED)
def test_nothing_is_left_to_be_compiled_when_an_experiment_is_used(name: str) -> None:
    experiment = load_preset(name).patched({"simulation": {"horizon": 0.3}})
    packed, found = pack(experiment), Compiled()
    with event.install_listener("numba:compile", found):
        loop = ClosedLoop(packed, 8)
        for _ in range(20):
            loop.step()
        for lane in experiment.lanes:
            lane_response(experiment, lane)
            look_through(experiment, lane)
        advice_on(packed, next(iter(experiment.lanes)))
    assert found.names == []


def test_what_is_compiled_already_has_no_progress_to_tell() -> None:
    told: list[tuple[int, int]] = []
    warm_up(lambda *share: told.append(share))
    assert told == []


def test_progress_counts_kernels_that_are_compiled() -> None:
    @kernel
    def one_more(x):  # type: ignore[no-untyped-def]
        return x + 1.0

    done, total = compiled_count()
    assert one_more(1.0) == 2.0
    assert compiled_count() == (done + 1, total)
