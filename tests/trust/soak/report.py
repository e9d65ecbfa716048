"""What a long day showed, as text."""

from __future__ import annotations

from collections.abc import Callable

from tests.trust.report import table
from tests.trust.soak.census import POOLED, Census, left_behind
from tests.trust.soak.day import Day
from tests.trust.soak.growth import Growth, growth
from tests.trust.soak.verdict import Verdict

MEMORY = 5.0
"""Most that the resident memory may grow after the warm-up in [MB] (*ours*)."""
JUDGED = 240.0
"""Length of a soak in [s] from which on its growth is judged (*ours*): a shorter one has too few
counts after the warm-up to tell growth from the allocator's breath, and only tells it."""
SHOWN = 10
"""Failures that are written out (*ours*)."""

_DEFINITION = (
    "Visitors come and go continuously: two edit, others reconnect (closing cleanly, dropping the "
    "connection, or never reading), watch the 3D scene through the relay and pull the arm, browse, "
    "request previews, look back, branch, undo, load and save presets, cancel studies. Before it "
    "starts, everything bounded (edits to undo, previews, lanes, thread pools) is filled. At "
    "intervals everybody leaves, the first preset is loaded, and what remains is counted; growth "
    "is the median of the last third of these counts after the warm-up minus that of the first "
    "third. *At most* is the peak at any time."
)


def judge(day: Day, orphans: int) -> Verdict:
    """Return what a day showed.

    Args:
        day: what was counted.
        orphans: processes that were still there after the server had ended.
    """
    first, last = day.counts[0], day.counts[-1]
    broken = list(day.world.failures[:SHOWN])
    if len(day.world.failures) > SHOWN:
        broken.append(f"and {len(day.world.failures) - SHOWN} failures more")
    broken += [f"left behind: {text}" for text in left_behind(first.held, last.held)]
    if last.nodes > first.nodes:
        broken.append(f"left behind: {last.nodes} scene nodes instead of {first.nodes}")
    if orphans:
        broken.append(f"{orphans} processes outlived the server")
    grown = _grown(day)
    growing = [
        f"memory of {name} grew by {one.step:.1f} MB: at most {MEMORY:g} MB is promised"
        for name, one in grown.items()
        if one.step >= MEMORY
    ]
    body = _body(day, grown, orphans)
    if day.seconds < JUDGED:
        return Verdict(body, tuple(broken), tuple(growing))
    return Verdict(body, (*broken, *growing))


def _body(day: Day, grown: dict[str, Growth], orphans: int) -> str:
    first, last, most = day.counts[0], day.counts[-1], day.most

    def row(name: str, figure: Callable[[Census], float], top: float | None) -> list[str]:
        high = "–" if top is None else f"{top:.0f}"
        return [name, f"{figure(first):.0f}", f"{figure(last):.0f}", high]

    rows = [
        row("resident memory [MB]", lambda c: c.held.memory, most.memory),
        row("threads", lambda c: c.held.threads, most.threads),
        row("open files", lambda c: c.held.files, most.files),
        row("sockets", lambda c: c.held.sockets, most.sockets),
        row("child processes", lambda c: len(c.held.children), None),
        row("nodes of the 3D scene", lambda c: c.nodes, None),
        row("messages that a new viewer of the scene gets", lambda c: c.messages, None),
        row("time until it has them all [ms]", lambda c: 1e3 * c.welcome, None),
    ]
    headings = ["held by the server", "before", "after", "at most"]
    parts = [
        f"{day.seconds / 60:.1f} minutes. {_DEFINITION}",
        table(headings, rows),
        _growth_text(grown, len(day.warm)),
        f"Processes that outlived the server: {orphans} (promise: 0). Failures, that is "
        f"responses of 500 and above, or no response: {len(day.world.failures)} (promise: 0).",
        table(["done", "times"], [[what, str(n)] for what, n in sorted(day.world.done.items())]),
    ]
    return "\n\n".join(parts)


def _grown(day: Day) -> dict[str, Growth]:
    """Return how the memory of the server grew; nothing after a short day."""
    if len(day.warm) < 3:
        return {}
    times = [count.time for count in day.warm]
    return {"the server": growth(times, [count.held.memory for count in day.warm])}


def _growth_text(grown: dict[str, Growth], counts: int) -> str:
    if not grown:
        return f"Too short to tell growth: {counts} counts after the warm-up."
    rows = [
        [name, f"{g.before:.1f}", f"{g.after:.1f}", f"{g.step:+.1f}", f"{60 * g.slope:+.2f}"]
        for name, g in grown.items()
    ]
    headings = ["memory", "first third", "last third", "growth [MB]", "slope [MB/min]"]
    return (
        f"{table(headings, rows)}\n\nFrom {counts} counts after the warm-up (promise: growth below "
        f"{MEMORY:g} MB; the slope is the median of those between all pairs of counts). Promise "
        "for everything else in the table above: no more after than before, except for the threads "
        f"that a pool of {POOLED} keeps once it has needed them."
    )
