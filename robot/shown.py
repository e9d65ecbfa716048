"""What shows itself where a notebook displays it; who draws it is not known here."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Bundle = dict[str, Any]
"""One thing in several forms, by MIME type."""
Draw = Callable[[Any], Bundle]

_drawn_by: list[Draw] = []


def draw_shown_by(draw: Draw) -> None:
    """Say who draws what is shown, in place of who did so before.

    Args:
        draw: returns the forms of what it is given.
    """
    _drawn_by[:] = [draw]


class Shown:
    """Has a picture of itself, in IPython's protocol that Jupyter, VS Code and others follow."""

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> Bundle:
        """Return its forms, none where nobody draws: its text is shown then.

        Args:
            include: MIME types that are asked for; whoever asks picks them out itself.
            exclude: MIME types that are not wanted; likewise.
        """
        return _drawn_by[0](self) if _drawn_by else {}
