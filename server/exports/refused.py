"""Exports that can't be made."""

from __future__ import annotations

from slidetune.robot.errors import SlidetuneError


class NoRowsError(SlidetuneError, RuntimeError):
    """Of a session that has made no step yet."""


class ExportError(SlidetuneError, OSError):
    """For lack of room, or of time."""
