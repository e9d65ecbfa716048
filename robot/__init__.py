"""Sliding-mode control of a JAKA Zu 5, headless: laws, closed loop, runs, presets."""

from __future__ import annotations

if __name__ != "slidetune.robot":  # else every module would be there twice
    raise ImportError("import slidetune.robot: robot is its folder, not its name", name=__name__)

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset, save_preset
from slidetune.robot.loop.simulate import Run, simulate
from slidetune.robot.version import __version__

__all__ = ["Experiment", "Run", "__version__", "load_preset", "save_preset", "simulate"]
