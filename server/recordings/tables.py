"""Tables of what recordings say: motions made of them, logs as lanes, what they know of the arm."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from slidetune.robot.identification.identify import Estimate, Identification
from slidetune.robot.logs.measured import MeasuredLane
from slidetune.robot.recordings.reference import Reference
from slidetune.robot.version import __version__
from slidetune.server.report.run_report import NONE, print_report

Document = dict[str, Any]


def reference_document(found: Reference) -> Document:
    """Return a motion that was made of a recording as plain JSON values."""
    return {
        "slidetune": __version__,
        "spacing": found.trajectory.spacing,
        "waypoints": len(found.trajectory.waypoints.splitlines()),
        "duration": found.duration,
        "rms": found.rms.tolist(),
        "greatest": found.greatest.tolist(),
        "remarks": list(found.remarks),
        "patch": found.patch(),
    }


def print_reference(document: Document, console: Console) -> None:
    """Print what ``reference_document`` returned."""
    console.print(
        Text(
            f"{document['waypoints']} waypoints {1e3 * document['spacing']:.4g} ms apart, from "
            f"{document['duration']:.4g} s of rows."
        )
    )
    rows = [
        ("RMS residual [mrad]", [1e3 * value for value in document["rms"]]),
        ("greatest residual [mrad]", [1e3 * value for value in document["greatest"]]),
    ]
    console.print(_per_joint(rows))
    _print_remarks(document["remarks"], console)


def logs_document(logs: Mapping[str, MeasuredLane], start: float, end: float) -> Document:
    """Return the figures of logs as plain JSON values, from ``start`` to ``end`` [s]."""
    return {
        name: {
            "metrics": lane.metrics_between(start, end).document(),
            "shift": lane.shift.seconds,
            "shift_rms": None if np.isnan(lane.shift.rms) else lane.shift.rms,
            "other_shifts": list(lane.shift.others),
            "against": lane.against,
            "span": [float(lane.time[0]), float(lane.time[-1])],
            "remarks": list(lane.remarks),
        }
        for name, lane in logs.items()
    }


def print_logs(document: Document, console: Console) -> None:
    """Print a report of a run with the logs of ``logs_document`` beside its lanes."""
    unestimated = {"error_estimate": None, "remark": ""}
    beside = {
        name: {"metrics": log["metrics"], "accuracy": unestimated, "frozen": None, "notes": []}
        for name, log in document["logs"].items()
    }
    print_report({**document, "lanes": {**document["lanes"], **beside}}, console)
    for name, log in document["logs"].items():
        begin, end = log["span"]
        whose = "its own desired motion" if log["against"] == "log" else "the experiment's"
        text = f"{begin:.4g} to {end:.4g} s, shifted by {log['shift']:.6g} s; error against {whose}"
        console.print(Text(f"log, {name}: ", style="cyan"), Text(f"{text}."), sep="")
        _print_remarks(log["remarks"], console, name)


def identification_document(found: Identification) -> Document:
    """Return what a log knows of the arm as plain JSON values."""
    return {
        "slidetune": __version__,
        "bandwidth": found.bandwidth,
        "rows": len(found.time),
        "estimates": [asdict(one) for one in found.estimates],
        "rms_torque": found.rms_torque.tolist(),
        "rms_residual": found.rms_residual.tolist(),
        "patch": found.patch,
        "remarks": list(found.remarks),
    }


def print_identification(found: Identification, console: Console) -> None:
    """Print every number with its interval, and the residual of each joint."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    headings = ("", "present", "the log says", "95 % interval", "unit", "")
    for place, heading in enumerate(headings):
        table.add_column(Text(heading), justify="right" if 0 < place < 4 else "left")
    for one in found.estimates:
        table.add_row(*map(Text, _cells(one)))
    console.print(table)
    share = 100.0 * found.rms_residual / np.maximum(found.rms_torque, 1e-300)
    rows: list[tuple[str, Sequence[float]]] = [
        ("RMS torque [N·m]", found.rms_torque.tolist()),
        ("RMS residual [N·m]", found.rms_residual.tolist()),
        ("residual [%]", share.tolist()),
    ]
    console.print(_per_joint(rows))
    console.print(
        Text(f"{len(found.time)} rows below {found.bandwidth:.3g} Hz; links as in the experiment.")
    )
    _print_remarks(found.remarks, console)


def residual_lines(found: Identification) -> Iterator[str]:
    """Yield measured and fitted torque and their difference as comma-separated values."""
    joints = found.torque.shape[1]
    names = [
        f"{name}{j + 1} [N·m]" for name in ("tau", "fitted", "residual") for j in range(joints)
    ]
    yield ",".join(["time [s]", *names]) + "\n"
    block = np.column_stack([found.time, found.torque, found.fitted, found.residual])
    for row in block.tolist():
        yield ",".join(map(repr, row)) + "\n"


def _cells(one: Estimate) -> tuple[str, ...]:
    value = NONE if one.value is None else f"{one.value:.4g}"
    known = one.low is not None and one.high is not None
    interval = f"{one.low:.4g} to {one.high:.4g}" if known else NONE
    return one.title, f"{one.present:.4g}", value, interval, one.unit, one.reason


def _per_joint(rows: Sequence[tuple[str, Sequence[float]]]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("")
    for joint in range(len(rows[0][1])):
        table.add_column(f"J{joint + 1}", justify="right")
    for title, values in rows:
        table.add_row(Text(title), *(f"{value:.3g}" for value in values))
    return table


def _print_remarks(remarks: Sequence[str], console: Console, name: str = "") -> None:
    for remark in remarks:
        head = f"note, {name}: " if name else "note: "
        console.print(Text(head, style="yellow"), Text(remark), sep="")
