"""The stored solutions of the reference."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

Array = np.ndarray

PATH = Path(__file__).parent.parent / "data" / "reference.json.gz"
TIME = np.arange(51) * 0.02
"""When the angles are stored in [s]."""


class Case(NamedTuple):
    """One experiment and its solution.

    Attributes:
        origin: how it was drawn: ``hand``, a preset with sliders moved, ``wide``, over all bounds,
            or ``world``, a preset whose disturbance, payload, limit or start was moved.
        seed: what it was drawn from.
        document: the experiment as plain values.
        q: angles in [rad] at ``TIME``, NaN after it left its bounds. Shape (51, 6).
        agreement: greatest difference in [rad] of two solutions of different tolerance, ``inf``
            where the reference itself could not get through.
        end: until when it stayed within its bounds in [s].
    """

    origin: str
    seed: int
    document: dict[str, Any]
    q: Array
    agreement: float
    end: float


def read() -> list[Case]:
    """Return all cases."""
    with gzip.open(PATH, "rt", encoding="utf-8") as file:
        return [_case(record) for record in json.load(file)]


def _case(record: dict[str, Any]) -> Case:
    q = np.array(record.pop("q"), dtype=float)
    agreement = record.pop("agreement")
    return Case(**record, q=q, agreement=np.inf if agreement is None else agreement)


def write(cases: list[Case]) -> None:
    """Keep cases, to a hundredth of a microradian."""
    records = []
    for case in cases:
        q = [[None if np.isnan(x) else round(x, 8) for x in row] for row in case.q.tolist()]
        agreement = case.agreement if np.isfinite(case.agreement) else None
        records.append({**case._asdict(), "q": q, "agreement": agreement})
    text = json.dumps(records, ensure_ascii=False).encode()
    # No time stamp: the same cases give the same bytes.
    PATH.write_bytes(gzip.compress(text, mtime=0))
