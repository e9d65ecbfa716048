"""Memory of the records of whole runs, used again: fresh pages cost more than their numbers.

A record of ten seconds has 3.8 MB, which the system gives anew, page by page, for every run; on a
machine of ours that was a tenth of the run.
"""

from __future__ import annotations

import weakref
from math import prod

import numpy as np

from slidetune.robot.kernels.workspace import RECORD

Array = np.ndarray

KEPT = 6
"""Blocks that are kept for the next run (*ours*): those that are filled at the same time."""
LARGEST = 1 << 23
"""Size up to which a block is kept in [byte] (*ours*): some 20 s in steps of 1 ms."""

_spare: list[Array] = []


class _Rows:
    """The beginning of a block: when the last view of it is gone, the block is spare again."""

    def __init__(self, block: Array, shape: tuple[int, ...]) -> None:
        self.__array_interface__ = block[: prod(shape)].reshape(shape).__array_interface__
        weakref.finalize(self, _give_back, block).atexit = False


def _give_back(block: Array) -> None:
    if block.nbytes <= LARGEST and len(_spare) < KEPT:
        _spare.append(block)


def record_of(rows: int, joints: int) -> Array:
    """Return a record of so many rows, whose numbers are whatever was there.

    Returns:
        Shape (rows, 8, joints).
    """
    try:
        block = _spare.pop()
    except IndexError:
        block = None
    shape = rows, len(RECORD), joints
    if block is None or len(block) < prod(shape):
        block = np.empty(prod(shape))
    return np.asarray(_Rows(block, shape))
