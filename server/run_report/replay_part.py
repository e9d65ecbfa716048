"""The replay in 3D as HTML: where it goes, what it shows, and Viser's page with the recording."""

from __future__ import annotations

import json
from base64 import b64encode
from html import escape
from pathlib import Path

import viser

from slidetune.robot.loop.simulate import Run
from slidetune.server.report.figure_page import html_paragraphs, in_script
from slidetune.server.run_report.recording import MOST_PICTURES, RATE, Film

_CLIENT = Path(viser.__file__).parent / "client" / "build" / "index.html"


def replay_part(run: Run, film: Film, missing: str) -> str:
    """Return the place of the replay, and what is to be seen in it.

    Args:
        run: the run.
        film: what was recorded.
        missing: why there is no recording, or an empty text.
    """
    if missing:
        return html_paragraphs([f"There is no replay: {missing}"])
    first, *others = run.lanes
    texts = [f"The solid arm is {first}."]
    if others:
        texts.append(f"Translucent in their lanes' colours: {', '.join(others)}.")
    texts.append(
        "The dashed line is the desired path of the flange, the ball where it should be; a trail "
        "in its lane's colour follows each flange. True to scale."
    )
    if any(lane.freeze is not None for lane in run.lanes.values()):
        texts.append("The arm of a lane that left its bounds turns reddish grey and stands still.")
    long = float(run.time[-1]) * RATE > MOST_PICTURES
    why = "the run is long" if long else "its rows are far apart"
    slower = f" (fewer than usual, because {why})" if film.rate < 25.0 else ""
    texts.append(f"{film.rate:.3g} pictures for each second of the run{slower}.")
    return (
        f'<div id="replay"><p id="replay-note" role="status">{escape(_WAITING)}</p></div>\n'
        f"{html_paragraphs([' '.join(texts)])}"
    )


_WAITING = "The replay begins when it is scrolled to; it needs JavaScript and WebGL."


def replay_scripts(recording: bytes) -> str:
    """Return Viser's page and a recording as data, empty without a recording.

    Args:
        recording: in Viser's format.
    """
    if not recording:
        return ""
    data = {
        "client": _CLIENT.read_text(encoding="utf-8"),
        "recording": b64encode(recording).decode(),
    }
    text = in_script(json.dumps(data, ensure_ascii=False))
    return f'<script type="application/json" id="replay-data">{text}</script>\n'
