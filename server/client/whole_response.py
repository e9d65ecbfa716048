"""Whole responses that a dashboard computed, as arrays."""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from slidetune.robot.shown import Shown

Array = np.ndarray

_LENGTH = struct.Struct("<I")
_JOINT = re.compile(r"([A-Za-z_]+)(\d+)")
_PATH = 3


@dataclass(frozen=True)
class LaneResponse:
    """One lane over the horizon, thinned to the extremes that a plot shows.

    Attributes:
        time: in [s]. Shape (m,).
        columns: quantities: ``e``, ``tau`` and ``S`` of shape (m, n), others of shape (m,); NaN
            after the lane left its bounds.
        metrics: figures of the whole run, by name, in SI units.
        frozen: when, at which joint and why it left its bounds, or ``None``.
        accuracy: how good the run is: ``error_estimate`` in [rad], ``at_least``, ``remark`` …
        goals: how the lane keeps to the goals of the experiment.
    """

    time: Array
    columns: Mapping[str, Array]
    metrics: Mapping[str, Any]
    frozen: Mapping[str, Any] | None
    accuracy: Mapping[str, Any]
    goals: Mapping[str, Any]


@dataclass(frozen=True)
class WholeResponse(Shown):
    """All lanes from t = 0 over the horizon.

    Attributes:
        revision: of the live experiment that it is of, or differs from.
        horizon: in [s].
        lanes: by name.
    """

    revision: int
    horizon: float
    lanes: Mapping[str, LaneResponse]


def decoded_response(message: bytes) -> WholeResponse:
    """Return what the answer of ``POST /api/preview`` holds."""
    (length,) = _LENGTH.unpack_from(message)
    head = json.loads(message[_LENGTH.size : _LENGTH.size + length])
    numbers = np.frombuffer(message, np.float32, offset=_LENGTH.size + length).astype(float)
    lanes, place = {}, 0
    for lane in head["lanes"]:
        points, names = lane["points"], head["channels"]
        size = points * (1 + len(names))
        rows = numbers[place : place + size].reshape(1 + len(names), points)
        place += size + _PATH * lane["path_points"]
        lanes[lane["name"]] = LaneResponse(
            rows[0],
            _grouped(names, rows[1:]),
            *(lane[part] for part in ("metrics", "frozen", "accuracy", "goals")),
        )
    return WholeResponse(head["revision"], head["horizon"], lanes)


def _grouped(names: list[str], rows: Array) -> dict[str, Array]:
    """Put the joints of a quantity beside each other."""
    places: dict[str, list[int]] = {}
    single: dict[str, Array] = {}
    for place, name in enumerate(names):
        if joint := _JOINT.fullmatch(name):
            places.setdefault(joint[1], []).append(place)
        else:
            single[name] = rows[place]
    return {**{name: rows[some].T for name, some in places.items()}, **single}
