"""Recordings as files: of columns, and of ROS 2."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from mcap_ros2.writer import Writer

Array = np.ndarray
NAMES = [f"joint_{number}" for number in range(1, 7)]
JOINT_STATE = """\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
TEXT = "string data"


def swing(rows: int = 200, period: float = 0.01) -> tuple[Array, Array]:
    """Return time in [s] and angles in [rad] of six joints. Shapes (n,) and (n, 6)."""
    time = period * np.arange(rows)
    return time, 0.5 * np.sin(time[:, None] + np.arange(6.0))


def table(path: Path, names: list[str], columns: Any, separator: str = ",") -> Path:
    """Write columns with their headers. Numbers keep all their digits."""
    rows = np.column_stack(columns).tolist()
    lines = [separator.join(names), *(separator.join(map(repr, row)) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def plain(path: Path, rows: int = 200) -> Path:
    """Write ``t, q1 … q6``."""
    time, q = swing(rows)
    return table(path, ["t", *(f"q{number}" for number in range(1, 7))], [time, q])


def joint_states(
    path: Path,
    topics: dict[str, list[dict[str, Any]]],
    begin: int = 1_700_000_000_000_000_000,
    period: int = 10_000_000,
    stamped: bool = True,
) -> Path:
    """Write messages by topic, one after the other, and a topic of another kind."""
    with path.open("wb") as file:
        writer = Writer(file)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        other = writer.register_msgdef("std_msgs/msg/String", TEXT)
        for topic, messages in topics.items():
            for number, message in enumerate(messages):
                time = begin + number * period
                sec, nanosec = divmod(time, 1_000_000_000) if stamped else (0, 0)
                header = {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": ""}
                writer.write_message(
                    topic, schema, {"header": header, **message}, log_time=time, publish_time=time
                )
        writer.write_message("/said", other, {"data": "hello"}, log_time=begin, publish_time=begin)
        writer.finish()
    return path


def messages(names: list[str], q: Array, **parts: Array) -> list[dict[str, Any]]:
    """Return a message a row."""
    empty: Array = np.empty((len(q), 0))
    return [
        {
            "name": names,
            "position": q[row].tolist(),
            "velocity": parts.get("velocity", empty)[row].tolist(),
            "effort": parts.get("effort", empty)[row].tolist(),
        }
        for row in range(len(q))
    ]
