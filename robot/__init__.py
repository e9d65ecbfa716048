"""Sliding-mode control of a JAKA Zu 5, headless: laws, closed loop, runs, presets."""

from __future__ import annotations

from robot.experiment import Experiment

__all__ = ["Experiment"]
