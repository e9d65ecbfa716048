"""Worker threads: results, stopping, and turns."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import CancelledError, simulate
from slidetune.server.compute.workers import MOST, BusyError, Workers

Array = np.ndarray
PATIENCE = 60.0


def double(value: int, stop: Array) -> int:
    return 2 * value


def wait_until_stopped(begun: threading.Event, told: threading.Event, stop: Array) -> None:
    begun.set()
    while not stop[0]:
        time.sleep(0.01)
    told.set()


def refuse(stop: Array) -> None:
    raise ValueError("refused on purpose")


def long_run(begun: threading.Event, ended: list[str], stop: Array) -> None:
    """Make a run of some ten seconds that goes well, and note how it ended."""
    document = {
        "robot": {"armature": 5.0},
        "lanes": {"A": {"law": "smc", "k1": 5.0, "k2": 1.0}},
        "simulation": {"mode": "sampled", "horizon": 120.0, "plant_substeps": 200},
    }
    experiment = Experiment.from_document(document)
    begun.set()
    try:
        simulate(experiment, stop=stop, estimate=False)
    except CancelledError:
        ended.append("stopped")
        raise
    ended.append("complete")


@pytest.fixture
def workers() -> Iterator[Workers]:
    workers = Workers(1)
    workers.start()
    yield workers
    workers.stop()


async def cancelled_once_begun(work: asyncio.Task[None], begun: threading.Event) -> None:
    assert await asyncio.to_thread(begun.wait, PATIENCE)
    work.cancel()
    await asyncio.gather(work, return_exceptions=True)


def test_a_task_returns_its_result(workers: Workers) -> None:
    assert asyncio.run(workers.run(double, 21)) == 42


def test_an_error_comes_back_as_itself(workers: Workers) -> None:
    with pytest.raises(ValueError, match="refused on purpose"):
        asyncio.run(workers.run(refuse))


def test_a_cancelled_task_is_told_in_its_thread(workers: Workers) -> None:
    begun, told = threading.Event(), threading.Event()

    async def start_and_cancel() -> None:
        work = asyncio.ensure_future(workers.run(wait_until_stopped, begun, told))
        await cancelled_once_begun(work, begun)

    asyncio.run(start_and_cancel())
    assert told.wait(PATIENCE)
    assert asyncio.run(workers.run(double, 1)) == 2


def test_a_whole_run_ends_early_when_it_is_cancelled(workers: Workers) -> None:
    begun, ended = threading.Event(), list[str]()

    async def start_and_cancel() -> None:
        work = asyncio.ensure_future(workers.run(long_run, begun, ended))
        await cancelled_once_begun(work, begun)

    asyncio.run(start_and_cancel())
    # The only thread is free again.
    assert asyncio.run(workers.run(double, 2)) == 4
    assert ended == ["stopped"]


def test_others_go_on_while_a_whole_run_is_made(workers: Workers) -> None:
    begun, ended = threading.Event(), list[str]()

    async def count() -> int:
        work = asyncio.ensure_future(workers.run(long_run, begun, ended))
        assert await asyncio.to_thread(begun.wait, PATIENCE)
        turns = 0
        # It isn't over when this loop has been given the interpreter so often.
        while turns < 100 and not ended:
            await asyncio.sleep(0.0)
            turns += 1
        work.cancel()
        await asyncio.gather(work, return_exceptions=True)
        return turns

    assert asyncio.run(count()) == 100


def test_one_who_asks_for_much_keeps_nobody_waiting_for_all_of_it(workers: Workers) -> None:
    done: list[str] = []

    async def ask(client: str) -> None:
        await workers.run(double, 1, client=client)
        done.append(client)

    async def all_at_once() -> None:
        await asyncio.gather(*(ask(client) for client in ["greedy"] * 12 + ["other"] * 2))

    asyncio.run(all_at_once())
    assert [place for place, client in enumerate(done) if client == "other"] == [2, 4]


def test_more_than_can_wait_are_refused_and_the_others_are_served(workers: Workers) -> None:
    async def ask_for_too_much() -> list[int | BaseException]:
        asked = [workers.run(double, number) for number in range(MOST + 1)]
        return await asyncio.gather(*asked, return_exceptions=True)

    answers = asyncio.run(ask_for_too_much())
    assert answers[:MOST] == [2 * number for number in range(MOST)]
    assert isinstance(answers[-1], BusyError)


def test_stop_ends_what_runs_and_leaves_no_thread() -> None:
    workers = Workers(1)
    begun, told = threading.Event(), threading.Event()

    async def stop_once_begun() -> None:
        work = asyncio.ensure_future(workers.run(wait_until_stopped, begun, told))
        assert await asyncio.to_thread(begun.wait, PATIENCE)
        workers.stop()
        await work

    before = threading.active_count()
    asyncio.run(stop_once_begun())
    assert told.is_set()
    assert threading.active_count() <= before
