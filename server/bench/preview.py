"""Whole responses during a drag: how often all lanes are redrawn, and what the session notices."""

from __future__ import annotations

from time import perf_counter

import httpx
import numpy as np

from slidetune.server.bench.result import Measurement, measurement

LANES = ("RBFNN-NFTSM", "RBFNN-SMC", "NFTSM")
ONE = "responses per second while a gain of one lane is dragged, 3 lanes × 10 s"
ALL = "responses per second while a gain of every lane is dragged"
POSITIONS = 20
STRIP = f"heat strip of one gain, {POSITIONS} positions of 10 s, complete"
FACTOR = "lowest real-time factor during the drag"


def _drag(client: httpx.Client, lanes: tuple[str, ...], seconds: float) -> tuple[float, float]:
    """Move sliders; return responses a second and the least real-time factor seen meanwhile."""
    factors, count, begin = [], 0, perf_counter()
    while (passed := perf_counter() - begin) < seconds:
        patch = {"lanes": {lane: {"k1": 120.0 + 0.1 * count} for lane in lanes}}
        client.patch("/api/experiment", json=patch).raise_for_status()
        wanted = {"estimate": False, "client": "bench"}
        client.post("/api/preview", json=wanted).raise_for_status()
        count += 1
        if passed > 1.0:
            factors.append(client.get("/api/session").json()["real_time_factor"])
    return count / passed, min(factors, default=float("nan"))


def _strip(client: httpx.Client) -> float:
    """Run a heat strip of one gain; return how long it took until it was complete in [s]."""
    begin = perf_counter()
    wanted = {"lane": LANES[0], "field": "c", "count": POSITIONS}
    rows = client.post("/api/studies/strip", json=wanted).raise_for_status().text.splitlines()
    if len(rows) != POSITIONS:
        raise ArithmeticError(f"a strip of {POSITIONS} positions has {len(rows)}")
    return perf_counter() - begin


def measure_drag(port: int, quick: bool) -> list[Measurement]:
    """Drag sliders of a running server, through the interface that the browser uses.

    Args:
        port: TCP port of the server on 127.0.0.1.
        quick: short, for a look instead of a verdict.
    """
    seconds = 1.5 if quick else 6.0
    with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=120.0) as client:
        client.post("/api/preview", json={"estimate": False}).raise_for_status()
        one, first = _drag(client, LANES[:1], seconds)
        every, second = _drag(client, LANES, seconds)
        strips = [_strip(client) for _ in range(1 if quick else 5)]
    least = float(np.nanmin([first, second, 10.0]))
    return [
        Measurement(ONE, "Hz", one, None, target=25.0, limit="at least"),
        Measurement(ALL, "Hz", every, None, target=25.0, limit="at least"),
        measurement(STRIP, "s", strips, target=0.5),
        Measurement(FACTOR, "", least, None, target=0.99, limit="at least"),
    ]
