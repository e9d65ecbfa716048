"""The closed loops of an experiment in lockstep.

``simulate`` and the live session both step this; nothing here knows a clock or a thread.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slidetune.robot.experiment.packed import Packed
from slidetune.robot.kernels.workspace import RECORD
from slidetune.robot.loop.lane import Lane, LaneState

Array = np.ndarray


@dataclass(frozen=True)
class LoopState:
    """All that the next steps of a closed loop depend on besides the experiment.

    Attributes:
        time: time of the next step in [s].
        number: how many steps have been made since the start; sensor noise follows it.
        period: time between two steps in [s].
        origin: the step from which time is counted, and its time in [s].
        lanes: the lanes by name.
    """

    time: float
    number: int
    period: float
    origin: tuple[int, float]
    lanes: dict[str, LaneState]


class ClosedLoop:
    """Every lane of an experiment, stepped against the same trajectory and disturbance.

    Attributes:
        packed: the experiment in force, as numbers.
        lanes: the lanes by name, in the experiment's order.
        time: time of the next step in [s].
        number: how many steps have been made since the start.
    """

    def __init__(self, packed: Packed, rows: int) -> None:
        """Stand at the beginning.

        Args:
            packed: the experiment as numbers.
            rows: rows that each lane's record holds; step ``n`` writes row ``n % rows``.
        """
        self.packed = packed
        self.rows = rows
        self.lanes = {name: self._lane(name) for name in packed.experiment.lanes}
        self.restart()

    def _lane(self, name: str) -> Lane:
        return Lane(name, self.packed, np.zeros((self.rows, len(RECORD), self.packed.joints)))

    @property
    def period(self) -> float:
        """Time between two steps in [s]."""
        return self.packed.experiment.simulation.row_period

    @property
    def time(self) -> float:
        """Time of the next step in [s]."""
        return self._since + (self.number - self._from) * self.period

    def restart(self) -> None:
        """Go back to time 0 and the initial state, in every lane."""
        self.number, self._from, self._since = 0, 0, 0.0
        for lane in self.lanes.values():
            lane.restart(self.packed)

    def restart_lane(self, name: str) -> None:
        """Let one lane begin anew where the trajectory is now; the others go on."""
        self.lanes[name].restart(self.packed, self.time)

    def state(self) -> LoopState:
        """Return a copy of all that the next steps depend on besides the experiment."""
        lanes = {name: lane.state(self.number) for name, lane in self.lanes.items()}
        return LoopState(self.time, self.number, self.period, (self._from, self._since), lanes)

    def restore(self, state: LoopState) -> None:
        """Go back to a state of this loop; the experiment stays as it is.

        From there on every row is repeated to the last bit, unless the experiment is another one.
        A lane that was not there then keeps the state that it has now.
        """
        for name, lane in self.lanes.items():
            past = state.lanes.get(name) or lane.state(self.number)
            lane.restore(past, self.packed, state.number)
        self.number = state.number
        # At another period the steps since the origin would add up to another time.
        same = state.period == self.period
        self._from, self._since = state.origin if same else (state.number, state.time)

    def adopt(self, packed: Packed, origins: dict[str, str] | None = None) -> dict[str, str]:
        """Take another experiment from the next step on; time and states go on.

        A lane that is new continues from the state of its origin: the lane that ``origins`` names,
        the one whose place it took when just one went and one came, or else the first.

        Args:
            packed: the new experiment as numbers.
            origins: names of new lanes and of the lanes that they continue.

        Returns:
            By lane the one whose state it continues: itself where it was there already.
        """
        # Only then: otherwise each edit would change the last bit of every later time.
        if packed.experiment.simulation.row_period != self.period:
            self._since, self._from = self.time, self.number
        before, self.packed = self.lanes, packed
        gone = [name for name in before if name not in packed.experiment.lanes]
        new = [name for name in packed.experiment.lanes if name not in before]
        renamed = len(gone) == 1 and len(new) == 1
        first = gone[0] if renamed else next(iter(before))
        lanes: dict[str, Lane] = {}
        continued: dict[str, str] = {}
        for name in packed.experiment.lanes:
            continued[name] = name if name in before else (origins or {}).get(name, first)
            if name in before:
                lanes[name] = before[name]
                before[name].adopt(packed)
                continue
            lanes[name] = self._lane(name)
            lanes[name].continue_from(before[continued[name]], packed)
        # At once: other threads look at it meanwhile.
        self.lanes = lanes
        return continued

    def step(self) -> int:
        """Step every lane that runs; one that leaves its bounds, or whose law fails, freezes.

        Returns:
            The row of the lanes' records that was written.
        """
        time, number, row = self.time, self.number, self.number % self.rows
        for lane in self.lanes.values():
            if lane.freeze is None:
                try:
                    joint = lane.step(time, number, row)
                except Exception as error:
                    lane.fail(self.packed, time, row, error)
                else:
                    if joint:
                        lane.stop(self.packed, time, joint, row)
            else:
                lane.hold(self.packed, time, row)
        self.number = number + 1
        return row
