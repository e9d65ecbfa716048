"""New gains of the live lane on probation: they go back by themselves if a hard goal is left."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from threading import Thread
from typing import Any

from slidetune.robot.errors import FieldError, InvalidExperimentError, SlidetuneError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.merge_patch import difference
from slidetune.server.live.goal_watch import GoalWatch, can_watch
from slidetune.server.live.session import Session
from slidetune.server.state.document import Change, Document

log = logging.getLogger("slidetune.probation")

AUTHOR = "probation"


class Probation:
    """Accepts gains for the live session, and takes them back where they don't hold."""

    def __init__(self, document: Document, session: Session) -> None:
        """Say whose experiment is changed, and which session is watched."""
        self._document = document
        self._session = session
        self._former: dict[str, Experiment] = {}

    def accept(
        self, lane: str, patch: Mapping[str, Any], author: str
    ) -> tuple[Change, list[str], list[str]]:
        """Change the gains of a lane, and watch it for ten seconds of simulated time.

        Where its present gains are on probation themselves, it goes back to those before them.

        Args:
            lane: the lane.
            patch: merge patch that touches nothing but this lane.
            author: id of the client that asks.

        Returns:
            The change, the names of the hard goals that are watched, and of those that the live
            session can't measure.

        Raises:
            InvalidExperimentError: naming every refused field; nothing is changed.
            SessionBusyError: if as many commands wait for the session as may.
        """
        before = self._document.experiment
        before.lane(lane)
        lanes = patch.get("lanes")
        if set(patch) - {"lanes"} or not isinstance(lanes, Mapping) or set(lanes) - {lane}:
            text = f"what is accepted are gains of {lane}: the patch may touch nothing else"
            raise InvalidExperimentError([FieldError("patch", text)])
        change = self._document.patch(patch, author)
        hard = {name: g for name, g in change.experiment.goals.items() if g.priority == "hard"}
        watched = {name: goal for name, goal in hard.items() if can_watch(goal)}
        earlier = self._session.watches.get(lane)
        if earlier is None or earlier.decided or earlier.gains != before.lanes[lane]:
            self._former[lane] = before
        former = self._former[lane]
        self._session.watches[lane] = GoalWatch(
            lane,
            change.experiment.lanes[lane],
            watched,
            change.experiment.simulation.horizon,
            change.revision,
            self._session.epoch,
            lambda said: self._failed(lane, former, change.experiment, said),
        )
        return change, list(watched), [name for name in hard if name not in watched]

    def _failed(self, lane: str, before: Experiment, after: Experiment, said: str) -> None:
        # On the session's thread, which has no time to change an experiment.
        told = lane, before, after, said
        Thread(target=self._go_back, args=told, name="slidetune-probation", daemon=True).start()

    def _go_back(self, lane: str, before: Experiment, after: Experiment, said: str) -> None:
        if self._document.experiment.lanes.get(lane) != after.lanes[lane]:
            return  # somebody has changed its gains since: they are theirs
        former, present = ({"lanes": {lane: e.document()["lanes"][lane]}} for e in (before, after))
        stood = self._session.loop.lanes.get(lane)
        stood_still = stood is not None and stood.freeze is not None
        try:
            self._document.patch(difference(present, former), AUTHOR)
            if stood_still:
                self._session.reset_lane(lane)
        except SlidetuneError as error:
            log.exception("the former gains of %s can't be put back", lane)
            self._session.on_notice(f"{lane} left its goals: {said}. Going back failed: {error}")
            return
        self._session.on_notice(f"{lane} went back to its former gains: {said}.")
