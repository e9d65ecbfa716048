"""Frames of the telemetry ring."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.arm.arm import flange_positions, shipped_places
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.kernels.workspace import R_Q, R_QD
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.server.live.telemetry import HEADER, LAG, Telemetry, channels, frozen_rows, rows_of

LANES = ["A", "B"]


def parse(frame: bytes) -> tuple[tuple[int, int, int, int, float, float], np.ndarray]:
    head = HEADER.unpack_from(frame)
    data = np.frombuffer(frame, np.float32, offset=HEADER.size)
    return head, data.reshape(head[2], head[1])


def block(rows: int, start: int = 0) -> np.ndarray:
    return np.arange(start, start + rows)[:, None] + np.arange(len(channels(LANES, 6))) / 1000.0


def test_a_frame_gives_back_what_was_written() -> None:
    telemetry = Telemetry(LANES, 6)
    telemetry.write(block(7), time=0.5, period=0.001, revision=3)
    frame = telemetry.frame(0)
    assert frame is not None
    (revision, rows, columns, dropped, time, period), data = parse(frame[0])
    assert (revision, rows, columns, dropped) == (3, 7, len(telemetry.columns), 0)
    assert (time, period) == (0.5, 0.001)
    assert np.array_equal(data, block(7).astype(np.float32).T)
    assert frame[1] == 7
    assert telemetry.frame(7) is None


@pytest.mark.parametrize(
    "second",
    [
        {"time": 0.004, "period": 0.001, "revision": 2},
        {"time": 0.004, "period": 0.002, "revision": 1},
        {"time": 0.0, "period": 0.001, "revision": 1},
    ],
    ids=["revision", "period", "reset"],
)
def test_a_frame_never_mixes(second: dict[str, float]) -> None:
    telemetry = Telemetry(LANES, 6)
    telemetry.write(block(4), time=0.0, period=0.001, revision=1)
    telemetry.write(block(4, 4), **second)  # type: ignore[arg-type]
    first = telemetry.frame(0)
    assert first is not None
    assert first[1] == 4
    rest = telemetry.frame(first[1])
    assert rest is not None
    head, data = parse(rest[0])
    assert head[1] == 4
    assert data[0, 0] == 4.0


def test_a_reader_that_lags_is_skipped_ahead_and_told() -> None:
    telemetry = Telemetry(LANES, 6, rows=8192)
    for start in range(0, 20000, 500):
        telemetry.write(block(500, start), start * 0.001, 0.001, 1)
    frame = telemetry.frame(100)
    assert frame is not None
    (_, rows, _, dropped, time, _), data = parse(frame[0])
    assert dropped == 20000 - LAG - 100
    assert rows == LAG
    assert time == pytest.approx((20000 - LAG) * 0.001)
    assert data[0, 0] == 20000 - LAG


def test_two_readers_do_not_disturb_each_other() -> None:
    telemetry = Telemetry(LANES, 6)
    telemetry.write(block(10), 0.0, 0.001, 1)
    one, other = telemetry.frame(0), telemetry.frame(4)
    assert one is not None
    assert other is not None
    assert parse(one[0])[1].shape[1] == 10
    assert parse(other[0])[1].shape[1] == 6


def test_frames_hold_finite_numbers_only() -> None:
    telemetry = Telemetry(LANES, 6)
    huge = block(3)
    huge[1, 5] = 1e300
    telemetry.write(huge, 0.0, 0.001, 1)
    frame = telemetry.frame(0)
    assert frame is not None
    assert np.isfinite(parse(frame[0])[1]).all()


def test_rows_are_what_the_loop_recorded() -> None:
    lanes = {"A": {"law": "rbfnn_nftsm"}, "B": {"law": "computed_torque"}}
    loop = ClosedLoop(pack(Experiment.from_document({"lanes": lanes})), 64)
    for _ in range(100):
        loop.step()
    rows = rows_of(loop, 90, 100)
    columns = channels(LANES, 6)
    units = {one.unit for one in channels(LANES, 2, (True, False)) if one.joint == 1}
    assert units == {"m", "m/s", "N"}
    assert rows.shape == (10, len(columns))
    names = [channel.name for channel in columns]
    record = loop.lanes["B"].record[np.arange(90, 100) % 64]
    q, q_d = record[:, R_Q], record[:, R_QD]
    first = names.index("B/e1")
    assert np.allclose(rows[:, first : first + 6], q_d - q, atol=0)
    flange = names.index("B/flange_x")
    assert np.allclose(rows[:, flange : flange + 3], flange_positions(q, shipped_places()))


def test_channels_name_every_column_once() -> None:
    names = [channel.name for channel in channels(LANES, 6)]
    assert len(set(names)) == len(names)


def test_the_last_rows_are_those_of_so_many_seconds() -> None:
    telemetry = Telemetry(LANES, 6)
    telemetry.write(block(500), time=0.0, period=0.001, revision=1)
    telemetry.write(block(500, 500), time=0.5, period=0.001, revision=2)
    kept = telemetry.last(0.6)
    assert np.allclose(kept.time, np.arange(399, 1000) * 0.001)
    assert np.array_equal(kept.values[:, 0], np.arange(399, 1000))
    assert kept.revision.tolist() == [1] * 101 + [2] * 500
    assert len(telemetry.last(60.0).time) == 1000
    assert len(Telemetry(LANES, 6).last(60.0).time) == 0


def test_the_last_rows_end_where_time_ran_back() -> None:
    telemetry = Telemetry(LANES, 6)
    telemetry.write(block(500), time=0.0, period=0.001, revision=1)
    telemetry.write(block(300, 500), time=0.2, period=0.001, revision=2)
    kept = telemetry.last(60.0)
    assert kept.time[0] == 0.2
    assert np.array_equal(kept.values[:, 0], np.arange(500, 800))


def test_the_last_rows_never_hold_one_that_is_being_overwritten() -> None:
    telemetry = Telemetry(LANES, 6, rows=8192)
    for start in range(0, 20000, 500):
        telemetry.write(block(500, start), start * 0.001, 0.001, 1)
    kept = telemetry.last(60.0)
    assert np.array_equal(kept.values[:, 0], np.arange(20000 - 8192 + LAG, 20000))


def test_rows_that_were_overwritten_while_they_were_read_are_left_out() -> None:
    telemetry = Telemetry(LANES, 6, rows=16384)

    def write(first: int, last: int) -> None:
        for start in range(first, last, 500):
            telemetry.write(block(500, start), start * 0.001, 0.001, 1)

    class Overtaken(np.ndarray):
        """Values before whose first reading more rows are written than a reader may be behind."""

        def __getitem__(self, index: Any) -> Any:
            if telemetry.written == 20000:
                write(20000, 25000)
            return self.view(np.ndarray)[index]

    write(0, 20000)
    telemetry._data = telemetry._data.view(Overtaken)
    kept = telemetry.last(60.0)
    rows = np.arange(25000 - 16384 + LAG, 20000)
    assert np.array_equal(kept.values[:, 0], rows)
    assert np.allclose(kept.time, rows * 0.001)
    assert len(kept.revision) == len(kept.frozen) == len(rows)


def test_rows_after_a_freeze_say_so_until_the_lane_begins_anew() -> None:
    wild = {"law": "nftsm", "k1": 1000.0, "k2": 1000.0}
    calm = {"law": "computed_torque", "kp": 400.0, "kd": 40.0}
    document = {"lanes": {"A": calm, "B": wild}}
    simulation = {"mode": "sampled", "horizon": 10.0}
    packed = pack(Experiment.from_document({**document, "simulation": simulation}))
    loop = ClosedLoop(packed, 4096)
    telemetry = Telemetry(LANES, 6)

    def advance(count: int) -> None:
        time, first = loop.time, loop.number
        for _ in range(count):
            loop.step()
        still = frozen_rows(loop, time, count)
        telemetry.write(rows_of(loop, first, loop.number), time, loop.period, 1, still)

    advance(100)
    freeze = loop.lanes["B"].freeze
    assert freeze is not None
    loop.restart_lane("B")
    advance(1)
    kept = telemetry.last(60.0)
    still = kept.frozen >> 1 & 1
    assert np.array_equal(still[:-1], kept.time[:-1] > freeze.time + loop.period / 2)
    assert 0 < still.sum() < 100
    assert still[-1] == 0
    assert not (kept.frozen & 1).any()
