"""What large blocks leave behind, in a process of its own: the setting holds for all of it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
MEGABYTE = 2**20
BLOCKS = 20

SCRIPT = f"""
import os, sys
import numpy as np
from slidetune.server.hosting.allocator import map_large_blocks_apart

def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")

if "apart" in sys.argv and not map_large_blocks_apart():
    sys.exit("no such setting")
freed = np.ones({16 * MEGABYTE}, dtype=np.uint8)
del freed  # the size from which blocks are mapped apart would now be 16 MiB
before = resident()
large, small = [], []
for _ in range({BLOCKS}):
    large.append(np.ones({2 * MEGABYTE}, dtype=np.uint8))
    small.append(np.ones({MEGABYTE // 16}, dtype=np.uint8))
large.clear()
print(resident() - before)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="a setting of the GNU C library")
def test_large_blocks_go_back_to_the_system() -> None:
    command = [sys.executable, "-c", SCRIPT, "apart"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if "no such setting" in done.stderr:
        pytest.skip("this system has another C library")
    assert done.returncode == 0, done.stderr
    # Of 40 MiB that were freed; without the setting nearly all stay.
    assert int(done.stdout) < 5 * MEGABYTE
