"""What holds for every test: no clock decides one, and none touches the user's own presets."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("slidetune", deadline=None, print_blob=True)
settings.load_profile("slidetune")


@pytest.fixture(autouse=True)
def user_presets(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Folder of the user's presets in this test; nothing is in it, and it needn't exist yet."""
    folder = tmp_path / "presets"
    monkeypatch.setenv("SLIDETUNE_PRESETS", str(folder))
    monkeypatch.setenv("SLIDETUNE_STUDIES", str(tmp_path / "studies"))
    monkeypatch.setenv("SLIDETUNE_ARMS", str(tmp_path / "arms"))
    return folder
