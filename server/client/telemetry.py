"""Telemetry of a dashboard as arrays."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from websockets.exceptions import ConnectionClosed
from websockets.sync.connection import Connection

from slidetune.server.client.refusal import DashboardError, refuse

Array = np.ndarray
Columns = Mapping[str, Array]

_HEADER = struct.Struct("<IIIIdd")
_CLOSED = "the dashboard ended the connection"


@dataclass(frozen=True)
class Telemetry:
    """Rows of the live session, a row a period of the controller.

    Attributes:
        revision: of the experiment under which they were computed.
        dropped: rows that are missing before the first one, as this client was too slow.
        time: simulated time in [s]. Shape (m,).
        shared: what all lanes have in common, by quantity: ``q_d`` and ``v_d``, shape (m, n), in
            [rad] and [rad/s], [m] and [m/s] where a joint slides; ``flange_d`` in [m], (m, 3).
        lanes: quantities by lane: errors ``e`` and ``de``, torques ``tau`` in [N m] or [N], sliding
            variables ``S``, network outputs ``f``, ``weights``, shape (m, n); ``flange`` in [m],
            shape (m, 3). Those of a lane that left its bounds are NaN.
    """

    revision: int
    dropped: int
    time: Array
    shared: Columns
    lanes: Mapping[str, Columns]


def decoded(message: bytes, channels: Sequence[Mapping[str, Any]]) -> Telemetry:
    """Return what a binary message of the live WebSocket holds.

    Args:
        message: as it came.
        channels: its columns, as the ``hello`` before it lists them.
    """
    revision, rows, columns, dropped, time, period = _HEADER.unpack_from(message)
    data = np.frombuffer(message, np.float32, offset=_HEADER.size).reshape(columns, rows)
    places: dict[str, dict[str, list[int]]] = {}
    for place, channel in enumerate(channels):
        places.setdefault(channel["lane"], {}).setdefault(channel["group"], []).append(place)
    lanes = {
        lane: {group: data[some].T.astype(float) for group, some in groups.items()}
        for lane, groups in places.items()
    }
    shared = lanes.pop("", {})
    return Telemetry(revision, dropped, time + period * np.arange(rows), shared, lanes)


def joined(parts: Sequence[Telemetry]) -> Telemetry:
    """Return consecutive rows as one.

    Raises:
        ValueError: if there are none, or their lanes are others.
    """
    if not parts:
        raise ValueError("there are no rows to join")
    first, last = parts[0], parts[-1]
    if any(part.lanes.keys() != first.lanes.keys() for part in parts):
        raise ValueError("the lanes changed meanwhile: join the rows before and after apart")

    def whole(columns: Sequence[Columns]) -> Columns:
        return {group: np.concatenate([one[group] for one in columns]) for group in columns[0]}

    return Telemetry(
        last.revision,
        sum(part.dropped for part in parts[1:]),
        np.concatenate([part.time for part in parts]),
        whole([part.shared for part in parts]),
        {lane: whole([part.lanes[lane] for part in parts]) for lane in first.lanes},
    )


class TelemetryStream:
    """Rows as they come; iterate over it, and leave its ``with`` to end it."""

    def __init__(self, socket: Connection) -> None:
        """Begin with a WebSocket that is open."""
        self._socket = socket
        self._channels: list[dict[str, Any]] = []

    def __enter__(self) -> TelemetryStream:
        """Return itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the connection."""
        self._socket.close()

    def __iter__(self) -> Iterator[Telemetry]:
        """Return rows, some at a time, for as long as the session plays.

        Raises:
            DashboardError: if the connection is lost.
        """
        while True:
            try:
                message = self._socket.recv()
            except ConnectionClosed as error:
                raise DashboardError(f"{_CLOSED}: {error}") from error
            if isinstance(message, bytes):
                yield decoded(message, self._channels)
                continue
            said = json.loads(message)
            if said["type"] == "hello":
                self._channels = said["channels"]
            elif said["type"] == "error":
                refuse(said["error"], 0)
