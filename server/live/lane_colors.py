"""One colour a lane, kept while the lane lives."""

from __future__ import annotations

PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Colours that colour-blind eyes tell apart (*published*: Okabe and Ito 2008)."""


class LaneColors:
    """Hands each lane the first colour that no other lane has."""

    def __init__(self) -> None:
        """Start with all colours free."""
        self._index: dict[str, int] = {}

    def assign(self, lanes: list[str]) -> None:
        """Keep the colours of lanes that stay; one that takes the place of another takes its own.

        Args:
            lanes: names of all lanes now, in order.
        """
        before = list(self._index)
        gone = [name for name in before if name not in lanes]
        new = [name for name in lanes if name not in self._index]
        if len(gone) == 1 and len(new) == 1:
            self._index[new[0]] = self._index[gone[0]]
        kept = {name: self._index[name] for name in lanes if name in self._index}
        for name in lanes:
            if name not in kept:
                free = (i for i in range(len(PALETTE)) if i not in kept.values())
                kept[name] = next(free, 0)
        self._index = {name: kept[name] for name in lanes}

    def of(self, lane: str) -> str:
        """Return a lane's colour as ``#rrggbb``."""
        return PALETTE[self._index.get(lane, 0)]

    def document(self) -> list[dict[str, str]]:
        """Return name and colour of every lane, in order."""
        return [{"name": name, "color": self.of(name)} for name in tuple(self._index)]
