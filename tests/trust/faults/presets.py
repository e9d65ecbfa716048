"""Faults while presets are saved: kill -9, a full disk, a folder that can't be written."""

from __future__ import annotations

import json
import multiprocessing
import random
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx

from tests.trust.faults.fault import Fault, Outcome, Promises
from tests.trust.faults.folder import FullFolder, closed_folder, full_folder
from tests.trust.faults.preset_saver import VICTIM, content, save_until_killed, store_in
from tests.trust.faults.server import Server, served

WINDOW = 0.12
"""A kill comes within so many seconds after a finished save (*ours*): a few saves."""


def _look(folder: Path, acknowledged: int, promises: Promises) -> int:
    """Check a folder after a kill; return the number of the save that the victim holds."""
    store = store_in(folder)
    for info in store.infos():
        if not info.shipped:
            promises.hold(not info.problem, f"{info.name} is listed with: {info.problem}")
            known = info.name == VICTIM or info.name.startswith("new-")
            promises.hold(known, f"a stray file is listed as {info.name}")
    saved = store.load(VICTIM)
    number = int(saved.title.removeprefix("Save "))
    whole = saved == content(number) and number in (acknowledged, acknowledged + 1)
    promises.hold(whole, "a preset was neither the old one nor the new one")
    return number


def _temporary(folder: Path) -> int:
    return sum(1 for path in folder.iterdir() if path.suffix == ".tmp")


def kill_saves(quick: bool) -> Outcome:
    """Kill a process that saves presets, many times, at random moments."""
    promises, dice, kills = Promises(), random.Random(1), 12 if quick else 200
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["tests.trust.preset_saver"])
    number, saves = 0, 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for kill in range(kills):
            done, told = context.Pipe(duplex=False)
            process = context.Process(
                target=save_until_killed, args=(folder, number + 1, told), daemon=True
            )
            process.start()
            told.close()
            first = last = done.recv()
            before = _temporary(folder)
            time.sleep(dice.uniform(0.0, WINDOW))
            if kill % 2:
                _wait_for_writing(folder, before)
            process.kill()
            process.join()
            last = _last(done, last)
            number = _look(folder, last, promises)
            saves += last - first + 1
            kept = [store_in(folder).load(f"new-{n}") == content(n) for n in range(first, last + 1)]
            promises.hold(all(kept), "a preset that was saved under a new name is gone")
            for path in folder.glob("new-*.yaml"):
                path.unlink()
        cut = _temporary(folder)
    measured = (
        f"{2 * saves} saves finished; {cut} kills came in the middle of writing and left a "
        "hidden file, which is never listed"
    )
    often = f"{kills} kills of a process that only saves, half at random, half while it writes"
    return promises.outcome(often, measured)


def _wait_for_writing(folder: Path, before: int) -> None:
    """Wait for the moment at which one more temporary file is there, but not for long."""
    end = time.monotonic() + 0.5
    while time.monotonic() < end and _temporary(folder) <= before:
        pass


def _last(done: Any, last: int) -> int:
    """Return the last number that a killed process told."""
    try:
        while True:
            last = done.recv()
    except EOFError:
        return last
    finally:
        done.close()


def kill_server(quick: bool) -> Outcome:
    """Kill the whole server while it saves presets that come over HTTP."""
    promises, dice, kills = Promises(), random.Random(2), 1 if quick else 5
    number, saves, cut = 0, 0, 0
    with tempfile.TemporaryDirectory() as name:
        for _ in range(kills):
            environment = {"SLIDETUNE_PRESETS": name, "SLIDETUNE_STUDIES": f"{name}/studies"}
            with served(environment=environment) as server:
                last = _put_until_killed(server, number + 1, dice.uniform(0.0, 2 * WINDOW))
            saves += last - number
            number = _look(Path(name), last, promises)
        cut = _temporary(Path(name))
    measured = f"{saves} saves answered; {cut} hidden files left, never listed"
    return promises.outcome(f"{kills} kills of the whole server", measured)


def _put_until_killed(server: Server, number: int, delay: float) -> int:
    """Kill a server ``delay`` seconds after its first save; return the last that it answered."""
    last, first = number - 1, threading.Event()

    def put() -> None:
        nonlocal last
        with server.http() as http:
            while True:
                document = content(last + 1).document()
                try:
                    answer = http.put(f"/api/presets/{VICTIM}?overwrite=true", json=document)
                except httpx.HTTPError:
                    first.set()
                    return
                if answer.status_code != 200:
                    first.set()
                    return
                last += 1
                first.set()

    thread = threading.Thread(target=put)
    thread.start()
    first.wait(60.0)
    time.sleep(delay)
    server.process.kill()
    server.process.wait()
    thread.join(60.0)
    return last


def _refused(answer: httpx.Response, promises: Promises, what: str) -> str:
    """Check that an answer is a clear refusal; return its message."""
    try:
        error = answer.json()["error"]
    except (ValueError, KeyError):
        promises.hold(False, f"{what}: {answer.status_code}, not in the shape of an error")
        return ""
    promises.hold(answer.status_code == 507, f"{what}: {answer.status_code} {error['code']}")
    promises.hold("nothing was changed" in error["message"], f"{what}: {error['message']}")
    return f"{answer.status_code} {error['code']}"


def _try_saves(
    server: Server, promises: Promises, block: Callable[[], None], free: Callable[[], None] | None
) -> str:
    """Save, then save where nothing can be written, then look, then try again if it was freed."""
    old, new = content(2), content(3)
    with server.http() as http:
        put = f"/api/presets/{VICTIM}?overwrite=true"
        promises.hold(http.put(put, json=old.document()).status_code == 200, "no first save")
        block()
        told = _refused(http.put(put, json=new.document()), promises, "overwriting")
        fresh = http.put("/api/presets/fresh", json=new.document())
        _refused(fresh, promises, "a new preset")
        listed = http.get("/api/presets").json()["presets"]
        own = [item["name"] for item in listed if not item["shipped"]]
        promises.hold(own == [VICTIM], f"presets after the fault: {', '.join(own)}")
        kept = http.get(f"/api/presets/{VICTIM}").json()["experiment"]
        promises.hold(kept == json.loads(json.dumps(old.document())), "the old preset is damaged")
        if free is not None:
            free()
            saved = http.put(put, json=new.document()).status_code == 200
            promises.hold(saved, "saving doesn't work again after the fault")
    promises.hold(not server.complaints, f"the server wrote: {server.complaints[:1]}")
    return told


def fill_disk(quick: bool) -> Outcome:
    """Save presets on a full disk."""
    promises = Promises()
    with full_folder() as disk, served(**_where(disk)) as server:
        told = _try_saves(server, promises, disk.fill, disk.free)
    again = "" if disk.free is None else "; saved again once there was room"
    return promises.outcome(f"once, {disk.how}", f"{told}; old preset intact{again}")


def _where(disk: FullFolder) -> dict[str, Any]:
    return {"environment": {"SLIDETUNE_PRESETS": str(disk.path)}, "prepare": disk.prepare}


def close_folder(quick: bool) -> Outcome:
    """Save presets in a folder that can only be read."""
    promises = Promises()
    with closed_folder() as disk, served(**_where(disk)) as server:
        told = _try_saves(server, promises, disk.fill, disk.free)
        with server.http() as http:
            promises.hold(http.delete(f"/api/presets/{VICTIM}").status_code == 204, "no delete")
    return promises.outcome(f"once, {disk.how}", f"{told}; old preset intact; writable again")


FAULTS = (
    Fault(
        "kill-saves",
        "kill -9 while presets are saved",
        "Old or new preset, whole; what was acknowledged is there; no stray file is listed",
        kill_saves,
    ),
    Fault(
        "kill-server",
        "kill -9 of the whole server while presets are saved over HTTP",
        "Old or new preset, whole; what was answered is there; no stray file is listed",
        kill_server,
    ),
    Fault(
        "disk-full",
        "The disk with the presets is full",
        "A clear error, 507; the old preset stays",
        fill_disk,
    ),
    Fault(
        "read-only",
        "The preset folder is read-only",
        "A clear error, 507; the old preset stays",
        close_folder,
    ),
)
