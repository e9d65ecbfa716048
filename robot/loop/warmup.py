"""Compiles every kernel before it is needed, with progress: the first time takes half a minute."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba.core import event

from slidetune.robot.arm.known import SHIPPED, arm_named
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import compiled_count, mark_warm
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.robot.loop.response import lane_response
from slidetune.robot.margins.margin import loop_margin

Progress = Callable[[int, int], None]


class _Listener(event.Listener):
    """Tells how many kernels are compiled, whenever one more is."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress

    def on_start(self, event: Any) -> None:
        """Say nothing: it takes its time now."""

    def on_end(self, event: Any) -> None:
        """Tell that one more is compiled."""
        self._progress(*compiled_count())


def _experiment(law: str, mode: str, model: str = SHIPPED) -> Experiment:
    simulation = {"mode": mode, "horizon": 0.1, "step": 0.005, "control_rate": 200.0}
    lanes = {"A": {"law": law}}
    return Experiment.from_document(
        {"robot": {"model": model}, "lanes": lanes, "simulation": simulation}
    )


def _use(experiment: Experiment) -> None:
    """Do everything once that is done with an experiment: a live step, a response, its margin."""
    packed = pack(experiment)
    loop = ClosedLoop(packed, 4)
    for _ in range(3):
        loop.step()
    lane_response(experiment, "A")
    loop_margin(packed, "A")


def warm_up(progress: Progress | None = None) -> None:
    """Use every law in both modes, so that all kernels are compiled and loaded.

    Args:
        progress: called with how many kernels are compiled, and how many there are, at the
            beginning and whenever there is one more; never where they only have to be loaded.
    """
    listener = _Listener(progress or (lambda *_: None))
    with event.install_listener("numba:compile", listener):
        for law in LAWS:
            for mode in ("continuous", "sampled"):
                _use(_experiment(law, mode))
    mark_warm()


_READY = {JOINTS}
"""Numbers of joints that this process has kernels for."""


def warm_up_arm(model: str) -> None:
    """Do the same for an arm with another number of joints, once a process.

    The first time ever it takes as long as for the shipped arm, else some seconds.

    Args:
        model: name of the arm.

    Raises:
        ValueError: if no arm has that name.
    """
    joints = arm_named(model).joints
    if joints in _READY:
        return
    for law in LAWS:
        for mode in ("continuous", "sampled"):
            _use(_experiment(law, mode, model))
    mark_warm(joints)
    _READY.add(joints)
