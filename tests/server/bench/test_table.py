"""The benchmark: what it measures, not how fast."""

from __future__ import annotations

import io
import json
import os
import threading
from pathlib import Path

import pytest
from rich.console import Console

from slidetune.robot.kernels.compiler import CACHE
from slidetune.robot.laws import LAWS
from slidetune.server.bench import compiling
from slidetune.server.bench.live import FACTOR, LATENCY, READY, measure_live
from slidetune.server.bench.result import Measurement, measurement
from slidetune.server.bench.rounds import Case, interleaved
from slidetune.server.bench.runs import run_cases
from slidetune.server.bench.served import stepping_thread
from slidetune.server.bench.stepped import EXTRAPOLATED_STEPPED, FLOOR, PLAIN_STEPPED, RECURSION
from slidetune.server.bench.steps import measure_steps
from slidetune.server.bench.table import bench_text, measure, print_bench

ON_LINUX = Path("/proc/self/task").is_dir()


def silent(_: float) -> None:
    pass


def test_cases_take_turns_and_the_first_round_does_not_count() -> None:
    order: list[str] = []

    def case(name: str) -> Case:
        def run() -> float:
            order.append(name)
            return float(len(order))

        return Case(name, "µs", run)

    shares: list[float] = []
    samples = interleaved([case("a"), case("b")], 2, shares.append)
    assert order == ["a", "b"] * 3
    assert samples == {"a": [3.0, 5.0], "b": [4.0, 6.0]}
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_a_ratio_compares_rounds_and_not_the_best_of_different_moments() -> None:
    # A busy moment doubles everything in the second round: the ratio doesn't move.
    row = measurement("step", "µs", [6.0, 12.0, 6.0], [2.0, 4.0, 2.0])
    assert (row.best, row.typical, row.ratio) == (6.0, 6.0, 3.0)


def test_the_best_of_what_should_be_large_is_the_largest() -> None:
    row = measurement("runs", "Hz", [80.0, 90.0, 85.0], target=88.0, limit="at least")
    assert (row.best, row.typical, row.met) == (90.0, 85.0, True)


@pytest.mark.parametrize(
    ("row", "met"),
    [
        (Measurement("a", "s", 1.0, 5.0, target=2.0), True),
        (Measurement("a", "s", 3.0, 5.0, target=2.0), False),
        (Measurement("a", "ms", 1.0, 1.0, high=60.0, target=50.0), False),
        (Measurement("a", "", 0.98, None, target=0.99, limit="at least"), False),
        (Measurement("a", "", 1.0, None, target=0.99, limit="at least"), True),
        (Measurement("a", "s", None, None, target=2.0), None),
        (Measurement("a", "s", 1.0, None), None),
        (Measurement("a", "µs", 1.0, 1.0, ratio=1.9, target=2.0, most=2.0), True),
        (Measurement("a", "µs", 1.0, 1.0, ratio=2.1, target=2.0, most=2.0), False),
        (Measurement("a", "µs", 3.0, 3.0, ratio=1.9, target=2.0, most=2.0), False),
        (Measurement("a", "µs", 1.0, 1.0, ratio=2.1, most=2.0), False),
    ],
)
def test_a_target_is_held_against_the_figure_that_it_speaks_of(
    row: Measurement, met: bool | None
) -> None:
    assert row.met is met


def test_every_law_and_the_live_step_are_measured_against_the_floor() -> None:
    rows = {row.name: row for row in measure_steps(True, silent)}
    for row in rows.values():
        assert row.best is not None
        assert row.best > 0.0
        if row.ratio is not None:
            assert row.unit == "µs"
    for law in LAWS.values():
        assert rows[f"extrapolated step, {law.title}"].ratio is not None
    for name in (PLAIN_STEPPED, EXTRAPOLATED_STEPPED):
        assert rows[name].most == 2.0
        assert rows[name].ratio is not None
    assert rows[RECURSION].ratio is not None
    assert rows[FLOOR].ratio is None


def test_one_core_has_no_targets_that_speak_of_two(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0}, raising=False)
    cases = {case.name: case for case in run_cases(0.1, 1)}
    threads = [case for name, case in cases.items() if "thread" in name]
    assert len(threads) == 2
    assert all(case.target is None and case.note for case in threads)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1}, raising=False)
    threads = [case for case in run_cases(0.1, 1) if "thread" in case.name]
    assert all(case.target is not None and not case.note for case in threads)


def test_a_start_that_finds_its_kernels_is_measured_until_they_are_loaded() -> None:
    taken, cache = compiling.start(CACHE.parents[2])
    assert taken > 0.0
    assert Path(cache) == CACHE


def test_a_start_that_fails_is_told_in_words(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("sys.executable", str(tmp_path / "no-interpreter"))
    (row,) = compiling.measure_compiling(silent)
    assert row.best is None
    assert "no-interpreter" in row.note


@pytest.mark.skipif(not ON_LINUX, reason="only Linux reports the processor time of a thread")
def test_the_busiest_thread_is_found() -> None:
    done = threading.Event()

    def spin() -> None:
        while not done.is_set():
            pass

    thread = threading.Thread(target=spin)
    thread.start()
    try:
        assert stepping_thread(os.getpid(), 0.3) == thread.native_id
    finally:
        done.set()
        thread.join()


def test_a_quick_look_measures_a_real_server_and_judges_nothing(
    capsys: pytest.CaptureFixture[str],
) -> None:
    results = measure(True, True, Console(file=io.StringIO()))
    rows = {row["name"]: row for row in json.loads(bench_text(results))["rows"]}
    for name in (READY, FACTOR, LATENCY):
        assert rows[name]["best"] is not None, rows[name]["note"]
    assert all(row["met"] is None for row in rows.values())
    print_bench(results, Console(width=160))
    printed = capsys.readouterr().out
    assert all(name in printed for name in rows)
    assert results["machine"]["processor"] in printed


def test_a_server_that_does_not_start_is_told_in_words(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("sys.executable", str(tmp_path / "no-interpreter"))
    (row,) = measure_live(True, silent)
    assert row.best is None
    assert "no-interpreter" in row.note
