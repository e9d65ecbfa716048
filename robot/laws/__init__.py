"""Control laws: one a file, joined in ``LAWS``. A further law is a file and a line here.

Laws of one's own are joined to them while the program runs; see ``robot.law_files``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from slidetune.robot.fields.quantity import Section
from slidetune.robot.laws import (
    adaptive_smc,
    computed_torque,
    integral_smc,
    nftsm,
    rbfnn_nftsm,
    rbfnn_smc,
    smc,
    super_twisting,
)
from slidetune.robot.laws.law import Law

_ALL = (
    rbfnn_nftsm.LAW,
    rbfnn_smc.LAW,
    nftsm.LAW,
    smc.LAW,
    super_twisting.LAW,
    integral_smc.LAW,
    adaptive_smc.LAW,
    computed_torque.LAW,
)
LAWS: dict[str, Law] = {law.name: law for law in _ALL}
"""Every law by name, in the order of the screen."""

if len(LAWS) < len(_ALL):
    raise ValueError("two laws have the same name: a copied file keeps the name of its original")

SHIPPED = frozenset(LAWS)
"""Names of the laws that ship with the program."""
_EARLIER: dict[type[Section], Law] = {}
"""Earlier versions of laws, by their gains: runs under way end with the one they began with."""


def register(law: Law) -> None:
    """Add a law, or take it for the present version of the one of its name.

    Raises:
        ValueError: if a law that ships with the program has that name.
    """
    if law.name in SHIPPED:
        raise ValueError(f"{law.name} is a law that ships with the program: choose another name")
    before = LAWS.get(law.name)
    if before is not None:
        _EARLIER[before.lane] = before
    LAWS[law.name] = law


def own_versions(lanes: Mapping[str, Any]) -> dict[str, str]:
    """Return by name the versions of those laws of some lanes that don't ship with the program."""
    laws = [law_of(lane) for lane in lanes.values()]
    return {law.name: law.version for law in sorted(laws, key=lambda law: law.name) if law.version}


def law_of(lane: Any) -> Law:
    """Return the law of a lane, in the version that its gains were made for."""
    law = LAWS[lane.law]
    return law if isinstance(lane, law.lane) else _EARLIER.get(type(lane), law)
