"""What the owner last asked for of the live experiment, kept for those who watch.

One response of all lanes, and one look at each lane through each lens: computed once, replaced by
the next, and written as JSON when the first of those who watch asks for it. The event loop alone
touches it.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.lenses import LENSES


class LastResults:
    """The last response and the last looks."""

    def __init__(self) -> None:
        """Start without any."""
        self._response: tuple[int, bytes] | None = None
        self._looks: dict[tuple[str, str], tuple[int, dict[str, Any] | bytes]] = {}
        self._counts = {"response": 0, "lens": 0}

    def counts(self) -> dict[str, int]:
        """Return how many of each kind were kept so far: another number says that there is news."""
        return dict(self._counts)

    @property
    def response(self) -> bytes | None:
        """The last whole response as ``server.compute.preview.encode_responses`` wrote it."""
        return None if self._response is None else self._response[1]

    def look(self, lane: str, lens: str) -> bytes | None:
        """Return the last look at a lane through a lens as JSON, or ``None``."""
        revision, kept = self._looks.get((lane, lens), (0, None))
        if isinstance(kept, dict):
            kept = json.dumps(kept, allow_nan=False, ensure_ascii=False).encode()
            self._looks[lane, lens] = revision, kept
        return kept

    def keep_response(self, revision: int, message: bytes) -> None:
        """Keep a response of the experiment of ``revision``, unless there is a newer one."""
        if self._response is None or revision >= self._response[0]:
            self._response = revision, message
            self._counts["response"] += 1

    def keep_looks(
        self, revision: int, experiment: Experiment, lane: str, seen: Mapping[str, Any]
    ) -> None:
        """Keep what was seen of a lane, each lens by itself, unless there is something newer.

        Args:
            revision: of the experiment.
            experiment: all of it; looks at lanes that it hasn't got are forgotten.
            lane: which was looked at.
            seen: what ``robot.lenses.look_through`` returned.
        """
        self._forget_all_but(experiment.lanes)
        rest = {name: value for name, value in seen.items() if name not in LENSES}
        head = {"revision": revision, "lane": lane, "experiment": experiment.document(), **rest}
        for lens in LENSES.keys() & seen.keys():
            kept = self._looks.get((lane, lens))
            if kept is not None and kept[0] > revision:
                continue
            self._looks[lane, lens] = revision, {**head, lens: seen[lens]}
            self._counts["lens"] += 1

    def _forget_all_but(self, lanes: Iterable[str]) -> None:
        known = set(lanes)
        self._looks = {key: kept for key, kept in self._looks.items() if key[0] in known}
