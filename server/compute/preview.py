"""The whole response of every lane at every slider move: computed in workers, latest wins."""

from __future__ import annotations

import asyncio
import json
from collections import OrderedDict
from typing import Any

import numpy as np

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.response import CHANNELS, Response, lane_response, only_lane, quickened
from slidetune.server.compute.run_cost import refuse_if_costly
from slidetune.server.compute.workers import Workers

KEPT = 48
"""Responses that are kept, 65 kB each (*ours*): a drag changes one lane, the others stay."""


def encode_responses(head: dict[str, Any], responses: dict[str, Response]) -> bytes:
    """Return responses as one message: length of the JSON, the JSON, then columns of float32.

    The JSON names the channels and, for each lane, how many points it has; the columns follow lane
    by lane: time first, then ``CHANNELS``, then x, y, z of the flange's path. What is not a number
    (after a lane left its bounds) stays NaN in the columns and nowhere else.

    Args:
        head: what else the JSON says.
        responses: what to send, by lane.
    """
    blocks: list[bytes] = []
    lanes = []
    for name, response in responses.items():
        lanes.append(
            {
                "name": name,
                "points": len(response.time),
                "path_points": len(response.path),
                "metrics": response.metrics,
                "frozen": response.frozen,
                "accuracy": response.accuracy,
            }
        )
        table = np.vstack([response.time, response.columns])
        blocks += [table.astype("<f4").tobytes(), response.path.T.astype("<f4").tobytes()]
    text = json.dumps(
        {**head, "channels": list(CHANNELS), "lanes": lanes}, allow_nan=False, ensure_ascii=False
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
        self._known: OrderedDict[tuple[str, bool], Response] = OrderedDict()
        self._ahead: asyncio.Task[Any] | None = None

    async def respond(
        self, experiment: Experiment, quick: bool, client: str, turn: str = ""
    ) -> dict[str, Response] | None:
        """Run every lane of an experiment over its horizon.

        Args:
            experiment: what to run.
            quick: whether the coarser step of a drag will do; its error is not estimated.
            client: who asks; an empty text never supersedes anybody.
            turn: who asks, where others wait too; ``client`` where it is empty.

        Returns:
            The response of every lane, or ``None`` if the client asked for a newer one meanwhile.

        Raises:
            WorkerLostError: if a worker process was killed.
            InvalidExperimentError: if the arm can't follow the trajectory, or if it would take the
                workers for too long.
        """
        chosen = quickened(experiment) if quick else experiment
        refuse_if_costly(chosen)
        if self._ahead is not None:
            self._ahead.cancel()
        older = self._running.pop(client, None) if client else None
        if older is not None:
            older.cancel()
        work = self._all_lanes(chosen, not quick, client or turn)
        task = asyncio.ensure_future(work)
        if client:
            self._running[client] = task
        try:
            responses = await task
            if client and not quick:
                self._look_ahead(experiment)
            return responses
        except asyncio.CancelledError:
            if task.cancelled() and not _being_cancelled():
                return None
            task.cancel()
            raise
        finally:
            if self._running.get(client) is task:
                del self._running[client]

    def _look_ahead(self, experiment: Experiment) -> None:
        """Run a drag's coarser steps before it begins: then it has to run what it changes alone."""
        ahead = self._all_lanes(quickened(experiment), estimate=False, turn="ahead")
        self._ahead = asyncio.ensure_future(ahead)
        # Nobody waits for it: what becomes of it is no news.
        self._ahead.add_done_callback(lambda task: task.cancelled() or task.exception())

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
        # An estimate is part of the answer: a drag's run without one is no exact answer.
        key = alone.model_dump_json(exclude={"title", "description"}), estimate
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
