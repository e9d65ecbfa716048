"""Sliding variables: value and slopes.

e = q_d - q and de = v_d - v, everywhere in this project.
"""

from __future__ import annotations

from math import gcd

import numpy as np
from pydantic import model_validator

from slidetune.robot.fields.quantity import JOINTS, PerJoint, Section, Weight, field, refusal
from slidetune.robot.kernels.compiler import inlined, kernel
from slidetune.robot.kernels.workspace import MEASURED_Q, MEASURED_V, QD, S_E, S_V, VD, S

Array = np.ndarray

NU, C, MU, RATIO = range(4)
NFTSM_ROWS = 4
LINEAR_ROWS = 1

EXPONENTS = [
    (p, k) for p in range(5, 15, 2) for k in range(3, p, 2) if p < 2 * k and gcd(p, k) == 1
]
"""Exponents p/k to choose from (*ours*; 5/3 is *published*)."""
_TERMINAL: Weight = {"name": "mu", "symbol": "μ"}
"""Weight of the terminal term, whose exponent is p/k."""


class NftsmSurface(Section):
    """Gains of the non-singular fast terminal sliding surface (Eq. 5)."""

    nu: PerJoint = field(
        0.3,
        title="Error gain",
        symbol="ν",
        unit="1/s",
        low=0.01,
        high=100.0,
        step=0.01,
        scale="log",
        equation="Eq. 5",
        group="Sliding surface",
        source="published",
        meaning="Weight of the error; on the surface a small error decays with time constant c/ν.",
    )
    c: PerJoint = field(
        10.0,
        title="Velocity gain",
        symbol="c",
        low=0.05,
        high=50.0,
        step=0.1,
        scale="log",
        equation="Eq. 5",
        group="Sliding surface",
        source="published",
        meaning="Weight of the velocity error; with k₁ it gives the damping k₁c.",
    )
    mu: PerJoint = field(
        0.3,
        title="Terminal gain",
        symbol="μ",
        low=0.0,
        high=10.0,
        step=0.01,
        equation="Eq. 5",
        group="Sliding surface",
        source="published",
        meaning="Weight of the terminal term |de|^(p/k), which acts at large velocity errors.",
    )
    p: PerJoint = field(
        5.0,
        title="Numerator of the exponent",
        symbol="p",
        low=1.0,
        high=99.0,
        step=2.0,
        odd=True,
        fraction={
            "over": "k",
            "title": "Exponent of the terminal term",
            "symbol": "p/k",
            "pairs": EXPONENTS,
        },
        weight=_TERMINAL,
        equation="Eq. 5",
        group="Sliding surface",
        source="published",
        meaning="Odd; 1 < p/k < 2 keeps the surface non-singular.",
    )
    k: PerJoint = field(
        3.0,
        title="Denominator of the exponent",
        symbol="k",
        low=1.0,
        high=99.0,
        step=2.0,
        odd=True,
        weight=_TERMINAL,
        equation="Eq. 5",
        group="Sliding surface",
        source="published",
        meaning="Odd; 1 < p/k < 2 keeps the surface non-singular.",
    )

    @model_validator(mode="after")
    def _exponent_between_one_and_two(self) -> NftsmSurface:
        ratio = np.atleast_1d(np.divide(self.p, self.k))
        wrong = ratio[(ratio <= 1.0) | (ratio >= 2.0)]
        if wrong.size:
            shown = ", ".join(f"{value:.3g}" for value in np.unique(wrong))
            text = (
                f"the exponent p/k must lie between 1 and 2, got {shown}; send its numerator p "
                "and its denominator k together, such as p = 7 with k = 5"
            )
            raise refusal("p", self.p, text)
        return self

    def pack_surface(self, joints: int = JOINTS) -> Array:
        """Return the surface as numbers. Shape (4, n)."""
        block = np.empty((NFTSM_ROWS, joints))
        block[NU], block[C], block[MU] = self.nu, self.c, self.mu
        block[RATIO] = np.divide(self.p, self.k)
        return block


class LinearSurface(Section):
    """Gain of the conventional sliding surface."""

    lambda_: PerJoint = field(
        5.0,
        title="Error gain",
        symbol="λ",
        unit="1/s",
        low=0.01,
        high=100.0,
        step=0.1,
        scale="log",
        group="Sliding surface",
        source="inferred",
        meaning="On the surface the error decays with time constant 1/λ; not given in the paper.",
    )

    def pack_surface(self, joints: int = JOINTS) -> Array:
        """Return the surface as numbers. Shape (1, n)."""
        return np.full((LINEAR_ROWS, joints), self.lambda_)


@inlined
def nftsm_surface(block, work):  # type: ignore[no-untyped-def]
    r"""Non-singular fast terminal sliding variable (Liu et al. 2025, Eq. 5) and its slopes.

    .. math:: S = \nu e + c\,\dot e + \mu\,|\dot e|^{p/k}\operatorname{sign}(\dot e), \qquad
        \partial S/\partial\dot e = c + \mu \tfrac{p}{k} |\dot e|^{p/k-1}

    Args:
        block: numbers of ``NftsmSurface.pack_surface``. Shape (4, 6).
        work: workspace; reads the desired and the measured motion, writes S [rad/s], S_V, S_E.
    """
    for j in range(JOINTS):
        e = work[QD, j] - work[MEASURED_Q, j]
        de = work[VD, j] - work[MEASURED_V, j]
        root = block[MU, j] * abs(de) ** (block[RATIO, j] - 1.0)
        work[S, j] = block[NU, j] * e + (block[C, j] + root) * de
        work[S_V, j] = block[C, j] + block[RATIO, j] * root
        work[S_E, j] = block[NU, j]


@kernel
def linear_surface(block, work):  # type: ignore[no-untyped-def]
    r"""Conventional sliding variable and its slopes.

    .. math:: S = \lambda e + \dot e

    Args:
        block: numbers of ``LinearSurface.pack_surface``. Shape (1, 6).
        work: workspace; reads the desired and the measured motion, writes S [rad/s], S_V, S_E.
    """
    for j in range(JOINTS):
        e = work[QD, j] - work[MEASURED_Q, j]
        de = work[VD, j] - work[MEASURED_V, j]
        work[S, j] = block[0, j] * e + de
        work[S_V, j] = 1.0
        work[S_E, j] = block[0, j]
