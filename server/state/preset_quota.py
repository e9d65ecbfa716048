"""How many presets of the user's own there may be."""

from __future__ import annotations

from threading import Lock

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import PresetStore
from slidetune.server.guard.limits import MAX_PRESETS, TooManyPresetsError

_turn = Lock()


def save_within_quota(
    store: PresetStore, name: str, experiment: Experiment, overwrite: bool = False
) -> None:
    """Save a preset where there is room; an existing one can always be overwritten.

    Args:
        store: where to save it.
        name: its name.
        experiment: what to save.
        overwrite: whether it may take the place of another of the user's.

    Raises:
        TooManyPresetsError: if the folder is full.
        SlidetuneError: whatever ``store.save`` raises.
    """
    # One after the other: of many at once each would find the room that is left for one.
    with _turn:
        names = {path.stem for path in store.user.glob("*.yaml")}
        if name not in names and len(names) >= MAX_PRESETS:
            text = (
                f"you have {len(names)} presets of your own, {MAX_PRESETS} are allowed: delete one"
            )
            raise TooManyPresetsError(text)
        store.save(name, experiment, overwrite)
