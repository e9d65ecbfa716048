"""Control laws: one a file, joined in ``LAWS``. A further law is a file and a line here."""

from __future__ import annotations

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
