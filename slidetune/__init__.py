"""Sliding-mode control of a robot arm: experiments, runs, and the dashboard to tune them on.

`slidetune` is the one import name. The links beside this file stand for the folders of the same
names at the top of the repository; in a wheel the folders themselves are here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from slidetune.robot import Experiment, Run, __version__, load_preset, save_preset, simulate

if TYPE_CHECKING:
    from slidetune.server.client.dashboard import Dashboard

__all__ = ["Experiment", "Run", "__version__", "connect", "load_preset", "save_preset", "simulate"]


def connect(address: str = "http://127.0.0.1:8000/", token: str | None = None) -> Dashboard:
    """Connect to a dashboard that runs.

    Args:
        address: as the server printed it, with its ``?token=…`` where it has one.
        token: in place of that in the address.

    Raises:
        DashboardError: if no Slidetune answers there, or the token is refused.
    """
    from slidetune.server.client.dashboard import Dashboard  # HTTP is of no use to a run

    return Dashboard(address, token)
