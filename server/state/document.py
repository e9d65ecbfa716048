"""The live document: the experiment in force, its revision, and where it came from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from threading import Lock
from typing import Any

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.merge_patch import difference
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.law_files.fitted import fitted
from slidetune.robot.laws import register
from slidetune.robot.laws.law import Law
from slidetune.server.compute.arm_kernels import load_kernels
from slidetune.server.live.lane_colors import LaneColors
from slidetune.server.live.session import Session

Listener = Callable[["Change"], None]


@dataclass(frozen=True)
class Change:
    """One accepted change of the document.

    Attributes:
        revision: the revision that it made.
        experiment: the experiment after it.
        patch: the merge patch, or ``None`` where the whole document was replaced.
        author: id of the client that asked, or an empty text.
        request: the client's own number for its request, or ``None``.
        law: whether it is another version of a law that made it.
    """

    revision: int
    experiment: Experiment
    patch: Mapping[str, Any] | None
    author: str
    request: Any = None
    law: bool = False


class Document:
    """The one experiment that all clients share.

    Attributes:
        experiment: the experiment in force.
        baseline: the experiment as it was loaded.
        preset: name of the preset it was loaded from, or an empty text.
        revision: counts accepted changes, from 1.
        packed: the experiment as numbers.
    """

    def __init__(self, packed: Packed, preset: str, session: Session, colors: LaneColors) -> None:
        """Start with what the session started with."""
        self.experiment = self.baseline = packed.experiment
        self.packed = packed
        self.preset = preset
        self.revision = session.revision
        self.listeners: list[Listener] = []
        self._session = session
        self._colors = colors
        self._lock = Lock()
        self._beginning = 1

    def patch(
        self,
        patch: Mapping[str, Any],
        author: str = "",
        request: Any = None,
        origins: dict[str, str] | None = None,
    ) -> Change:
        """Change the experiment by a JSON Merge Patch; the session takes it at its next step.

        Raises:
            InvalidExperimentError: naming every refused field; nothing is changed.
            SessionBusyError: if as many commands wait for the session as may.
        """
        with self._lock:
            return self._patched(patch, author, request, origins)

    def restore(self, experiment: Experiment, author: str = "") -> Change:
        """Change the experiment to what it once was; time and states go on.

        Raises:
            InvalidExperimentError: if it isn't valid any more; nothing is changed.
            SessionBusyError: if as many commands wait for the session as may.
        """
        # One lock around both: an edit in between would be left over, in neither's experiment.
        with self._lock:
            patch = difference(self.experiment.document(), experiment.document())
            return self._patched(patch, author, None, None)

    def take_law(self, law: Law) -> list[str]:
        """Take another version of a law; time and states go on, its failed lanes begin anew.

        Returns:
            Gains of the live experiment that were left out; see ``fitted``.
        """
        with self._lock:
            before, beginning = self.experiment.document(), self.baseline.document()
            register(law)
            document, left_out = fitted(before, law)
            packed = pack(Experiment.from_document(document))
            self.baseline = Experiment.from_document(fitted(beginning, law)[0])
            patch = difference(before, packed.experiment.document())
            change = replace(self._accept(packed, patch, "", None), law=True)
            self._session.adopt(packed, change.revision)
            self._tell(change)
            for name, lane in tuple(self._session.loop.lanes.items()):
                of_it = name in document["lanes"] and document["lanes"][name]["law"] == law.name
                if of_it and lane.freeze is not None and lane.freeze.joint is None:
                    self._session.reset_lane(name)
            return left_out

    def replace(
        self,
        experiment: Experiment,
        preset: str = "",
        author: str = "",
        baseline: Experiment | None = None,
    ) -> Change:
        """Begin another experiment at time 0.

        Args:
            experiment: what begins.
            preset: name of the preset that it comes from.
            author: id of the client that asks.
            baseline: that preset, where the experiment differs from it.

        Raises:
            InvalidExperimentError: if the arm can't follow its trajectory; nothing is changed.
        """
        with self._lock:
            packed = pack(experiment)
            self._ready(experiment)
            self._colors.assign(list(packed.gains))
            change = self._accept(packed, None, author, None)
            self.baseline, self.preset = baseline or experiment, preset
            self._beginning += 1
            self._session.load(packed, change.revision)
            self._tell(change)
            return change

    def fork(
        self, moment: float, origin: str, name: str, gains: Mapping[str, Any], author: str = ""
    ) -> Change:
        """Go back to a recorded moment and go on from there with a variant of a lane beside it.

        Args:
            moment: simulated time in [s].
            origin: the lane whose past the new one continues.
            name: name of the new lane.
            gains: what it has otherwise than its origin.
            author: id of the client that asks.

        Raises:
            InvalidExperimentError: naming every refused field; nothing is changed.
        """
        with self._lock:
            patch = self._variant(origin, name, gains)
            packed = pack(self.experiment.patched(patch))
            self._colors.assign(list(packed.gains))
            change = self._accept(packed, patch, author, None)
            self._session.fork(packed, change.revision, moment, {name: origin})
            self._tell(change)
            return change

    def _variant(self, origin: str, name: str, gains: Mapping[str, Any]) -> dict[str, Any]:
        """Return the patch that adds a copy of a lane with some other gains."""
        copied = self.experiment.lane(origin, "origin")
        if name in self.experiment.lanes:
            text = f"there is a lane named {name} already: choose another name"
            raise InvalidExperimentError([FieldError("name", text, name)])
        return {"lanes": {name: {**copied.model_dump(mode="json"), **gains}}}

    def duplicate(self, origin: str, name: str, author: str = "", request: Any = None) -> Change:
        """Add a lane with the gains and the state of another.

        Raises:
            InvalidExperimentError: for an unknown lane or a name that is taken.
        """
        patch = self._variant(origin, name, {})
        return self.patch(patch, author, request, {name: origin})

    def present(self) -> tuple[int, Experiment]:
        """Return which loaded document this is, counted up, and the experiment in force."""
        with self._lock:
            return self._beginning, self.experiment

    def saved_as(self, preset: str, saved: Experiment, beginning: int) -> None:
        """Take what was saved under a name as the baseline, unless another was loaded meanwhile.

        Args:
            preset: the name.
            saved: what ``present`` returned before.
            beginning: likewise.
        """
        with self._lock:
            if beginning == self._beginning:
                # A lane may have got another name while the file was written.
                self.baseline, self.preset = _renamed(saved, saved, self.experiment), preset

    def _patched(
        self, patch: Mapping[str, Any], author: str, request: Any, origins: dict[str, str] | None
    ) -> Change:
        self._session.refuse_if_busy()
        packed = pack(self.experiment.patched(patch))
        self._colors.assign(list(packed.gains))
        self.baseline = _renamed(self.baseline, self.experiment, packed.experiment)
        other_arm = packed.experiment.robot.model != self.experiment.robot.model
        if other_arm:
            self._ready(packed.experiment)
        change = self._accept(packed, patch, author, request)
        if other_arm:  # whose states and weights are nothing to this one
            self._session.load(packed, change.revision)
        else:
            self._session.adopt(packed, change.revision, origins)
        self._tell(change)
        return change

    def _ready(self, experiment: Experiment) -> None:
        """Compile and read what an arm takes before the session meets it: it would stand still."""
        load_kernels(experiment.robot.model)
        if self._session.view is not None:
            self._session.view.prepare(experiment.robot.model)

    def _accept(
        self, packed: Packed, patch: Mapping[str, Any] | None, author: str, request: Any
    ) -> Change:
        self.revision += 1
        self.packed, self.experiment = packed, packed.experiment
        return Change(self.revision, packed.experiment, patch, author, request)

    def _tell(self, change: Change) -> None:
        # Inside the lock, so that every listener sees the changes in the order of their revisions.
        for listener in tuple(self.listeners):
            listener(change)


def _renamed(baseline: Experiment, before: Experiment, after: Experiment) -> Experiment:
    """Let the baseline follow when a lane gets another name, so that its gains still compare."""
    gone = [name for name in before.lanes if name not in after.lanes]
    new = [name for name in after.lanes if name not in before.lanes]
    if len(gone) != 1 or len(new) != 1 or gone[0] not in baseline.lanes:
        return baseline
    names = [new[0] if name == gone[0] else name for name in baseline.lanes]
    lanes = dict(zip(names, baseline.lanes.values(), strict=True))
    return baseline.model_copy(update={"lanes": lanes}) if len(lanes) == len(names) else baseline
