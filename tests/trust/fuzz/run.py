"""One part of the fuzzing in this process: inputs by number, each with its own dice."""

from __future__ import annotations

import resource
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from random import Random
from time import perf_counter
from types import FrameType

from tests.trust.fuzz.patch import judge_patch, patch_input
from tests.trust.fuzz.verdict import Fault, Tally, shown
from tests.trust.fuzz.yaml import judge_yaml, smaller, yaml_input

PATIENCE = 30
"""An input that takes longer than this in [s] hangs (*ours*)."""
MOST_MEMORY = 300.0
"""Growth of a process's greatest memory in [MB] from which on it is a fault (*ours*)."""
_THOROUGH = 6


class HangError(BaseException):
    """An input took longer than anybody waits."""


def _hang(_: int, __: FrameType | None) -> None:
    raise HangError


@contextmanager
def _deadline() -> Iterator[None]:
    signal.signal(signal.SIGALRM, _hang)
    signal.setitimer(signal.ITIMER_REAL, PATIENCE)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)


def greatest_memory() -> float:
    """Return the greatest memory that this process has had in [MB]."""
    size = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return size / (1e6 if sys.platform == "darwin" else 1e3)


def dice(seed: int, part: str, number: int) -> Random:
    """Return the source of chance of one input: same seed, same input, in any order."""
    return Random(f"{seed} {part} {number}")


def run_part(part: str, seed: int, start: int, stop: int) -> Tally:
    """Judge the inputs ``start`` to ``stop`` of ``yaml`` or ``patch``."""
    tally, before = Tally(), greatest_memory()
    for number in range(start, stop):
        random, begin = dice(seed, part, number), 0.0
        example: object = yaml_input(random) if part == "yaml" else patch_input(random)
        begin = perf_counter()
        try:
            with _deadline():
                accepted, complaint = _judged(example, number)
        except HangError:
            accepted, complaint = False, ("hangs", f"longer than {PATIENCE} s")
        tally.time(perf_counter() - begin, example)
        tally.note(accepted, complaint, example)
        if complaint is not None and isinstance(example, bytes):
            tally.faults[complaint[0]].merge(_smallest(example, complaint))
        if number == start:
            before = greatest_memory()  # what the first one loads isn't its fault
    tally.memory = greatest_memory() - before
    if tally.memory > MOST_MEMORY:
        text = f"{tally.memory:.0f} MB"
        tally.add(Fault("memory grows", text, f"inputs {start} to {stop} of {part}"))
    return tally


def _smallest(example: bytes, complaint: tuple[str, str]) -> Fault:
    short = smaller(example, complaint[0]) if len(example) < 8000 else example
    return Fault(*complaint, shown(short), 0)


def _judged(example: object, number: int) -> tuple[bool, tuple[str, str] | None]:
    if isinstance(example, bytes):
        return judge_yaml(example)
    return judge_patch(example, number % _THOROUGH == 0)
