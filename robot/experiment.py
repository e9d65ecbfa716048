"""The experiment: the one document from which a run, a preset, a slider and a result come."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Field, ValidationError, model_validator

from robot.disturbance import Disturbance
from robot.errors import InvalidExperimentError
from robot.laws import LAWS
from robot.merge_patch import merge_patch
from robot.quantity import Integer, Number, PerJoint, PerJointOrOff, Point, Section, field, refusal
from robot.refusal import field_errors
from robot.trajectory import SineTrajectory, Trajectory

FORMAT = 1
"""Version of the document's format."""
MAX_LANES = 6
MAX_STEPS = 200_000
"""Most steps of one run (*ours*): 200 s at 1 kHz, about 80 MB of results a lane."""

_LANE_NAME = re.compile(r"[^\x00-\x1f\x7f/\\<>\ud800-\udfff]{1,40}")


def _lane_name(name: str) -> str:
    if name == "__proto__":
        # In a browser no object can hold it: an edit of this lane could not be undone.
        raise ValueError("__proto__ is no name for a lane: JavaScript keeps it for itself")
    if not _LANE_NAME.fullmatch(name) or name != name.strip():
        raise ValueError(
            "a lane's name has 1 to 40 characters, without / \\ < > and blanks at its ends"
        )
    return name


LaneName = Annotated[str, AfterValidator(_lane_name)]
if TYPE_CHECKING:
    Lane = Any  # any of the laws' gains: which ones there are is known when the program runs
else:
    Lane = Annotated[reduce(or_, [law.lane for law in LAWS.values()]), Field(discriminator="law")]


class Payload(Section):
    """What the flange carries."""

    mass: Number = field(
        0.0,
        title="Mass",
        symbol="m",
        unit="kg",
        low=0.0,
        high=10.0,
        step=0.1,
        meaning="Mass at the flange; the arm is rated for 5 kg.",
    )
    center: Point = field(
        (0.0, 0.0, 0.05),
        title="Centre of mass",
        unit="m",
        low=-0.3,
        high=0.3,
        step=0.005,
        meaning="Where the mass sits, in the flange's frame (z points out of it).",
    )
    known: bool = field(
        False,
        title="Known to the controller",
        meaning="Whether the model of a model-based law includes the payload.",
    )


class Robot(Section):
    """The arm."""

    model: Literal["jaka_zu5"] = field(
        "jaka_zu5", title="Arm", source="published", meaning="JAKA Zu 5, six joints, 5 kg, 954 mm."
    )
    inertials: Literal["vendor", "datasheet"] = field(
        "vendor",
        title="Inertials",
        source="vendor",
        meaning="vendor: the manufacturer's description, solid steel, 96.4 kg, behind the paper's "
        "figures; datasheet: scaled to the arm's real 23 kg.",
    )
    inertia_scale: Number = field(
        1.0,
        title="Inertia scale",
        low=0.1,
        high=3.0,
        step=0.01,
        meaning="Multiplies every mass and inertia of the true arm and of the nominal one.",
    )
    armature: PerJoint = field(
        0.0,
        title="Reflected rotor inertia",
        symbol="A",
        unit="kg·m²",
        low=0.0,
        high=5.0,
        step=0.01,
        meaning="Inertia of the motors seen through the gears; the paper has none.",
    )
    viscous_friction: PerJoint = field(
        0.0,
        title="Viscous friction",
        symbol="d",
        unit="N·m·s/rad",
        low=0.0,
        high=50.0,
        step=0.1,
        meaning="Torque lost per unit of velocity; no controller knows of it.",
    )
    coulomb_friction: PerJoint = field(
        0.0,
        title="Coulomb friction",
        symbol="f_C",
        unit="N·m",
        low=0.0,
        high=50.0,
        step=0.1,
        meaning="Torque lost to any motion, smoothed by tanh(v/0.02); no controller knows of it.",
    )
    torque_limit: PerJointOrOff = field(
        None,
        title="Torque limit",
        symbol="τ_max",
        unit="N·m",
        low=1.0,
        high=5000.0,
        step=1.0,
        scale="log",
        meaning="Greatest torque of a joint; off as in the paper.",
    )
    payload: Payload = Payload()


class Simulation(Section):
    """How the closed loop is computed."""

    mode: Literal["continuous", "sampled"] = field(
        "continuous",
        title="Mode",
        source="published",
        meaning="continuous: the controller is part of the differential equation, as in the paper; "
        "sampled: it runs at its own rate and holds its torque, as on a real arm.",
    )
    step: Number = field(
        0.001,
        title="Step",
        symbol="h",
        unit="s",
        low=0.00005,
        high=0.005,
        step=0.0001,
        scale="log",
        applies="continuous",
        meaning="Step of the integration.",
    )
    scheme: Literal["extrapolated", "plain"] = field(
        "extrapolated",
        title="Scheme",
        applies="continuous",
        meaning="extrapolated: two half steps against a whole one, a hundred times as exact; "
        "plain: one linearly implicit step, faster.",
    )
    control_rate: Number = field(
        1000.0,
        title="Control rate",
        unit="Hz",
        low=50.0,
        high=10000.0,
        step=10.0,
        scale="log",
        applies="sampled",
        meaning="How often the controller measures and sets a torque.",
    )
    plant_substeps: Integer = field(
        10,
        title="Steps of the arm",
        low=1,
        high=200,
        step=1,
        applies="sampled",
        meaning="Steps of the arm within one control period.",
    )
    input_delay: Number = field(
        0.0,
        title="Input delay",
        unit="s",
        low=0.0,
        high=0.05,
        step=0.0001,
        applies="sampled",
        meaning="Time from a measurement to its torque at the joint.",
    )
    horizon: Number = field(
        10.0,
        title="Horizon",
        unit="s",
        low=0.1,
        high=120.0,
        step=0.5,
        source="published",
        meaning="Length of a whole run.",
    )
    initial_velocity: Literal["desired", "rest"] = field(
        "desired",
        title="Initial velocity",
        source="inferred",
        meaning="Whether the arm starts with the desired velocity or at rest.",
    )
    initial_error: PerJoint = field(
        0.0,
        title="Initial error",
        symbol="e(0)",
        unit="rad",
        low=-1.0,
        high=1.0,
        step=0.01,
        meaning="Desired minus actual angle at the start.",
    )

    @property
    def row_period(self) -> float:
        """Time between two rows of a result in [s]."""
        return self.step if self.mode == "continuous" else 1.0 / self.control_rate

    @property
    def hold(self) -> float:
        """For so long a torque is held in [s]; 0 where nothing is sampled."""
        return self.row_period if self.mode == "sampled" else 0.0

    @property
    def delay(self) -> tuple[int, float]:
        """Input delay as whole control periods and the steps of the arm, or parts, beyond them."""
        # Rounded, so that a delay of whole steps is one, whatever 0.1 is in binary.
        steps = round(self.input_delay * self.control_rate * self.plant_substeps, 9)
        whole, part = divmod(steps, self.plant_substeps)
        return int(whole), part

    @model_validator(mode="after")
    def _not_too_long(self) -> Simulation:
        steps = self.horizon / self.row_period
        if steps > MAX_STEPS:
            text = (
                f"horizon takes {steps:.0f} steps, at most {MAX_STEPS}: shorten it, or lengthen "
                "the step or lower the control rate"
            )
            raise refusal("horizon", self.horizon, text)
        return self


class Experiment(Section):
    """One experiment: immutable, complete, comparable with ``==``."""

    slidetune: Literal[1] = 1
    title: str = Field(default="", max_length=120, title="Title", description="Name on the screen.")
    description: str = Field(
        default="", max_length=4000, title="Description", description="What to look at."
    )
    robot: Robot = Robot()
    lanes: dict[LaneName, Lane] = Field(
        default_factory=lambda: {"RBFNN-NFTSM": LAWS["rbfnn_nftsm"].lane()},
        min_length=1,
        max_length=MAX_LANES,
        title="Lanes",
        description="Closed loops by name, all against the same trajectory and disturbance.",
    )
    trajectory: Trajectory = SineTrajectory()
    disturbance: Disturbance = Disturbance()
    simulation: Simulation = Simulation()

    def __hash__(self) -> int:
        """Agree with ``==``, which takes no notice of the lanes' order."""
        sections = (self.robot, self.trajectory, self.disturbance, self.simulation)
        return hash((self.title, self.description, frozenset(self.lanes.items()), *sections))

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> Experiment:
        """Validate a plain mapping.

        Raises:
            InvalidExperimentError: naming every refused field.
        """
        try:
            return cls.model_validate(document)
        except ValidationError as error:
            raise InvalidExperimentError(field_errors(error, cls)) from error

    def document(self) -> dict[str, Any]:
        """Return the experiment as plain JSON values."""
        return self.model_dump(mode="json")

    def patched(self, patch: Mapping[str, Any]) -> Experiment:
        """Return a copy changed by a JSON Merge Patch (RFC 7396), validated.

        A patch that changes a lane's ``law`` or the trajectory's ``kind`` drops the gains that the
        new one doesn't have. One that removes a lane and adds another renames it in its place.

        Args:
            patch: such as ``{"lanes": {"NFTSM": {"nu": 30}}}``; ``None`` removes.

        Raises:
            InvalidExperimentError: naming every refused field; nothing is changed.
        """
        return Experiment.from_document(merge_patch(self.document(), patch))
