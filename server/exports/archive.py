"""What is recorded as a file of plain arrays, to be handed to another process."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from slidetune.server.exports.recorded import Recorded, Said


def save_recorded(path: Path, recorded: Recorded) -> None:
    """Write it.

    Raises:
        OSError: if there is no room for it.
    """
    arrays = {"time": recorded.time}
    if recorded.revision is not None:
        arrays["revision"] = recorded.revision
    arrays |= {f"desired/{name}": values for name, values in recorded.desired.items()}
    for place, lane in enumerate(recorded.lanes.values()):
        arrays |= {f"{place}/{name}": values for name, values in lane.items()}
    rest = {
        "experiment": recorded.experiment,
        "yaml": recorded.yaml,
        "lanes": list(recorded.lanes),
        "edits": [asdict(said) for said in recorded.edits],
        "remarks": [asdict(said) for said in recorded.remarks],
    }
    with path.open("wb") as file:
        np.savez(file, allow_pickle=False, rest=np.array(json.dumps(rest)), **arrays)


def load_recorded(path: Path) -> Recorded:
    """Read what ``save_recorded`` wrote."""
    with np.load(path, allow_pickle=False) as file:
        rest = json.loads(str(file["rest"]))

        def under(folder: str) -> dict[str, np.ndarray]:
            names = [name for name in file.files if name.startswith(f"{folder}/")]
            return {name.removeprefix(f"{folder}/"): file[name] for name in names}

        return Recorded(
            experiment=rest["experiment"],
            yaml=rest["yaml"],
            time=file["time"],
            revision=file["revision"] if "revision" in file.files else None,
            desired=under("desired"),
            lanes={name: under(str(place)) for place, name in enumerate(rest["lanes"])},
            edits=tuple(Said(**said) for said in rest["edits"]),
            remarks=tuple(Said(**said) for said in rest["remarks"]),
        )
