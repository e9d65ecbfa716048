"""Lets the C library give large blocks back to the system as soon as they are free.

The GNU C library maps a large block apart, until the first such block is freed: from then on it
takes blocks of that size from its heaps, where whatever lies behind one keeps it from going back.
The rings of telemetry (17 MB for three lanes, anew with every change of lanes) had the server grow
by 1.5 MB a second while lanes came and went.
"""

from __future__ import annotations

import ctypes
import sys

LARGE = 1 << 20
"""Size from which a block is mapped apart in [byte] (*ours*): far above a frame of telemetry, so
that no tick pays for a mapping; below a ring of telemetry and a lane's record."""
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # published: malloc.h of the GNU C library


def map_large_blocks_apart() -> bool:
    """Fix the size from which blocks are mapped apart, once, at the start of a process.

    Returns:
        Whether the C library took it; those that have no such setting need none.
    """
    if sys.platform != "linux":
        return False
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError):
        return False
    # Fixing one stops the library from setting the other: twice as much, as it does itself.
    return bool(mallopt(_MMAP_THRESHOLD, LARGE)) and bool(mallopt(_TRIM_THRESHOLD, 2 * LARGE))
