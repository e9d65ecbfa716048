"""Saves presets until it is killed: the least process that does what the server does for it."""

from __future__ import annotations

from multiprocessing.connection import Connection
from pathlib import Path

from slidetune.robot.experiment.document import MAX_LANES, Experiment
from slidetune.robot.experiment.presets import SHIPPED_FOLDER, PresetStore
from slidetune.robot.laws import LAWS

VICTIM = "victim"
"""Name of the preset that is overwritten again and again."""
_SMALL = Experiment()
_BIG = Experiment.from_document(
    {
        "description": "A long text. " * 300,
        "lanes": {f"Lane {i}": {"law": list(LAWS)[i % len(LAWS)]} for i in range(MAX_LANES)},
    }
)


def store_in(folder: Path) -> PresetStore:
    """Return the presets of a user whose folder is ``folder``."""
    return PresetStore(SHIPPED_FOLDER, folder)


def content(number: int) -> Experiment:
    """Return what the save of that number holds: by turns big and small."""
    return (_BIG if number % 2 else _SMALL).model_copy(update={"title": f"Save {number}"})


def save_until_killed(folder: Path, first: int, done: Connection) -> None:
    """Save one preset over and over, and each time a new one; tell each number that is done."""
    store, number = store_in(folder), first
    while True:
        store.save(VICTIM, content(number), overwrite=True)
        store.save(f"new-{number}", content(number))
        done.send(number)
        number += 1
