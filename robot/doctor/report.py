"""The doctor's words as a table of plain text."""

from __future__ import annotations

from dataclasses import asdict
from io import StringIO
from math import isfinite
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from slidetune.robot.arm.serial import SerialArm
from slidetune.robot.doctor.examine import Examined
from slidetune.robot.doctor.urdf.finding import KINDS
from slidetune.robot.fields.written_value import written

_WIDTH = 120
"""Characters a line (*ours*)."""
_HEADINGS = ("kind", "where", "line", "what", "way out")
_WIDE = _HEADINGS[3:]


def summary(examined: Examined) -> str:
    """Return in one sentence whether there is an arm, and how many findings of each kind."""
    counts = [
        f"{number} {kind}"
        for kind in KINDS
        if (number := sum(finding.kind == kind for finding in examined.findings))
    ]
    name, said = written(examined.name), ", ".join(counts) or "nothing to say"
    if examined.arm is None:
        return f"{name} can't be loaded: {said}."
    arm = examined.arm
    count = len(arm.joints)
    joints = f"{count} {'joint' if count == 1 else 'joints'}"
    return f"{name} is an arm of {joints}, its tip is {written(arm.tip)}: {said}."


def report(examined: Examined, width: int = _WIDTH) -> str:
    """Return a sentence and a table: kind, where, line, what is wrong, a way out.

    Args:
        examined: what the doctor has found.
        width: of a line in characters.

    Returns:
        Lines of plain text without colours, each ended.
    """
    page = StringIO()
    console = Console(file=page, width=width, color_system=None, highlight=False)
    console.print(Text(summary(examined)))
    if examined.findings:
        table = Table(show_lines=True)
        for heading in _HEADINGS:
            table.add_column(heading, overflow="fold", ratio=1 if heading in _WIDE else None)
        for finding in examined.findings:
            line = str(finding.line) if finding.line is not None else ""
            cells = (finding.kind, finding.where, line, finding.text, finding.remedy)
            # As text: a name in brackets is no markup.
            table.add_row(*(Text(cell) for cell in cells))
        console.print(table)
    return page.getvalue()


def examined_document(examined: Examined) -> dict[str, Any]:
    """Return what the doctor says as plain JSON values; a limit that isn't there is ``None``."""
    arm = examined.arm
    return {
        "name": examined.name,
        "summary": summary(examined),
        "findings": [asdict(finding) for finding in examined.findings],
        "arm": None
        if arm is None
        else {
            "tip": arm.tip,
            "joints": [
                {"name": name, **{key: _finite(value) for key, value in limits.items()}}
                for name, limits in zip(arm.joints, _limits(arm), strict=True)
            ],
            "held": list(arm.held),
        },
    }


def _limits(arm: SerialArm) -> list[dict[str, float]]:
    keys = ("lower", "upper", "velocity", "effort")
    rows = zip(arm.lower, arm.upper, arm.velocity, arm.effort, strict=True)
    return [dict(zip(keys, row, strict=True)) for row in rows]


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None
