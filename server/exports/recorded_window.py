"""The last seconds of the live session, to be exported, with every edit in them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.merge_patch import merged_values
from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from slidetune.server.exports.recorded import Columns, Recorded, Said
from slidetune.server.exports.refused import NoRowsError
from slidetune.server.live.telemetry import KeptRows
from slidetune.server.state.app_state import AppState
from slidetune.server.state.recent_edits import RecentEdit

Array = np.ndarray

LONGEST = 60.0
"""Most simulated time in [s] that is asked for (*ours*): more is not kept."""


def recorded_window(app_state: AppState, seconds: float) -> Recorded:
    """Return the newest rows of the live session.

    They go back as far as time ran forward with the same lanes and the same arm, and as the
    session keeps them: 60 s at 1 kHz.

    Args:
        app_state: whose session.
        seconds: simulated time in [s] that they cover at most.

    Raises:
        NoRowsError: if there are none.
    """
    session = app_state.session
    rows, states = session.telemetry.last(seconds), session.state()["lanes"]
    if not len(rows.time):
        raise NoRowsError("the session has made no step yet: let it play, then export")
    # An edit that is being made is waited for: rows may have been made under it already.
    app_state.document.present()
    oldest, document, edits = app_state.recent_edits.since(int(rows.revision[0]))
    first = int(np.searchsorted(rows.revision, oldest))  # revisions only rise
    if first == len(rows.time):
        raise NoRowsError(
            "no step has been made with this experiment yet: let it play, then export"
        )
    # What is known may begin with edits under which no row was made.
    begun = int(rows.revision[first])
    for edit in edits:
        if edit.revision <= begun:
            document = merged_values(document, edit.patch)
    edits = [edit for edit in edits if edit.revision > begun]
    experiment = Experiment.from_document(document)
    return Recorded(
        experiment=experiment.document(),
        yaml=experiment_to_yaml(experiment),
        time=rows.time[first:],
        revision=rows.revision[first:],
        desired=_columns(rows, first),
        lanes=_lanes(rows, first),
        edits=tuple(_within(edits, rows)),
        remarks=tuple(_remarks(rows, first, states)),
    )


def _remarks(rows: KeptRows, first: int, states: Mapping[str, Any]) -> Iterator[Said]:
    """Yield where lanes came to stand still, and why as far as it is still known.

    Of one that stood still before the first row it is said there.
    """
    for place, name in enumerate(_names(rows)):
        state = states.get(name, {"status": ""})  # it may be gone by now
        still = (rows.frozen[first:] >> place & 1).astype(int)
        ends = [0] * bool(still[0]) + (np.flatnonzero(np.diff(still) > 0)).tolist()
        for row in ends:
            time = float(rows.time[first + row])
            last = state["status"] == "frozen" and not still[row + 1 :].min(initial=1) < 1
            cause = state["cause"] if last else "It left its bounds, and has been reset since."
            yield Said(time, name, {"remark": cause})


def _names(rows: KeptRows) -> list[str]:
    """Return the lanes of rows, in order."""
    return list(dict.fromkeys(column.lane for column in rows.columns if column.lane))


def _within(edits: Sequence[RecentEdit], rows: KeptRows) -> list[Said]:
    """Return the edits that rows were made under, at the time of the first such row."""
    places = np.searchsorted(rows.revision, [edit.revision for edit in edits])
    return [
        Said(float(rows.time[place]), "edits", _content(edit))
        for place, edit in zip(places.tolist(), edits, strict=True)
        if place < len(rows.time)
    ]


def _content(edit: RecentEdit) -> Mapping[str, Any]:
    return {"revision": edit.revision, "author": edit.author, "patch": edit.patch}


def _lanes(rows: KeptRows, first: int) -> dict[str, Columns]:
    """Return each lane's columns; what it held while it stood still is no curve."""
    desired = _columns(rows, first)
    lanes: dict[str, Columns] = {}
    for place, name in enumerate(_names(rows)):
        columns = _columns(rows, first, name)
        columns["q"], columns["v"] = desired["q_d"] - columns["e"], desired["v_d"] - columns["de"]
        still = (rows.frozen[first:] >> place & 1).astype(bool)
        for values in columns.values():
            values[still] = np.nan
        lanes[name] = columns
    return lanes


def _columns(rows: KeptRows, first: int, lane: str = "") -> dict[str, Array]:
    """Return a lane's columns by group, or what all lanes share."""
    groups: dict[str, list[int]] = {}
    for place, column in enumerate(rows.columns):
        if column.lane == lane:
            groups.setdefault(column.group, []).append(place)
    return {name: rows.values[first:, places].astype(float) for name, places in groups.items()}
