"""Steps that are cut where their own error is too great, and how often."""

from __future__ import annotations

import gc
import weakref
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.cutting import (
    FROM,
    HALVINGS,
    LIVE_BURST,
    LIVE_PARTS,
    LOOSENESS,
    NO_ROW,
    RESULT,
    UNSOLVABLE,
    begin_parts,
    cutting_of,
    cutting_of_whole_run,
    end_part,
    next_part,
)
from slidetune.robot.integrator.implicit_step import REFUSED, STUCK
from slidetune.robot.integrator.kernel_arrays import STEP, TOLERANCE
from slidetune.robot.integrator.law_call import RAISED
from slidetune.robot.kernels.workspace import (
    CAPPED,
    CUT,
    RECORD,
    RESIGNED,
    UNSOLVED,
    WORK_ROWS,
    WRONG,
)
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.lane import Lane
from tests.robot.kernel_tables import table_of

Array = np.ndarray
H = 0.001


class Attempts:
    """Refuses every step that is longer than it likes, and keeps what was asked of it."""

    def __init__(self, longest: Any, cutting: Array) -> None:
        self.longest, self.cutting = longest, cutting
        self.work = np.zeros((WORK_ROWS, JOINTS))
        self.table = table_of(self.work, step=H)
        self.numbers = self.table.view(np.float64)
        self.made: list[tuple[float, float]] = []
        self.rows: list[int] = []

    def attempt(self, t: float, row: int) -> int:
        h = float(self.numbers[STEP])
        good = h <= self.longest(t) * (1.0 + 1e-9)
        self.work[WRONG, 0] = 0.5 if good else 3.0
        if not good and self.numbers[TOLERANCE] != np.inf:
            return REFUSED
        self.made.append((t, h))
        self.rows.append(row)
        return 0

    def make(self, t: float, row: int) -> int:
        """Make a refused step in parts, as every loop does."""
        begin_parts(t, self.cutting, self.table)
        while next_part(self.cutting, self.table):
            bad = self.attempt(float(self.cutting[FROM]), row)
            end_part(bad, self.cutting, self.table)
            row = row if bad else NO_ROW
        return int(self.cutting[RESULT])


def cut(longest: Any, cutting: Array, rows: int = 1) -> tuple[Attempts, Array]:
    attempts = Attempts(longest, cutting)
    for row in range(rows):
        assert attempts.make(row * H, row) == 0
        # What comes next is a whole step again.
        whole = (H, cutting[LOOSENESS])
        assert (attempts.numbers[STEP], attempts.numbers[TOLERANCE]) == whole
    return attempts, attempts.work


def test_parts_follow_each_other_and_fill_the_row() -> None:
    attempts, work = cut(lambda t: H / 64 if t < H / 8 else H / 2, cutting_of())
    starts, lengths = np.array(attempts.made).T
    np.testing.assert_allclose(starts[1:], np.cumsum(lengths)[:-1], atol=1e-15)
    assert lengths.sum() == pytest.approx(H)
    assert (work[CUT, 0], work[CAPPED, 0]) == (1.0, 0.0)
    # Short where it has to be, long where it may be.
    assert lengths.min() == pytest.approx(H / 64)
    assert lengths.max() == pytest.approx(H / 2)


def test_the_first_part_alone_records_the_row() -> None:
    attempts, _ = cut(lambda t: H / 8, cutting_of(), rows=2)
    assert attempts.rows == [0] + 7 * [NO_ROW] + [1] + 7 * [NO_ROW]


@pytest.mark.parametrize("scheme", ["plain", "extrapolated"])
def test_a_lane_that_is_let_go_frees_its_memory_at_once(scheme: str) -> None:
    experiment = {"lanes": {"A": {"law": "smc"}}, "simulation": {"scheme": scheme}}
    lane = Lane("A", pack(Experiment.from_document(experiment)), np.zeros((2, len(RECORD), JOINTS)))
    for row in range(2):
        assert lane.step(row * H, row, row) == 0
    record = weakref.ref(lane.record)
    gc.disable()
    try:
        del lane
        assert record() is None
    finally:
        gc.enable()


def test_a_step_is_halved_so_often_and_no_more() -> None:
    attempts, work = cut(lambda t: 0.0, cutting_of(left=np.inf, refill=0.0))
    assert len(attempts.made) == 2**HALVINGS
    assert work[CAPPED, 0] == 1.0


def test_a_joint_that_leaves_its_bounds_ends_the_row() -> None:
    attempts, asked = Attempts(None, cutting_of()), []

    def attempt(t: float, row: int) -> int:
        asked.append(t)
        return 4

    attempts.attempt = attempt  # type: ignore[method-assign]
    assert attempts.make(0.0, 0) == 4
    assert asked == [0.0] * HALVINGS


def test_a_law_that_raises_ends_the_row_at_once() -> None:
    attempts, asked = Attempts(None, cutting_of()), []

    def attempt(t: float, row: int) -> int:
        asked.append(t)
        return RAISED

    attempts.attempt = attempt  # type: ignore[method-assign]
    assert attempts.make(0.0, 0) == RAISED
    assert asked == [0.0]


def test_what_cannot_be_solved_is_cut_until_its_attempts_are_spent() -> None:
    cutting = cutting_of(halvings=20, left=np.inf, refill=0.0, stuck=7.0)
    attempts, resigned = Attempts(None, cutting), []

    def attempt(t: float, row: int) -> int:
        resigned.append(bool(attempts.work[RESIGNED, 0]))
        return 0 if resigned[-1] else STUCK

    attempts.attempt = attempt  # type: ignore[method-assign]
    assert attempts.make(0.0, 0) == 0
    assert resigned.count(False) == 7
    # The next row has another try, if there is something left for it.
    cutting[UNSOLVABLE] = 1.0
    assert attempts.make(H, 1) == 0
    assert resigned.count(False) == 8
    assert attempts.work[RESIGNED, 0] == 0.0


def test_a_live_session_spends_what_it_has_and_says_so() -> None:
    rows = 2000
    attempts, work = cut(lambda t: H / 32, cutting_of(), rows)
    assert len(attempts.made) <= LIVE_BURST + (LIVE_PARTS + 2.0) * rows
    assert 0.5 * rows < work[CAPPED, 0] < rows
    # Rare cuts cost nothing of the pace: none of them is capped.
    _, work = cut(lambda t: H / 32 if round(t / H) % 100 == 0 else H, cutting_of(), rows)
    assert work[CAPPED, 0] == 0.0


def test_a_whole_run_may_take_more_but_not_without_end() -> None:
    rows = 100
    attempts, work = cut(lambda t: 0.0, cutting_of_whole_run(rows), rows)
    assert len(attempts.made) <= 22 * rows
    assert work[CAPPED, 0] == rows


@pytest.mark.parametrize("mode", ["continuous", "sampled"])
@pytest.mark.parametrize("law", LAWS)
def test_torque_limits_hold(law: str, mode: str) -> None:
    limits = [40.0, 60.0, 30.0, 10.0, 8.0, 5.0]
    gains = {} if law == "computed_torque" else {"k1": 30.0, "k2": 10.0}
    document = {
        "robot": {"inertials": "datasheet", "armature": 0.5, "torque_limit": limits},
        "lanes": {"A": {"law": law, **gains}},
        "simulation": {
            "mode": mode,
            "horizon": 0.3,
            "initial_error": 0.5,
            "scheme": "plain",
            "plant_substeps": 1,
        },
    }
    packed = pack(Experiment.from_document(document))
    # Steps that are not cut: then the motion from row to row tells one torque.
    lane = Lane("A", packed, np.zeros((301, len(RECORD), JOINTS)), cutting_of(halvings=0))
    for row in range(301):
        assert lane.step(row * 1e-3, row, row) == 0
    q, v, tau = lane.record[:, :3].transpose(1, 0, 2)
    assert (np.abs(tau) <= np.array(limits)).all()
    assert (np.abs(tau) == np.array(limits)).any()
    # What the joints really got, from the motion itself.
    model, a = packed.model, np.diff(v, axis=0) / 1e-3
    data = model.createData()
    given = [pin.rnea(model, data, *row) for row in zip(q, v, a, strict=False)]
    assert (np.abs(given) <= np.array(limits) + 1e-6).all()


def test_a_run_that_can_not_be_solved_comes_to_an_end() -> None:
    rows, unsolved = 400, 0
    cutting, work = cutting_of_whole_run(rows), np.zeros((WORK_ROWS, JOINTS))
    table = table_of(work, step=H)
    numbers = table.view(np.float64)
    for row in range(rows):
        unsolved += 1
        begin_parts(row * H, cutting, table)
        while next_part(cutting, table):
            # An attempt that may not be cut counts as unsolved, and its error would have it cut.
            last, resigned = numbers[TOLERANCE] == np.inf, work[RESIGNED, 0] != 0.0
            unsolved += 1
            if last or resigned:
                work[UNSOLVED, 0] += 1.0
            end_part(0 if last else REFUSED if resigned else STUCK, cutting, table)
        assert cutting[RESULT] == 0.0
    # Each takes half a millisecond.
    assert unsolved < 4 * rows
