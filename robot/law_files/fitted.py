"""An experiment's lanes under another version of their law, whose gains may be other ones."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from slidetune.robot.arm.known import SHIPPED, arm_named
from slidetune.robot.laws.law import Law

Document = Mapping[str, Any]


def fitted(document: Document, law: Law) -> tuple[dict[str, Any], list[str]]:
    """Return an experiment's document whose lanes have only gains that a law takes.

    Args:
        document: the experiment as plain values, made for another version of the law.
        law: the version that counts.

    Returns:
        The document, and the gains that were left out, as ``lane.gain``: they are gone from the
        law, or it no longer permits their value, so that its default counts.
    """
    lanes, left_out = dict(document["lanes"]), []
    joints = arm_named(document.get("robot", {}).get("model", SHIPPED)).joints
    for name, lane in lanes.items():
        if lane.get("law") == law.name:
            lanes[name], lost = _fitted_lane(lane, law, joints)
            left_out += [f"{name}.{gain}" for gain in lost]
    return {**document, "lanes": lanes}, left_out


def _fitted_lane(lane: Document, law: Law, joints: int) -> tuple[dict[str, Any], list[str]]:
    kept = {key: value for key, value in lane.items() if key in law.lane.model_fields}
    lost = [key for key in lane if key not in kept]
    while True:
        try:
            law.lane.model_validate(kept, context={"joints": joints})
        except ValidationError as error:
            refused = {str(one["loc"][0]) for one in error.errors() if one["loc"]} & kept.keys()
            # Where a combination is refused, no gain of it is to blame: all begin anew.
            refused = (refused or kept.keys()) - {"law"}
            if not refused:
                return kept, lost
            lost += [key for key in kept if key in refused]
            kept = {key: value for key, value in kept.items() if key not in refused}
        else:
            return kept, lost
