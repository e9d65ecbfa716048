"""Sliding-mode control of a JAKA Zu 5, headless: laws, closed loop, runs, presets."""

from __future__ import annotations

from robot.experiment import Experiment
from robot.presets import load_preset, save_preset
from robot.simulate import Run, simulate
from robot.version import __version__

__all__ = ["Experiment", "Run", "__version__", "load_preset", "save_preset", "simulate"]
