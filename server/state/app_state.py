"""What a running server holds: session, document, scene, and what it says of them."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from dataclasses import asdict
from time import monotonic
from typing import Any

from slidetune.robot import __version__
from slidetune.robot.advice.advice import advice_on
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.margins.margin import loop_margin
from slidetune.server.compute.cluster import cluster_executor
from slidetune.server.compute.executor import LocalExecutor
from slidetune.server.compute.preview import Previews
from slidetune.server.compute.workers import Workers
from slidetune.server.law_files.law_files import LawFiles
from slidetune.server.live.lane_colors import LaneColors
from slidetune.server.live.session import Session
from slidetune.server.live.telemetry import Telemetry
from slidetune.server.logs.store import LogStore
from slidetune.server.scene.feed import SceneFeed
from slidetune.server.scene.scene import Scene
from slidetune.server.state.document import Document
from slidetune.server.state.edit_history import EditHistory
from slidetune.server.state.last_results import LastResults
from slidetune.server.state.probation import Probation
from slidetune.server.state.published import law_infos, published_schema
from slidetune.server.state.recent_edits import RecentEdits
from slidetune.server.studies.runner import StudyRunner
from slidetune.server.studies.store import StudyStore, study_folder

log = logging.getLogger("slidetune.app_state")


_NO_ADVICE: dict[str, Any] = {"gamma": None, "margin": None, "notes": []}


def _remarks(packed: Packed, name: str) -> dict[str, Any]:
    """Return margin and remarks of a lane; a law that fails has none."""
    sampled = packed.experiment.simulation.mode == "sampled"
    try:
        margin = loop_margin(packed, name) if sampled else None
        return {
            "gamma": margin and margin.gamma,
            "margin": margin and margin.document(),
            "notes": [asdict(one) for one in advice_on(packed, name)],
        }
    except Exception:
        log.exception("Advice on lane %s failed.", name)
        return _NO_ADVICE


class AppState:
    """Everything that lives as long as the server.

    Attributes:
        document: the live document.
        session: the stepping thread.
        view: the 3D view.
        probation: new gains that go back by themselves if they don't hold.
        history: who changed what.
        recent_edits: every single edit of the last minutes.
        workers: threads for whole runs.
        previews: whole responses for the screen.
        results: what the owner last asked for of the live experiment.
        studies: searches, draws and sweeps that outlive a request.
        logs: logs of the real arm that the owner has brought.
        law_files: files of laws of one's own, which were named on the command line.
        started: monotonic time of the start in [s].
    """

    def __init__(
        self,
        experiment: Experiment,
        preset: str = "",
        scheduler: str = "",
        law_files: LawFiles | None = None,
    ) -> None:
        """Build all parts; ``start`` lets them run.

        Args:
            experiment: what to begin with.
            preset: name of the preset that it comes from.
            scheduler: address of the cluster that makes the runs of studies; this machine without.
            law_files: files of laws of one's own, whose laws have been taken.
        """
        packed = pack(experiment)
        self.colors = LaneColors()
        self.colors.assign(list(packed.gains))
        self.view = SceneFeed(Scene(), self.colors)
        self.session = Session(packed, self.view)
        self.document = Document(packed, preset, self.session, self.colors)
        self.probation = Probation(self.document, self.session)
        self.history = EditHistory(experiment)
        self.recent_edits = RecentEdits(experiment, self.document.revision)
        self.document.listeners += [self.history.note, self.recent_edits.note]
        self.workers = Workers()
        self.previews = Previews(self.workers)
        self.results = LastResults()
        self.studies = StudyRunner(StudyStore(study_folder()), lambda: self._executor(scheduler))
        self.logs = LogStore()
        self.law_files = law_files or LawFiles()
        self.started = monotonic()
        self._remarks: tuple[Packed | None, dict[str, Any]] = (None, {})

    def start(self) -> None:
        """Let time go on, and start the workers."""
        self.view.draw(self.session.loop)  # the first picture is slow: not on the session's time
        self.session.start()
        self.workers.start()
        self.studies.start()
        self.law_files.follow(self._document_with, self.document.take_law)

    def stop(self) -> None:
        """End the session, the workers and the scene."""
        self.law_files.close()
        self.session.stop()
        self.workers.stop()
        self.studies.close()
        self.logs.close()
        self.view.scene.close()

    def _executor(self, scheduler: str) -> AbstractContextManager[Executor]:
        """Return where a study's runs are made."""
        if scheduler:
            return cluster_executor(scheduler, lambda said: self.session.on_notice(said))
        return LocalExecutor(nice=True)

    def _document_with(self, law: str) -> dict[str, Any] | None:
        """Return the live document with its lanes of a law alone; ``None`` where none has it."""
        document = self.document.experiment.document()
        lanes = {name: lane for name, lane in document["lanes"].items() if lane["law"] == law}
        return {**document, "lanes": lanes} if lanes else None

    def experiment_of(
        self, document: Mapping[str, Any] | None, patch: Mapping[str, Any]
    ) -> Experiment:
        """Return the live experiment, or the one that ``document`` describes, with a patch.

        Raises:
            InvalidExperimentError: naming every refused field.
        """
        base = self.document.experiment
        if document is not None:
            base = Experiment.from_document(document)
        return base.patched(patch) if patch else base

    def reset(self, lane: str | None) -> None:
        """Reset the session, or one lane alone.

        Raises:
            InvalidExperimentError: for an unknown lane.
            SessionBusyError: if one lane is meant, and as many commands wait as may.
        """
        if lane is None:
            self.session.reset()
        else:
            self.document.experiment.lane(lane)
            self.session.reset_lane(lane)

    @property
    def arm(self) -> str:
        """Name of the arm that the live experiment is about."""
        return self.document.experiment.robot.model

    def health(self) -> dict[str, Any]:
        """Return version, uptime, state, and whether whole runs are compiled."""
        return {
            "version": __version__,
            "uptime": monotonic() - self.started,
            "state": "running" if self.session.playing else "paused",
            "compiled": self.document.packed.compiled,
        }

    def state(self) -> dict[str, Any]:
        """Return the ``state`` message."""
        view = {"exaggeration": self.view.exaggeration, "ghosts": self.view.ghosts}
        lanes = self.document.experiment.lanes
        selected = self.view.selected if self.view.selected in lanes else next(iter(lanes))
        return {
            "type": "state",
            **self.session.state(),
            "selected": selected,
            "view": view,
            "results": {**self.results.counts(), "logs": self.logs.changes},
        }

    def metrics(self) -> dict[str, Any]:
        """Return the ``metrics`` message: figures, sampling margin and remarks of every lane."""
        remarks = self._current_remarks()
        lanes = {
            name: {**figures, **remarks.get(name, _NO_ADVICE)}
            for name, figures in self.session.figures.document().items()
        }
        return {"type": "metrics", "lanes": lanes}

    def _current_remarks(self) -> dict[str, Any]:
        packed = self.document.packed
        if self._remarks[0] is not packed:
            self._remarks = (packed, {name: _remarks(packed, name) for name in packed.gains})
        return self._remarks[1]

    def laws(self, with_schema: bool = False) -> dict[str, Any]:
        """Return the ``laws`` message; with the schema where that has changed."""
        return {
            "type": "laws",
            "laws": law_infos(),
            "law_files": self.law_files.documents(),
            "schema": published_schema(self.arm) if with_schema else None,
            "baseline": self.document.baseline.document() if with_schema else None,
        }

    def hello(self, client: str, telemetry: Telemetry) -> dict[str, Any]:
        """Return the ``hello`` message for a client that is about to read ``telemetry``."""
        document, state = self.document, self.state()
        return {
            "type": "hello",
            "version": __version__,
            "client": client,
            "revision": document.revision,
            "experiment": document.experiment.document(),
            "baseline": document.baseline.document(),
            "preset": document.preset,
            "lanes": self.colors.document(),
            "channels": [asdict(channel) for channel in telemetry.columns],
            "laws": law_infos(),
            "law_files": self.law_files.documents(),
            "state": state,
            "selected": state["selected"],
            "view": state["view"],
        }
