"""The experiment: the one document from which a run, a preset, a slider and a result come."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Field, ValidationError

from slidetune.robot.arm.known import SHIPPED, KnownArm, arm_named, find_arm
from slidetune.robot.arm.section import Robot
from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.errors import InvalidExperimentError, LawChangedError, unknown_lane
from slidetune.robot.experiment.merge_patch import merge_patch
from slidetune.robot.experiment.simulation import Simulation
from slidetune.robot.fields.quantity import Section
from slidetune.robot.fields.refusal import field_errors
from slidetune.robot.goals.section import MOST_GOALS, AnyGoal
from slidetune.robot.goals.uncertainty import Uncertainty
from slidetune.robot.laws import LAWS, law_of
from slidetune.robot.laws.any_lane import AnyLane
from slidetune.robot.motion.trajectory import SineTrajectory, Trajectory
from slidetune.robot.shown import Shown

FORMAT = 1
"""Version of the document's format."""
MAX_LANES = 6

LONGEST_LANE_NAME = 40

_NAME = re.compile(rf"[^\x00-\x1f\x7f/\\<>\ud800-\udfff]{{1,{LONGEST_LANE_NAME}}}")


def _lane_name(name: str) -> str:
    return _checked_name(name, "lane")


def _goal_name(name: str) -> str:
    return _checked_name(name, "goal")


def _checked_name(name: str, whose: str) -> str:
    if name == "__proto__":
        # In a browser no object can hold it: an edit of it could not be undone.
        text = f"__proto__ is not allowed as a {whose}'s name: it is reserved in JavaScript"
        raise ValueError(text)
    if not _NAME.fullmatch(name) or name != name.strip():
        raise ValueError(
            f"a {whose}'s name has 1 to {LONGEST_LANE_NAME} characters, without / \\ < > and "
            "without blanks at its ends"
        )
    return name


LaneName = Annotated[str, AfterValidator(_lane_name)]
GoalName = Annotated[str, AfterValidator(_goal_name)]
if TYPE_CHECKING:
    Lane = Any  # any of the laws' gains: which ones there are is known when the program runs
else:
    Lane = AnyLane


def _arm_of(document: Any) -> KnownArm:
    """Return the arm that a document names; the shipped one where that will be refused."""
    robot = document.get("robot") if isinstance(document, Mapping) else None
    name = robot.get("model") if isinstance(robot, Mapping) else None
    arm = _known(name) if isinstance(name, str) else None
    return arm or arm_named(SHIPPED)


def _known(name: str) -> KnownArm | None:
    try:
        return find_arm(name)
    except ValueError:
        return None  # a kept arm that is damaged: the field says so


def _may_change_the_arm(patch: Any) -> bool:
    """Tell whether a merge patch may be about another arm, or is none at all."""
    if not isinstance(patch, Mapping):
        return True
    robot = patch.get("robot", {})
    return not isinstance(robot, Mapping) or "model" in robot


def _posed(document: Mapping[str, Any], arm: KnownArm) -> Mapping[str, Any]:
    """Return a document whose trajectory has the poses of its arm where it gives none."""
    if arm.name == SHIPPED:  # also where it is no document at all
        return document
    trajectory = document.get("trajectory")
    if not isinstance(trajectory, Mapping):
        return document
    home, away = list(arm.home), list(arm.away)
    poses: dict[Any, dict[str, Any]] = {
        "quintic": {"start": home, "end": away},
        "hold": {"position": home},
        "circle": {"pose": home},
    }
    kind = trajectory.get("kind")
    known = poses.get(kind, {}) if isinstance(kind, str) else {}
    return {**document, "trajectory": {**known, **trajectory}}


class Experiment(Shown, Section):
    """One experiment: immutable, complete, comparable with ``==``."""

    slidetune: Literal[1] = 1
    title: str = Field(default="", max_length=120, title="Title", description="Name on the screen.")
    description: str = Field(
        default="", max_length=4000, title="Description", description="What to look at and to try."
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
    goals: dict[GoalName, AnyGoal] = Field(
        default_factory=dict,
        max_length=MOST_GOALS,
        title="Goals",
        description="Bounds by name that every lane is held to.",
    )
    uncertainty: Uncertainty = Uncertainty()

    def __hash__(self) -> int:
        """Agree with ``==``, which takes no notice of the lanes' order."""
        sections = (self.robot, self.trajectory, self.disturbance, self.simulation)
        named = frozenset(self.lanes.items()), frozenset(self.goals.items())
        return hash((self.title, self.description, *named, *sections, self.uncertainty))

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> Experiment:
        """Validate a plain mapping.

        Raises:
            InvalidExperimentError: naming every refused field.
        """
        return cls._validated(document, _arm_of(document))

    @classmethod
    def _validated(cls, document: Mapping[str, Any], arm: KnownArm) -> Experiment:
        try:
            return cls.model_validate(_posed(document, arm), context={"joints": arm.joints})
        except ValidationError as error:
            raise InvalidExperimentError(field_errors(error, cls)) from error

    @property
    def joints(self) -> int:
        """How many joints its arm has."""
        return arm_named(self.robot.model).joints

    def lane(self, name: str, path: str = "lane") -> Section:
        """Return a lane's law and gains.

        Args:
            name: the lane.
            path: where its name was given, for the refusal.

        Raises:
            InvalidExperimentError: if there is no such lane; lists those that there are.
        """
        if name not in self.lanes:
            raise InvalidExperimentError([unknown_lane(path, name, self.lanes)])
        lane: Section = self.lanes[name]
        return lane

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
            LawChangedError: if the file of a lane's law was read again since: its gains would
                become those of another version.
        """
        for name, lane in self.lanes.items():
            if law_of(lane) is not LAWS[lane.law]:
                raise LawChangedError(name, lane.law)
        if _may_change_the_arm(patch) or (arm := _known(self.robot.model)) is None:
            return Experiment.from_document(merge_patch(self.document(), patch))
        # No section looks at another, but for the number of joints: those that the patch doesn't
        # name are valid as they are.
        names = type(self).model_fields.keys()
        changed = self.model_dump(mode="json", include={name for name in names if name in patch})
        rest = {name: getattr(self, name) for name in names if name not in patch}
        return Experiment._validated({**rest, **merge_patch(changed, patch)}, arm)
