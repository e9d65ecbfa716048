"""The process in which a recording is made beside the live session, which is not kept waiting."""

from __future__ import annotations

from base64 import b64decode, b64encode
from typing import Any

import numpy as np

from slidetune.robot.arm.known import arm_named
from slidetune.robot.arm.section import Robot
from slidetune.server.compute.apart import answer_once
from slidetune.server.run_report.recording import Film, record
from slidetune.server.scene.frame import LaneStyle
from slidetune.server.scene.replay import Replay

Array = np.ndarray


def asked_of(film: Film) -> dict[str, Any]:
    """Return a film as plain JSON values; numbers are rounded to 32 bits."""
    replay = film.replay
    return {
        "robot": replay.robot.model_dump(mode="json"),
        "styles": [[style.name, style.color] for style in replay.styles],
        "period": replay.period,
        "rows": film.rows,
        "q_d": _packed(replay.q_d),
        "desired": _packed(replay.desired),
        "q": [_packed(replay.q[style.name]) for style in replay.styles],
        "flange": [_packed(replay.flange[style.name]) for style in replay.styles],
    }


def film_from(asked: dict[str, Any]) -> Film:
    """Return the film of what ``asked_of`` returned."""
    joints = arm_named(asked["robot"]["model"]).joints
    styles = tuple(LaneStyle(name, color) for name, color in asked["styles"])
    names = [style.name for style in styles]
    angles = (_unpacked(text, joints) for text in asked["q"])
    places = (_unpacked(text, 3) for text in asked["flange"])
    replay = Replay(
        robot=Robot.model_validate(asked["robot"], context={"joints": joints}),
        styles=styles,
        period=asked["period"],
        q_d=_unpacked(asked["q_d"], joints),
        desired=_unpacked(asked["desired"], 3),
        q=dict(zip(names, angles, strict=True)),
        flange=dict(zip(names, places, strict=True)),
    )
    return Film(replay, asked["rows"])


def _packed(values: Array) -> str:
    return b64encode(values.astype("<f4").tobytes()).decode()


def _unpacked(text: str, columns: int) -> Array:
    return np.frombuffer(b64decode(text), "<f4").astype(float).reshape(-1, columns)


def answered(asked: dict[str, Any]) -> str:
    """Answer with a recording, in base64; see ``server.run_report.apart``."""
    return b64encode(record(film_from(asked))).decode()


if __name__ == "__main__":
    answer_once(answered)
