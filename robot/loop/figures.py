"""What every figure of a lane says of itself: names, units, digits, meaning, and what is better.

The same record stands over the columns of the page, in the report of a run, in studies, lessons and
the contract of the server: a new figure of a run is a field of ``Metrics`` and an entry here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from slidetune.robot.loop.metrics import DEADBAND

Source = Literal["run", "accuracy", "margin"]
Reduction = Literal["mean", "greatest", "none"]
Better = Literal["less", "more", "none"]


@dataclass(frozen=True, kw_only=True)
class Figure:
    """One figure.

    Attributes:
        name: its key in the document where it stands.
        title: in words.
        short: heading of a column.
        symbol: sign in the field, empty where the title says it best.
        unit: of the number as it is, empty for none.
        shown_unit: of the number as people read it.
        factor: from the one unit to the other.
        digits: significant digits on the screen.
        per_joint: whether there are six.
        reduced: how six become one. A mean hides the worst joint: a table shows all six of these.
        better: which way is better.
        meaning: what it is, without a full stop: who quotes it may add of which joint.
        source: where it stands: ``Metrics`` of a run, its ``Accuracy``, or ``Margin``.
        column: whether the page's tables have a column for it.
        extra: whether the live table shows that only where all columns are asked for.
        live: whether the live session measures it while it runs.
        not_live: why it doesn't, of a column.
        unknown: why there may be none, of a column.
        studied: whether studies tell it and gains can be judged by it.
    """

    name: str
    title: str
    short: str
    symbol: str = ""
    unit: str = ""
    shown_unit: str = ""
    factor: float = 1.0
    digits: int = 3
    per_joint: bool = False
    reduced: Reduction = "none"
    better: Better = "less"
    meaning: str
    source: Source = "run"
    column: bool = False
    extra: bool = False
    live: bool = False
    not_live: str = ""
    unknown: str = ""
    studied: bool = False

    @property
    def label(self) -> str:
        """The symbol, or where there is none the title."""
        return self.symbol or self.title

    @property
    def heading(self) -> str:
        """The symbol, or where there is none the short title."""
        return self.symbol or self.short

    @property
    def description(self) -> str:
        """The meaning of the number as it is, as a sentence with its unit."""
        joint, unit = " by joint" * self.per_joint, f" [{self.unit}]" if self.unit else ""
        return f"{self.meaning}{joint}{unit}."

    def overall(self, value: Any) -> float | None:
        """Return one number for what ``Metrics`` holds; ``None`` where it isn't known."""
        values = np.atleast_1d(value).tolist()
        if None in values:
            return None
        return float(np.mean(values) if self.reduced == "mean" else np.max(values))

    def document(self) -> dict[str, Any]:
        """Return the entry as plain JSON values."""
        return asdict(self)


_ANGLE: dict[str, Any] = {"unit": "rad", "shown_unit": "mrad", "factor": 1e3}
_ANGLE_RATE: dict[str, Any] = {"unit": "rad/s", "shown_unit": "mrad/s", "factor": 1e3}
_DISTANCE: dict[str, Any] = {"unit": "m", "shown_unit": "mm", "factor": 1e3}
_TORQUE: dict[str, Any] = {"unit": "N·m", "shown_unit": "N·m"}
_TORQUE_RATE: dict[str, Any] = {"unit": "N·m/s", "shown_unit": "N·m/s"}
_TIME: dict[str, Any] = {"unit": "s", "shown_unit": "s"}
_MEAN: dict[str, Any] = {"per_joint": True, "reduced": "mean"}
_GREATEST: dict[str, Any] = {"per_joint": True, "reduced": "greatest"}

_ENTRIES = (
    Figure(
        name="mae",
        title="mean error",
        short="MAE",
        symbol="mean |e|",
        meaning="Mean absolute error",
        column=True,
        live=True,
        studied=True,
        **_ANGLE,
        **_MEAN,
    ),
    Figure(
        name="max_error",
        title="maximum error",
        short="max |e|",
        symbol="max |e|",
        meaning="Maximum absolute error",
        column=True,
        live=True,
        studied=True,
        **_ANGLE,
        **_GREATEST,
    ),
    Figure(
        name="max_velocity_error",
        title="maximum velocity error",
        short="max |de|",
        symbol="max |de|",
        meaning="Maximum absolute velocity error",
        live=True,
        **_ANGLE_RATE,
        **_GREATEST,
    ),
    Figure(
        name="chattering",
        title="chattering",
        short="chattering",
        meaning="Total variation of all joints' torques per second",
        column=True,
        live=True,
        studied=True,
        **_TORQUE_RATE,
    ),
    Figure(
        name="switches",
        title="switches a second",
        short="switches",
        unit="1/s",
        shown_unit="1/s",
        meaning=f"How often per second the torque reverses by more than {DEADBAND:g} N·m",
        # Few and wide reversals are no better than many and small ones.
        better="none",
        column=True,
        extra=True,
        live=True,
        **_GREATEST,
    ),
    Figure(
        name="high_frequency_torque",
        title="high-frequency torque",
        short="τ > fₕ",
        meaning="RMS torque above the high frequency fₕ, which the section Simulation sets, root "
        "sum of squares of the joints; by Welch's method, to whose windows the first 0.3 s and up "
        "to the last 0.8 s count for little",
        column=True,
        not_live="It takes the spectrum of a whole run: see the whole response.",
        unknown="Unknown: the run is shorter than 0.25 s or 12.5 periods of fₕ, or fₕ is not below "
        "half the rate of its rows.",
        **_TORQUE,
    ),
    Figure(
        name="peak_torque",
        title="peak torque",
        short="peak τ",
        symbol="peak |τ|",
        meaning="Maximum absolute torque",
        column=True,
        live=True,
        **_TORQUE,
        **_GREATEST,
    ),
    Figure(
        name="reaching_time",
        title="reaching time",
        short="reaching time",
        meaning="When S first came within its boundary layer, or crossed zero",
        **_TIME,
        **_GREATEST,
    ),
    Figure(
        name="flange_rms",
        title="flange RMS",
        short="flange RMS",
        meaning="RMS distance of the flange from its desired position",
        column=True,
        live=True,
        studied=True,
        **_DISTANCE,
    ),
    Figure(
        name="flange_max",
        title="maximum flange error",
        short="flange max",
        meaning="Maximum distance of the flange from its desired position",
        live=True,
        **_DISTANCE,
    ),
    Figure(
        name="rms_torque",
        title="RMS torque",
        short="RMS τ",
        meaning="Root mean square of the torque",
        column=True,
        extra=True,
        live=True,
        **_TORQUE,
        **_GREATEST,
    ),
    Figure(
        name="itae",
        title="ITAE",
        short="ITAE",
        unit="rad·s²",
        shown_unit="mrad·s²",
        factor=1e3,
        meaning="Integral of time times absolute error",
        column=True,
        extra=True,
        not_live="It grows without end while the session runs: see the whole response.",
        **_GREATEST,
    ),
    Figure(
        name="diverged_at",
        title="diverged at",
        short="diverged at",
        meaning="When the lane left its bounds",
        better="none",
        **_TIME,
    ),
    Figure(
        name="error_estimate",
        title="error estimate",
        short="accuracy",
        meaning="Estimated error of this run's angles, from a second, coarser run",
        source="accuracy",
        **_ANGLE,
    ),
    Figure(
        name="gamma",
        title="sampling margin",
        short="γ",
        symbol="γ",
        meaning="Largest eigenvalue of T·D·M⁻¹",
        source="margin",
        better="none",
        column=True,
        live=True,
    ),
    Figure(
        name="gamma_limit",
        title="greatest stable γ",
        short="γₘₐₓ",
        symbol="γₘₐₓ",
        meaning="The γ at which this loop becomes unstable as its reaching gains grow",
        source="margin",
        better="none",
        live=True,
    ),
    Figure(
        name="radius",
        title="spectral radius",
        short="ρ",
        symbol="ρ",
        digits=4,
        meaning="Spectral radius of one control period within the boundary layer",
        source="margin",
        better="none",
        live=True,
    ),
)

FIGURES: Mapping[str, Figure] = MappingProxyType({entry.name: entry for entry in _ENTRIES})
"""All of them by name, in the order in which they are shown."""


def figures_of(*sources: Source) -> list[Figure]:
    """Return the figures that stand in these documents."""
    return [figure for figure in FIGURES.values() if figure.source in sources]


STUDIED = tuple(figure.name for figure in FIGURES.values() if figure.studied)
"""Names of the figures by which gains are judged."""
