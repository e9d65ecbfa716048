"""What a process holds of the machine: memory, threads, files, sockets, children."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

PROC = Path("/proc")
MEGABYTE = 1e6


@dataclass(frozen=True)
class Footprint:
    """What a process holds.

    Attributes:
        memory: resident memory in [MB].
        threads: its threads.
        files: open file descriptors, sockets among them.
        sockets: open sockets.
        children: ids of its child processes.
    """

    memory: float
    threads: int
    files: int
    sockets: int
    children: frozenset[int]


def can_look() -> bool:
    """Say whether this system tells what a process holds: Linux alone does."""
    return (PROC / "self" / "statm").is_file()


def footprint(process: int) -> Footprint:
    """Return what a process holds now.

    Raises:
        OSError: if there is no such process.
    """
    folder = PROC / str(process)
    links = [_target(link) for link in (folder / "fd").iterdir()]
    return Footprint(
        memory=resident(process),
        threads=len(list((folder / "task").iterdir())),
        files=len(links),
        sockets=sum(link.startswith("socket:") for link in links),
        children=children(process),
    )


def resident(process: int) -> float:
    """Return the resident memory of a process in [MB], 0 if it has ended."""
    try:
        pages = int((PROC / str(process) / "statm").read_text().split()[1])
    except OSError:
        return 0.0
    return pages * os.sysconf("SC_PAGE_SIZE") / MEGABYTE


def children(process: int) -> frozenset[int]:
    """Return the ids of the processes that a process has started and that are still there."""
    found = set()
    for folder in PROC.iterdir():
        if folder.name.isdigit():
            try:
                # The name in brackets may hold blanks: what counts stands after it.
                parent = (folder / "stat").read_text().rpartition(")")[2].split()[1]
            except (OSError, IndexError):
                continue  # it ended meanwhile
            if int(parent) == process:
                found.add(int(folder.name))
    return frozenset(found)


def _target(link: Path) -> str:
    try:
        return os.readlink(link)
    except OSError:  # closed meanwhile
        return ""
