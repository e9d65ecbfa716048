"""Worker processes: results, cancelling, and a killed one."""

from __future__ import annotations

import asyncio
import os
import signal
import time
from collections.abc import Callable, Iterator

import pytest

from slidetune.server.compute.workers import WorkerLostError, Workers


def double(value: int, cancelled: Callable[[], bool]) -> int:
    return 2 * value


def wait_until_cancelled(path: str, cancelled: Callable[[], bool]) -> None:
    while not cancelled():
        time.sleep(0.01)
    with open(path, "w") as file:
        file.write("cancelled")


def refuse(cancelled: Callable[[], bool]) -> None:
    raise ValueError("refused on purpose")


@pytest.fixture(scope="module")
def workers() -> Iterator[Workers]:
    workers = Workers(1)
    workers.start()
    yield workers
    workers.stop()


def test_a_task_returns_its_result(workers: Workers) -> None:
    assert asyncio.run(workers.run(double, 21)) == 42


def test_an_error_comes_back_as_itself(workers: Workers) -> None:
    with pytest.raises(ValueError, match="refused on purpose"):
        asyncio.run(workers.run(refuse))


def test_a_cancelled_task_stops_in_the_worker(workers: Workers, tmp_path: object) -> None:
    path = f"{tmp_path}/told"

    async def start_and_cancel() -> None:
        task = asyncio.ensure_future(workers.run(wait_until_cancelled, path))
        await asyncio.sleep(0.5)
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)

    asyncio.run(start_and_cancel())
    assert asyncio.run(workers.run(double, 1)) == 2
    end = time.monotonic() + 30.0
    while not os.path.exists(path):
        assert time.monotonic() < end, "the worker was not told"
        time.sleep(0.01)


def test_a_killed_worker_is_told_and_replaced(workers: Workers) -> None:
    async def kill() -> None:
        task = asyncio.ensure_future(workers.run(wait_until_cancelled, "/dev/null"))
        await asyncio.sleep(0.5)
        for process in workers.processes():
            os.kill(process, signal.SIGKILL)
        await task

    with pytest.raises(WorkerLostError, match="repeat the request"):
        asyncio.run(kill())
    assert asyncio.run(workers.run(double, 4)) == 8


def test_a_worker_that_was_killed_at_rest_costs_nothing(workers: Workers) -> None:
    async def kill_and_ask(value: int) -> int:
        await workers.run(double, 0)
        for process in workers.processes():
            os.kill(process, signal.SIGKILL)
        return await workers.run(double, value)

    # At once: the pool can't know yet.
    assert [asyncio.run(kill_and_ask(value)) for value in range(3)] == [0, 2, 4]


def test_one_who_asks_for_much_keeps_nobody_waiting_for_all_of_it(workers: Workers) -> None:
    done: list[str] = []

    async def ask(client: str) -> None:
        await workers.run(double, 1, client=client)
        done.append(client)

    async def all_at_once() -> None:
        await asyncio.gather(*(ask(client) for client in ["greedy"] * 12 + ["other"] * 2))

    asyncio.run(all_at_once())
    assert [place for place, client in enumerate(done) if client == "other"] == [2, 4]


def test_stop_leaves_no_process() -> None:
    workers = Workers(1)
    assert asyncio.run(workers.run(double, 1)) == 2
    (process,) = workers.processes()
    workers.stop()
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)
