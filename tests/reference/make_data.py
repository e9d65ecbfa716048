"""Solves the experiments of the reference: ``python -m tests.reference.make_data``.

What is stored and would be drawn the same again is kept; ``--all`` solves that anew as well.
"""

from __future__ import annotations

import sys
from concurrent.futures import ProcessPoolExecutor

import numpy as np
from rich.progress import track

from tests.reference.data import PATH, TIME, Case, read, write
from tests.reference.draw import DRAWS
from tests.reference.solve import STEPS, GaveUpError, solve

EACH = {"hand": 100, "wide": 100, "world": 60}
"""Experiments of each origin."""
ATTEMPTS = ((1e-9, 1e-11, STEPS), (1e-7, 1e-9, 10 * STEPS))
"""Relative tolerances of the two solutions, of which the finer one is kept, and steps of each; the
second attempt is for what the first gives up."""


def solved(task: tuple[str, int]) -> Case:
    """Draw and solve one experiment, twice."""
    origin, seed = task
    document = DRAWS[origin](seed)
    for rough, fine, steps in ATTEMPTS:
        try:
            one = solve(document, TIME, rough, thin=1e-6, most=steps)
            other = solve(document, TIME, fine, thin=1e-7, most=steps)
        except GaveUpError:
            continue
        both = np.isfinite(one.q) & np.isfinite(other.q)
        apart = float(np.abs(one.q - other.q)[both].max())
        if abs(one.end - other.end) > 1e-3:
            apart = np.inf
        return Case(origin, seed, document, other.q, apart, other.end)
    return Case(origin, seed, document, np.full((len(TIME), 6), np.nan), np.inf, 0.0)


def main() -> None:
    """Solve what is asked for and keep all."""
    known = {} if "--all" in sys.argv[1:] else {case[:2]: case for case in read()}
    tasks = [(origin, seed) for origin, count in EACH.items() for seed in range(count)]
    missing = [
        (origin, seed)
        for origin, seed in tasks
        if (origin, seed) not in known or known[origin, seed].document != DRAWS[origin](seed)
    ]
    with ProcessPoolExecutor() as pool:
        solving = track(pool.map(solved, missing), total=len(missing), description="Solving")
        known.update(zip(missing, solving, strict=True))
    cases = [known[task] for task in tasks]
    write(cases)
    clear = [case for case in cases if case.agreement < 1e-5]
    print(f"{len(cases)} cases, {len(clear)} determined, {PATH.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
