"""Solves the experiments of the reference anew: ``python -m tests.reference.make_data``."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor

import numpy as np
from rich.progress import track

from tests.reference.data import PATH, TIME, Case, write
from tests.reference.draw import by_hand, widely
from tests.reference.solve import GaveUpError, solve

EACH = 100
"""Experiments of each origin."""
ROUGH, FINE = 1e-9, 1e-11
"""Relative tolerances of the two solutions; the finer one is kept."""


def solved(task: tuple[str, int]) -> Case:
    """Draw and solve one experiment, twice."""
    origin, seed = task
    document = by_hand(seed) if origin == "hand" else widely(seed)
    nothing = np.full((len(TIME), 6), np.nan)
    try:
        rough = solve(document, TIME, ROUGH, thin=1e-6)
        fine = solve(document, TIME, FINE, thin=1e-7)
    except GaveUpError:
        return Case(origin, seed, document, nothing, np.inf, 0.0)
    both = np.isfinite(rough.q) & np.isfinite(fine.q)
    apart = float(np.abs(rough.q - fine.q)[both].max())
    if abs(rough.end - fine.end) > 1e-3:
        apart = np.inf
    return Case(origin, seed, document, fine.q, apart, fine.end)


def main() -> None:
    """Solve all and keep them."""
    tasks = [(origin, seed) for origin in ("hand", "wide") for seed in range(EACH)]
    with ProcessPoolExecutor() as pool:
        cases = list(track(pool.map(solved, tasks), total=len(tasks), description="Solving"))
    write(cases)
    clear = [case for case in cases if case.agreement < 1e-5]
    print(f"{len(cases)} cases, {len(clear)} determined, {PATH.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
