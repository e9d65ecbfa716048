"""Where runs are made by a cluster: reached, compared with this process, and warm, or refused."""

from __future__ import annotations

import asyncio
import logging
import re
import time
from collections.abc import Callable, Collection, Iterator
from concurrent.futures import Executor, wait
from contextlib import contextmanager
from typing import Any

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.kernels.compiler import is_warm
from slidetune.robot.loop.warmup import warm_up
from slidetune.server.compute.cluster_executor import POLL, ClusterExecutor
from slidetune.server.compute.cluster_state import Tell

CONNECT = 5.0
"""Time for a scheduler to answer, and for a first worker to be there, in [s] (*ours*)."""
QUIET = 5.0
"""Time after which it is told which workers are waited for in [s] (*ours*)."""

_ADDRESS = re.compile(r"((?:tcp|tls)://)?(?:\[[0-9a-fA-F:.]+\]|[\w.-]+):(\d{1,5})")
_LOGGERS = ("distributed", "distributed.client", "tornado.application")


@contextmanager
def cluster_executor(address: str, tell: Tell) -> Iterator[Executor]:
    """Run tasks on a cluster.

    Tasks are functions of modules, their arguments experiments and plain JSON values: equal ones
    are one task to the cluster. Results are fetched and forgotten there at once. Where the cluster
    is lost, every task under way and every later one raises ``ClusterError``.

    Args:
        address: of Dask's scheduler, such as ``tcp://10.0.0.1:8786``.
        tell: called with a sentence, from any thread, whenever something is worth knowing.

    Raises:
        InvalidExperimentError: naming the field ``scheduler``: if Dask isn't installed, no
            scheduler answers there, it has no worker, or a worker has another build than this
            process.
        ClusterError: if the cluster is lost while it is looked at.
    """
    client = _connected(_whole_address(address))
    try:
        with ClusterExecutor(client, tell) as executor:
            _check(executor, _workers(executor, client.scheduler.address), tell)
            yield executor
    finally:
        client.close(timeout=CONNECT)


def _refused(*texts: str) -> InvalidExperimentError:
    return InvalidExperimentError([FieldError("scheduler", text) for text in texts])


def _whole_address(address: str) -> str:
    found = _ADDRESS.fullmatch(address)
    if not found or int(found[2]) > 65535:
        raise _refused(f"must be HOST:PORT, after tcp:// (the default) or tls://, got {address}")
    return address if found[1] else f"tcp://{address}"


def _connected(address: str) -> Any:
    """Return a client of the scheduler at an address."""
    try:
        from distributed import Client, Security, rpc
    except ImportError as error:
        text = "a cluster needs Dask, which isn't here: pip install 'slidetune[cluster]'"
        raise _refused(text) from error
    for name in _LOGGERS:  # what goes wrong is told by us
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)

    async def identity() -> Any:
        # Whoever listens there and says nothing: Dask itself would wait for ever.
        security = Security().get_connection_args("client")
        async with rpc(address, connection_args=security) as scheduler:
            return await asyncio.wait_for(scheduler.identity(), CONNECT)

    try:
        kind = asyncio.run(identity())["type"]
        if kind != "Scheduler":
            raise _refused(f"at {address} there is Dask's {kind.lower()}, not its scheduler")
        return Client(address, timeout=CONNECT, set_as_default=False)
    except (OSError, TimeoutError) as error:
        text = f"no scheduler of Dask answers at {address} within {CONNECT:g} s"
        raise _refused(text) from error
    except InvalidExperimentError:
        raise
    except Exception as error:  # whatever can come of what isn't Dask, or of another Dask
        raise _refused(f"what is at {address} can't be spoken to: {error}") from error


def _workers(executor: ClusterExecutor, address: str) -> frozenset[str]:
    """Return the addresses of all workers, of which there must be one."""
    end = time.monotonic() + CONNECT
    while not (found := executor.workers):
        if time.monotonic() > end:
            raise _refused(f"the scheduler at {address} has no worker: dask worker {address}")
        time.sleep(POLL)
    return found


def _check(executor: ClusterExecutor, workers: Collection[str], tell: Tell) -> None:
    """Refuse workers of another build by name; have the others compile what they run."""
    warm = _from_each(executor, workers, is_warm, tell)
    if not all(warm):
        tell("Compiling the control laws on the workers (once a version, about half a minute) …")
        _from_each(executor, workers, warm_up, tell)


def _from_each(
    executor: ClusterExecutor, workers: Collection[str], function: Callable[[], Any], tell: Tell
) -> list[Any]:
    """Return what a function returns on each worker, or refuse those where it doesn't."""
    asked = {executor.submit_to(worker, function): worker for worker in workers}
    begun, told = time.monotonic(), False
    # Whoever is suspended the scheduler counts as lost after some minutes.
    while waiting := [one for one in wait(asked, POLL).not_done if asked[one] in executor.workers]:
        if not told and time.monotonic() - begun > QUIET:
            told = True
            tell(f"Waiting for {', '.join(sorted(asked[one] for one in waiting))} …")
    refused = [
        str(one.exception()) if one.done() else f"worker {worker} is lost"
        for one, worker in asked.items()
        if not one.done() or one.exception()
    ]
    if refused:
        for one in asked:
            one.cancel()
        raise _refused(*refused)
    return [one.result() for one in asked]
