"""How many presets of the user's own there may be."""

from __future__ import annotations

from robot.presets import PresetStore
from server.limits import MAX_PRESETS, TooManyPresetsError


def refuse_if_full(store: PresetStore, name: str) -> None:
    """Refuse one preset more than there may be; an existing one can always be overwritten.

    Args:
        store: where it is to be saved.
        name: its name.

    Raises:
        TooManyPresetsError: if the folder is full.
    """
    names = {path.stem for path in store.user.glob("*.yaml")}
    if name not in names and len(names) >= MAX_PRESETS:
        text = f"there are {len(names)} presets of yours, {MAX_PRESETS} are allowed: delete one"
        raise TooManyPresetsError(text)
