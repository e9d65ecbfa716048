"""The live session: the one thread that steps the closed loop.

Other threads ask; this one does, at the top of its next tick. Nothing else touches the loop.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from threading import Event, Thread
from typing import Any

from slidetune.robot.arm.known import arm_named
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.kernels.workspace import Q
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.server.live.commands import Commands, Request
from slidetune.server.live.goal_watch import GoalWatch
from slidetune.server.live.live_figures import LiveFigures
from slidetune.server.live.pacing import TICK, Pacer, come_first
from slidetune.server.live.push import Push, torque_of_kick
from slidetune.server.live.recorder import Recorder
from slidetune.server.live.roughness import Roughness
from slidetune.server.live.telemetry import Telemetry, frozen_rows, rows_of
from slidetune.server.live.view import View

log = logging.getLogger("slidetune.session")

BUFFER = 4096
"""Steps that a lane's record holds between two ticks (*ours*)."""
SLICE = 16
"""Most steps between two looks at the clock (*ours*)."""
SPEEDS = (0.1, 10.0)
"""Least and greatest speed [-] (*ours*)."""


class Session:
    """The closed loop in real time.

    Attributes:
        loop: the closed loop; touched by the session's thread alone.
        telemetry: the rows for all clients; another object after a change of lanes.
        figures: figures by lane, and since when they count.
        recorder: what the last minute looked like.
        revision: revision of the experiment in force.
        epoch: counts resets and loaded experiments.
        playing: whether time goes on.
        watches: by lane, whether it keeps its goals; another thread may add one.
        on_change: called on this thread when ``state`` has changed.
        on_swap: called on this thread when the first rows under an edit have been written.
        on_notice: called on this thread with a sentence for the people at the screens.
    """

    def __init__(
        self, packed: Packed, view: View | None = None, pacer: Pacer | None = None
    ) -> None:
        """Stand at the beginning of an experiment, paused until ``start``.

        Args:
            packed: the experiment as numbers.
            view: the 3D view to feed, if any.
            pacer: the clock, injected by tests.
        """
        self.pacer = pacer or Pacer()
        self.view = view
        self.playing = True
        self.epoch = 0
        self.revision = 1
        self.on_change: Callable[[], None] = lambda: None
        self.on_swap: Callable[[], None] = lambda: None
        self.on_notice: Callable[[str], None] = lambda _: None
        self.watches: dict[str, GoalWatch] = {}
        self.recorder = Recorder()
        self._roughness = Roughness()
        self._push = Push()
        self._commands = Commands()
        self._swapped = False
        self._wake = Event()
        self._stopping = False
        self._thread = Thread(target=self._run, name="slidetune-session", daemon=True)
        self._begin(packed)

    # --- asked from any thread -----------------------------------------------------------------

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread and wait for it."""
        self._stopping = True
        self._wake.set()
        if self._thread.is_alive():
            self._thread.join(timeout=5.0)

    @property
    def waiting_steps(self) -> int:
        """How many steps will be made before what is asked for now, unless they are dropped."""
        return self._commands.steps

    def ask(self, request: Request) -> None:
        """Let the session's thread call ``request`` at the top of its next tick, in order."""
        self._commands.add(request)
        self._wake.set()

    def refuse_if_busy(self) -> None:
        """Refuse one command more than may wait.

        Raises:
            SessionBusyError: saying what to do.
        """
        self._commands.refuse_if_full()

    def _ask_instead(self, request: Request) -> None:
        """Ask for what makes the steps that wait needless."""
        self._commands.add(request, instead_of_steps=True)
        self._wake.set()

    def adopt(self, packed: Packed, revision: int, origins: dict[str, str] | None = None) -> None:
        """Swap the experiment at the next step; of several in a row, lanes aside, the last counts.

        Args:
            packed: the new experiment as numbers.
            revision: its revision.
            origins: names of new lanes and of the lanes whose state they continue.
        """
        if origins or list(packed.gains) != list(self.loop.lanes):
            self.ask(lambda: self._swap(packed, revision, origins))
            return
        self._commands.add_latest(lambda: self._swap(packed, revision, None))
        self._wake.set()

    def load(self, packed: Packed, revision: int) -> None:
        """Begin another experiment at time 0; steps that wait are dropped."""

        def begin() -> None:
            self.revision = revision
            self._begin(packed)

        self._ask_instead(begin)

    def play(self) -> None:
        """Let time go on; steps that wait are dropped."""
        self._ask_instead(lambda: self._set_playing(True))

    def pause(self) -> None:
        """Hold time; steps that wait are dropped."""
        self._ask_instead(lambda: self._set_playing(False))

    def step(self, count: int = 1) -> None:
        """Pause and make ``count`` steps, as fast as time allows; at most 4000 wait.

        Raises:
            SessionBusyError: if as many commands wait as may.
        """
        self.refuse_if_busy()
        self._commands.add_steps(count)
        self._wake.set()

    def reset(self) -> None:
        """Go back to time 0 and thaw every lane; steps that wait are dropped."""
        self._ask_instead(self._reset)

    def reset_lane(self, name: str) -> None:
        """Let one lane begin anew where the trajectory is now; a lane that is gone by then is none.

        Raises:
            SessionBusyError: if as many commands wait as may.
        """
        self.refuse_if_busy()
        self.ask(lambda: self._reset_lane(name))

    def kick(self, torque: tuple[float, ...] | None, duration: float) -> None:
        """Push the joints of all lanes with ``torque`` [N m] for ``duration`` [s].

        Raises:
            InvalidExperimentError: if the arm has another number of joints.
            SessionBusyError: if as many commands wait as may.
        """
        self.refuse_if_busy()
        packed = self.loop.packed
        pushed = torque_of_kick(torque, packed)

        def push() -> None:
            if self.loop.packed.joints == packed.joints:  # another arm may have come in between
                self._push.kick(pushed, self.loop.time, duration)

        self.ask(push)

    def fork(self, packed: Packed, revision: int, moment: float, origins: dict[str, str]) -> None:
        """Go back to a recorded moment and continue from there with other lanes.

        Args:
            packed: the experiment from there on.
            revision: its revision.
            moment: simulated time in [s]; the last recorded one before it counts.
            origins: names of new lanes and of the lanes that they continue.
        """

        def branch() -> None:
            self.recorder.restore(self.loop, moment)
            self._push.go_back(self.loop.time)
            self._swap(packed, revision, origins)
            self.figures.restart(self.loop.time, "branch")
            if self.view is not None:
                self.view.restart()
            self._set_playing(True)

        self._ask_instead(branch)

    def set_speed(self, speed: float) -> None:
        """Let ``speed`` simulated seconds pass in one of the wall's.

        Raises:
            SessionBusyError: if as many commands wait as may.
        """
        self.refuse_if_busy()

        def change() -> None:
            self.pacer.speed = speed

        self.ask(change)

    def state(self) -> dict[str, Any]:
        """Return where the session stands, as plain JSON values."""
        loop = self.loop
        return {
            "time": loop.time,
            "playing": self.playing,
            "speed": self.pacer.speed,
            "real_time_factor": self.pacer.real_time_factor if self.playing else 0.0,
            "capped": self.playing and self.pacer.capped,
            "revision": self.revision,
            "epoch": self.epoch,
            "waiting_steps": self.waiting_steps,
            "horizon": loop.packed.experiment.simulation.horizon,
            "lanes": {
                name: {**lane.document(), "remark": self._roughness.remark(name)}
                for name, lane in tuple(loop.lanes.items())
            },
        }

    # --- on the session's thread ---------------------------------------------------------------

    def _run(self) -> None:
        come_first()
        self.pacer.restart()
        while not self._stopping:
            try:
                self._tick()
            except Exception:
                log.exception("A tick of the session failed; it is paused.")
                self._commands.drop_steps()
                self.playing = False
                self.on_change()
            busy = self.playing or self.waiting_steps
            self._wake.wait(self.pacer.rest() if busy else 1.5 * TICK)
            self._wake.clear()

    def _tick(self) -> None:
        deadline = self.pacer.begin()
        self._obey(deadline)
        if self.playing:
            if self.pacer.stalled:
                self.on_notice(
                    f"Slidetune could not run for {self.pacer.stalled:.0f} s. Simulated time was "
                    "stopped meanwhile and continues from there."
                )
            self._advance_until(deadline)
        self.pacer.end(self.loop.period)
        if self.view is not None:
            self.view.draw(self.loop)

    def _obey(self, deadline: float) -> None:
        """Do what was asked, in order; where it is steps, as long as the tick's time lasts."""
        most = 1
        while (command := self._commands.take(most)) is not None:
            if not isinstance(command, int):
                command()
                continue
            if self.playing:
                self._set_playing(False)
            self._advance(command)
            if not self.waiting_steps:
                self.on_change()
            if self.pacer.overdue(deadline):
                return
            most = min(2 * most, SLICE)

    def _advance_until(self, deadline: float) -> None:
        """Step while the budget and the tick's time last."""
        period, pacer = self.loop.period, self.pacer
        while pacer.affords(period) and not pacer.overdue(deadline):
            count = 0
            while count < SLICE and pacer.affords(period):
                pacer.spend(period)
                count += 1
            self._advance(count)

    def _advance(self, count: int) -> None:
        """Make ``count`` steps and publish their rows."""
        loop, time, first = self.loop, self.loop.time, self.loop.number
        pull = self.view.pull() if self.view is not None else None
        frozen = sum(lane.freeze is not None for lane in loop.lanes.values())
        left = min(count, BUFFER)
        while left:
            left -= (part := self._push.apply(loop, pull, left))
            for _ in range(part):
                self.recorder.look(loop)
                loop.step()
        rows = rows_of(loop, first, loop.number)
        self._roughness.look(loop)
        still = frozen_rows(loop, time, len(rows))
        self.telemetry.write(rows, time, loop.period, self.revision, still)
        self.figures.add(rows, loop, time)
        for watch in tuple(self.watches.values()):
            watch.look(rows, self.telemetry.columns, loop, (self.revision, self.epoch), time)
        if self.view is not None:
            self.view.add(rows, loop.period)
        if self._swapped:
            self._swapped = False
            self.on_swap()
        if sum(lane.freeze is not None for lane in loop.lanes.values()) != frozen:
            self.on_change()

    def _begin(self, packed: Packed) -> None:
        self.loop = ClosedLoop(packed, BUFFER)
        self._new_lanes()
        self.figures = LiveFigures(self.telemetry.columns, list(self.loop.lanes))
        self._restarted()

    def _new_lanes(self) -> None:
        packed = self.loop.packed
        slides = arm_named(packed.experiment.robot.model).slides
        self.telemetry = Telemetry(list(self.loop.lanes), packed.joints, slides=slides)
        if self.view is not None:
            self.view.new_lanes(self.telemetry.columns)

    def _swap(self, packed: Packed, revision: int, origins: dict[str, str] | None) -> None:
        names, before = list(self.loop.lanes), self.loop.packed.experiment
        continued = self.loop.adopt(packed, origins)
        self.revision = revision
        if list(self.loop.lanes) != names:
            self._new_lanes()
        self.figures.adopt(before, self.loop, continued, self.telemetry.columns)
        self._swapped = True

    def _set_playing(self, playing: bool) -> None:
        if playing and not self.playing:
            self.pacer.restart()
        self.playing = playing
        self.on_change()

    def _reset(self) -> None:
        self.loop.restart()
        self.figures.restart(0.0, "reset")
        self._restarted()

    def _reset_lane(self, name: str) -> None:
        if name not in self.loop.lanes:
            return
        self.loop.restart_lane(name)
        self.figures.lanes[name].restart(self.loop.time, "reset")
        if self.view is not None:
            self.view.restart_lane(name)
        self.on_change()

    def _restarted(self) -> None:
        self.epoch += 1
        self._roughness.restart()
        self.recorder.clear()
        self._push.clear()
        self.pacer.restart()
        if self.view is not None:
            self.view.restart()
        self.on_change()

    def angles(self) -> dict[str, list[float]]:
        """Return the joint angles of every lane in [rad]."""
        return {name: lane.work[Q].tolist() for name, lane in tuple(self.loop.lanes.items())}
