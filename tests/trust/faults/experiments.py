"""Random experiments within the bounds of the schema, in whole runs and on a live server."""

from __future__ import annotations

import json
import warnings
from collections import Counter
from dataclasses import asdict
from typing import Any

import httpx
import numpy as np

from slidetune.robot.advice.advice import advice_on
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.lenses import look_through
from slidetune.robot.loop.accuracy import GOOD, difference
from slidetune.robot.loop.response import lane_response
from slidetune.robot.loop.simulate import LaneRun, Run, simulate
from slidetune.robot.margins.margin import worst_margin
from slidetune.server.compute.preview import encode_responses
from slidetune.server.report.run_report import report
from tests.trust.faults.fault import Fault, Outcome, Promises
from tests.trust.faults.live import Follower, strict_json
from tests.trust.faults.server import FaultError, served
from tests.trust.random_experiment import Document, Draw

COLUMNS = ("q", "v", "tau", "S", "f", "weights", "e", "de", "flange")
JUDGED = 5
"""Every so many experiments one is run again at a quarter of its step, and looked at through every
lens (*ours*)."""
WILD = 0.1
"""Estimated error in [rad] from which on a motion is called chaotic, and not judged (*ours*); nor
is one that says that its estimate is only the least."""
STEPS = 60
"""Steps that the live session makes of each (*ours*)."""


def _fields_named(error: InvalidExperimentError) -> bool:
    return bool(error.fields) and all(field.path and field.message for field in error.fields)


def _is_sound(lane: LaneRun, time: Any) -> str:
    """Return what is wrong with a lane's results, or an empty text."""
    until = np.inf if lane.freeze is None else lane.freeze.time
    ran = time <= until
    for name in COLUMNS:
        values = getattr(lane, name)
        if not np.isfinite(values[ran]).all():
            return f"{name} is not finite before the lane's end"
        if not np.isnan(values[~ran]).all():
            return f"{name} goes on after the lane's end"
    if lane.freeze is not None and len(lane.freeze.cause) < 40:
        return f"frozen without a cause: {lane.freeze.cause!r}"
    accuracy = lane.accuracy
    if accuracy.error_estimate is None or not np.isfinite(accuracy.error_estimate):
        return f"no estimate of its error: {accuracy}"
    if (accuracy.error_estimate > GOOD or accuracy.unconverged) and not accuracy.remark:
        return f"not good, and not a word about it: {accuracy}"
    return ""


def _finer(experiment: Experiment) -> tuple[Experiment, int]:
    """Return the experiment at a quarter of its step, and how many of its rows make one."""
    simulation = experiment.simulation
    changes: dict[str, Any] = {"plant_substeps": 4 * simulation.plant_substeps}
    stride = 1
    if simulation.mode == "continuous":
        changes, stride = {"step": 0.25 * simulation.step}, 4
    # Finer than a person may set it, perhaps: so it is not validated.
    finer = simulation.model_copy(update=changes)
    return experiment.model_copy(update={"simulation": finer}), stride


def _is_judged_well(run: Run) -> str:
    """Return which lane is further from a finer run than it says, or an empty text."""
    finer, stride = _finer(run.experiment)
    other = simulate(finer, estimate=False)
    for name, lane in run.lanes.items():
        estimate = lane.accuracy.error_estimate or 0.0
        fine = other.lanes[name].q[::stride]
        common = min(len(lane.q), len(fine))
        apart = difference(lane.q[:common], fine[:common])
        said = estimate >= WILD or lane.accuracy.at_least
        if not said and apart > max(1e-4, 3.0 * estimate):
            return f"{name} is off by {apart:.1e} rad and says {estimate:.1e} rad"
    return ""


def run_whole(document: Document, judged: bool = False) -> str:
    """Run an experiment as ``slidetune run`` and the previews do; return what came of it.

    Args:
        document: the experiment.
        judged: whether its error is held against what it says of it, by a finer run, and its first
            lane looked at through every lens.

    Returns:
        ``ran``, ``froze`` or ``refused``; anything else is a broken promise in words.
    """
    try:
        experiment = Experiment.from_document(document)
        run = simulate(experiment)
    except InvalidExperimentError as error:
        return "refused" if _fields_named(error) else f"refused without a field: {error}"
    wrong = [text for lane in run.lanes.values() if (text := _is_sound(lane, run.time))]
    if judged and not wrong:
        wrong = [text] if (text := _is_judged_well(run)) else []
    if wrong:
        return wrong[0]
    # All that is said of it, in JSON that knows no NaN.
    told: dict[str, Any] = {"report": report(run, 0.0)}
    packed = pack(experiment)
    for name in experiment.lanes:
        told[name] = [asdict(note) for note in advice_on(packed, name)], worst_margin(packed, name)
    first = next(iter(experiment.lanes))
    if judged:
        told["lenses"] = look_through(experiment, first)
    json.dumps(told, allow_nan=False)
    encode_responses({}, {first: lane_response(experiment, first)})
    return "froze" if any(lane.freeze for lane in run.lanes.values()) else "ran"


def _guarded(document: Document, judged: bool) -> str:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return run_whole(document, judged)
        except Exception as error:
            return f"{type(error).__name__}: {error}"


def run_random(quick: bool) -> Outcome:
    """Run random experiments without a server."""
    promises, draw, count = Promises(), Draw(1), 20 if quick else 1000
    ends: Counter[str] = Counter()
    for number in range(count):
        end = _guarded(draw.document(), judged=number % JUDGED == 0)
        if promises.hold(end in ("ran", "froze", "refused"), f"no. {number}: {end}"):
            ends[end] += 1
    measured = (
        f"{ends['ran']} ran, {ends['froze']} froze with a cause, {ends['refused']} were refused "
        "with the field's name; NumPy's warnings count as crashes"
    )
    return promises.outcome(f"{count} experiments", measured)


def _refusal(answer: httpx.Response) -> str:
    """Return what is wrong with a refusal, or an empty text."""
    fields = strict_json(answer.content)["error"]["fields"]
    if answer.status_code != 422 or not fields or not all(field["path"] for field in fields):
        return f"{answer.status_code} without a field"
    return ""


def _one_live(http: httpx.Client, live: Follower, document: Document, number: int) -> str:
    """Load an experiment into the session, step it, kick it; return what came of it."""
    answer = http.put("/api/experiment", json=document)
    if answer.status_code != 200:
        return _refusal(answer) or "refused"
    revision = strict_json(answer.content)["revision"]
    http.post("/api/session/step", json={"count": STEPS}).raise_for_status()
    http.post("/api/session/kick").raise_for_status()
    http.post("/api/session/step", json={"count": STEPS}).raise_for_status()
    simulation = Experiment.from_document(document).simulation
    end = (2 * STEPS - 0.5) * simulation.row_period
    live.wait(
        lambda: live.state["revision"] == revision and live.state["time"] > end,
        f"the steps of no. {number}",
        60.0,
    )
    for address in ("/api/metrics", "/api/session", "/api/experiment"):
        strict_json(http.get(address).raise_for_status().content)
    if number % 5 == 0:
        whole = http.post("/api/preview", json={"estimate": False})
        if whole.status_code != 200:
            return f"its whole response: {whole.status_code}"
        lane = next(iter(document["lanes"]))
        seen = http.post("/api/lens", json={"lane": lane})
        if seen.status_code != 200:
            return f"its lenses: {seen.status_code}"
        strict_json(seen.content)
    lanes = live.state["lanes"].values()
    silent = [lane for lane in lanes if lane["status"] == "frozen" and not lane["cause"]]
    if silent:
        return "frozen without a cause"
    return "froze" if any(lane["status"] == "frozen" for lane in lanes) else "ran"


def load_random(quick: bool) -> Outcome:
    """Load random experiments into a live server, one after the other."""
    promises, draw, count = Promises(), Draw(2), 5 if quick else 100
    ends: Counter[str] = Counter()
    environment = {"PYTHONWARNINGS": "error::RuntimeWarning"}
    with served(environment=environment) as server, server.http() as http:
        with Follower(server.port) as live:
            for number in range(count):
                try:
                    end = _one_live(http, live, draw.document(), number)
                except (httpx.HTTPError, FaultError, ValueError) as error:
                    end = f"{type(error).__name__}: {error}"
                if promises.hold(end in ("ran", "froze", "refused"), f"no. {number}: {end}"):
                    ends[end] += 1
            promises.hold(not live.closed and not live.faults, f"a client got {live.faults[:1]}")
            rows = live.rows
        promises.hold(not server.complaints, f"the server wrote: {server.complaints[:1]}")
    measured = (
        f"{ends['ran']} ran, {ends['froze']} froze with a cause, {ends['refused']} were refused "
        f"with the field's name; {rows} rows came, all finite"
    )
    return promises.outcome(f"{count} experiments, {2 * STEPS} steps and a kick each", measured)


FAULTS = (
    Fault(
        "random-runs",
        "Random experiments within the schema's bounds, whole runs",
        "Each runs, freezes with a cause, or is refused by the field's name; none crashes; each "
        "tells its error, which a run at a quarter of its step (of every fifth) bears out; every "
        "lens takes it (of every fifth)",
        run_random,
    ),
    Fault(
        "random-live",
        "Random experiments within the schema's bounds, live",
        "As above; every message is strict JSON, every number in a frame is finite",
        load_random,
    ),
)
