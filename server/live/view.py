"""What the session feeds with what it does."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.server.live.pull import Pull
from slidetune.server.live.telemetry import Channel

Array = np.ndarray


class View(Protocol):
    """What the session feeds; see ``server.scene.feed``."""

    def pull(self) -> Pull | None:
        """Return how somebody pulls at the arm, or ``None``."""

    def new_lanes(self, columns: list[Channel]) -> None:
        """Take the columns of other lanes."""

    def add(self, rows: Array, period: float) -> None:
        """Take new rows of telemetry."""

    def restart(self) -> None:
        """Forget the past: time has run back."""

    def restart_lane(self, name: str) -> None:
        """Forget one lane's past: it begins anew elsewhere."""

    def draw(self, loop: ClosedLoop) -> None:
        """Show the present, if it is time."""

    def prepare(self, model: str) -> None:
        """Do what takes long before an arm can be shown."""
