"""The whole response of every lane at every slider move: computed in workers, latest wins."""

from __future__ import annotations

import asyncio
import json
from collections import OrderedDict
from typing import Any

import numpy as np

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.laws import own_versions
from slidetune.robot.loop.response import Response, lane_response, only_lane
from slidetune.server.compute.run_cost import refuse_if_costly
from slidetune.server.compute.workers import Workers

KEPT = 48
"""Responses that are kept, some 140 kB each (*ours*): a drag changes one lane, the others stay."""


def encode_responses(head: dict[str, Any], responses: dict[str, Response]) -> bytes:
    """Return responses as one message: length of the JSON, the JSON, then columns of float32.

    The JSON names the channels and, for each lane, how many points it has; the columns follow lane
    by lane: time first, then its channels, then x, y, z of the flange's path. What is not a number
    (after a lane left its bounds) stays NaN in the columns and nowhere else.

    Args:
        head: what else the JSON says.
        responses: what to send, by lane.
    """
    blocks: list[bytes] = []
    lanes = []
    channels: tuple[str, ...] = ()
    for name, response in responses.items():
        channels = response.channels
        lanes.append(
            {
                "name": name,
                "points": len(response.time),
                "path_points": len(response.path),
                "metrics": response.metrics,
                "frozen": response.frozen,
                "accuracy": response.accuracy,
                "goals": response.goals,
            }
        )
        table = np.vstack([response.time, response.columns])
        blocks += [table.astype("<f4").tobytes(), response.path.T.astype("<f4").tobytes()]
    text = json.dumps(
        {**head, "channels": list(channels), "lanes": lanes}, allow_nan=False, ensure_ascii=False
    ).encode()
    # Padded with blanks, so that the numbers stand where a Float32Array may begin.
    text += b" " * (-len(text) % 4)
    return len(text).to_bytes(4, "little") + text + b"".join(blocks)


class Previews:
    """Whole-horizon runs for the screen; a client's newer one cancels its older."""

    def __init__(self, workers: Workers) -> None:
        """Use ``workers``."""
        self._workers = workers
        self._running: dict[str, asyncio.Task[Any]] = {}
        self._known: OrderedDict[tuple[Any, bool], Response] = OrderedDict()

    async def respond(
        self, experiment: Experiment, estimate: bool, client: str, turn: str = ""
    ) -> dict[str, Response] | None:
        """Run every lane of an experiment over its horizon.

        Args:
            experiment: what to run.
            estimate: whether the error of each run is estimated, which takes half as long again.
            client: who asks; an empty text never supersedes anybody.
            turn: who asks, where others wait too; ``client`` where it is empty.

        Returns:
            The response of every lane, or ``None`` if the client asked for a newer one meanwhile.

        Raises:
            BusyError: if too many runs wait already.
            InvalidExperimentError: if the arm can't follow the trajectory, or if it would take the
                workers for too long.
        """
        refuse_if_costly(experiment)
        older = self._running.pop(client, None) if client else None
        if older is not None:
            older.cancel()
        work = self._all_lanes(experiment, estimate, client or turn)
        task = asyncio.ensure_future(work)
        if client:
            self._running[client] = task
        try:
            return await task
        except asyncio.CancelledError:
            if task.cancelled() and not _being_cancelled():
                return None
            task.cancel()
            raise
        finally:
            if self._running.get(client) is task:
                del self._running[client]

    async def _all_lanes(
        self, experiment: Experiment, estimate: bool, turn: str
    ) -> dict[str, Response]:
        tasks = [
            asyncio.ensure_future(self._lane(experiment, name, estimate, turn))
            for name in experiment.lanes
        ]
        try:
            responses = await asyncio.gather(*tasks)
        except BaseException:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            raise
        return dict(zip(experiment.lanes, responses, strict=True))

    async def _lane(self, experiment: Experiment, name: str, estimate: bool, turn: str) -> Response:
        """Run one lane; what didn't change since one of the last requests isn't run again."""
        alone = only_lane(experiment, name)
        text = alone.model_dump_json(exclude={"title", "description"})
        what = text, tuple(own_versions(alone.lanes).values())
        # An estimate is part of the answer: who asked for none may get one, but not the reverse.
        key = what, estimate or (what, True) in self._known
        known = self._known.get(key)
        if known is None:
            known = await self._workers.run(lane_response, alone, name, estimate, client=turn)
            self._known[key] = known
            while len(self._known) > KEPT:
                self._known.popitem(last=False)
        else:
            self._known.move_to_end(key)
        return known


def _being_cancelled() -> bool:
    """Tell whether it is this very request that is being cancelled, not just its older task."""
    current = asyncio.current_task()
    return current is not None and current.cancelling() > 0
