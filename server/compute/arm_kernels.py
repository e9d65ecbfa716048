"""Compiles the kernels for an arm's number of joints without keeping the live session waiting."""

from __future__ import annotations

import logging
from contextlib import suppress
from threading import Thread

from slidetune.robot.arm.known import arm_named
from slidetune.robot.kernels.compiler import is_warm
from slidetune.robot.loop.warmup import warm_up_arm
from slidetune.server.compute.apart import LostProcessError, answer_once, ask_apart

log = logging.getLogger("slidetune.compute")

LIMIT = 600.0
"""Longest time that compiling may take in [s] (*ours*): half a minute, on a busy machine many."""


def load_kernels(model: str) -> None:
    """Compile or load all kernels for an arm; what takes long is done in a process of its own.

    Raises:
        ValueError: if no arm has that name.
    """
    if not is_warm(arm_named(model).joints):
        try:
            ask_apart(__name__, model, LIMIT)
        except LostProcessError as error:
            log.warning("Compiling apart for %s %s.\n%s", model, error.text, error.lines)
    warm_up_arm(model)  # from the disk by now


def compile_ahead(model: str) -> None:
    """Compile for an arm that somebody may begin with later, in a process that gives way."""
    if is_warm(arm_named(model).joints):
        return

    def work() -> None:
        with suppress(LostProcessError):  # it is tried again once it is asked for
            ask_apart(__name__, model, LIMIT)

    Thread(target=work, name="slidetune-compile-ahead", daemon=True).start()


def _compiled(model: str) -> bool:
    warm_up_arm(model)
    return True


if __name__ == "__main__":
    answer_once(_compiled)
