"""The server with two broken laws: SMC raises after a while, PD gives NaN at one gain.

Run it like the server: ``python -m tests.trust.faults.broken_laws serve``.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from slidetune.robot.integrator.law_call import Control
from slidetune.robot.laws import LAWS
from slidetune.robot.laws.computed_torque import ComputedTorque
from slidetune.server.cli import main

CALLS = 5000
"""How often SMC does its work before it raises for good; to warm up takes some 1600 calls."""
POISON = 398.0
"""Gain k_d at which the numbers of PD are none."""
MESSAGE = "broken on purpose"
PACK = ComputedTorque.pack


def raising(kernel: Control) -> Control:
    """Return a kernel that raises once it has been called often enough."""
    left = iter(range(CALLS))

    def failing(*given: Any) -> None:
        if next(left, None) is None:
            raise ArithmeticError(MESSAGE)
        kernel(*given)

    return failing


def poisoned(gains: ComputedTorque) -> np.ndarray:
    """Return what PD packs, or at one gain what comes of dividing nothing by nothing."""
    block = PACK(gains)
    return block * np.nan if np.max(gains.kd) == POISON else block


def break_laws() -> None:
    """Let SMC raise, and PD be poisoned."""
    law = LAWS["smc"]
    LAWS["smc"] = replace(law, control=raising(law.control))
    ComputedTorque.pack = poisoned  # type: ignore[method-assign]


if __name__ == "__main__":
    break_laws()
    main()
