"""Sliding-mode control of a robot arm: experiments, runs, and the dashboard to tune them on.

`slidetune` is the one import name. The links beside this file stand for the folders of the same
names at the top of the repository; in a wheel the folders themselves are here.
"""

from __future__ import annotations

from slidetune.robot import Experiment, Run, __version__, load_preset, save_preset, simulate

__all__ = ["Experiment", "Run", "__version__", "load_preset", "save_preset", "simulate"]
