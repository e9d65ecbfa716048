"""Two arms to learn with, of one joint and of two; their figures are *ours*.

Both swing in the vertical plane x-z of the base, by uniform rods: at zero they hang.
"""

from pathlib import Path

PENDULUM = Path(__file__).with_name("pendulum.urdf")
"""A rod of 0.5 m and 1 kg."""

TWO_LINKS = Path(__file__).with_name("two_links.urdf")
"""Rods of 0.4 m, 1.5 kg and 1 kg."""
