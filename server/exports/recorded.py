"""What an export is made of: the columns of a run, or of a stretch of the live session."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray
Columns = Mapping[str, Array]

GROUPS = (
    ("q", "rad"),
    ("v", "rad/s"),
    ("tau", "N·m"),
    ("S", "rad/s"),
    ("e", "rad"),
    ("de", "rad/s"),
    ("f", "N·m"),
    ("weights", "N·m"),
)
"""Name and unit of a lane's groups of columns, one a joint, where a joint turns."""


@dataclass(frozen=True)
class Said:
    """What was said or done at a time.

    Attributes:
        time: simulated time in [s].
        topic: ``edits``, or a lane's name for why it stood still.
        content: of an edit ``revision``, ``author`` and ``patch``; of a lane ``remark``.
    """

    time: float
    topic: str
    content: Mapping[str, Any]


@dataclass(frozen=True)
class Recorded:
    """Rows of all lanes.

    Attributes:
        experiment: the experiment at the first row, as plain values.
        yaml: the same as a preset.
        time: time in [s]. Shape (n,).
        revision: revision of the experiment at each row, of a live session. Shape (n,).
        desired: ``q_d`` in [rad], ``v_d`` in [rad/s], ``flange_d`` in [m]. Shapes (n, joints),
            (n, joints), (n, 3).
        lanes: by lane ``GROUPS``, shapes (n, joints), and ``flange`` in [m], shape (n, 3); NaN
            while a lane stood still.
        edits: the edits between the first row and the last, in order.
        remarks: why lanes stood still.
    """

    experiment: Mapping[str, Any]
    yaml: str
    time: Array
    revision: Array | None
    desired: Columns
    lanes: Mapping[str, Columns]
    edits: tuple[Said, ...] = ()
    remarks: tuple[Said, ...] = ()

    @property
    def arm(self) -> str:
        """Name of the arm."""
        return str(self.experiment["robot"]["model"])
