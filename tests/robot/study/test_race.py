"""The race over draws: the same outcomes however it is cut into tasks, enough of them at once."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.study.judgement import is_beaten, looks
from slidetune.robot.study.outcome import Outcome
from slidetune.robot.study.race import AT_ONCE, MOST_DRAWS, draws_a_task, race
from slidetune.robot.study.tune import tune
from slidetune.robot.study.tuning import Tuning

LANE = "RBFNN-NFTSM"
BEST = 0.7


def made(number: int, index: int) -> Outcome:
    cost = float(np.random.default_rng([number, index]).random() ** (1 + number % 3))
    return Outcome(cost, cost, True, {}, {})


def some(number: int, draws: Sequence[int]) -> list[list[Outcome]]:
    return [[made(number, index) for index in draws]]


class Kept(Executor):
    """Makes a task when its result is asked for, and notes which there were."""

    def __init__(self) -> None:
        self.tasks: list[Future[Any]] = []
        self.calls: list[tuple[Any, ...]] = []
        self.most = 0

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        task: Future[Any] = Future()
        asked = task.result

        def result(timeout: float | None = None) -> Any:
            if not task.done():
                task.set_result(fn(*args, **kwargs))
            return asked(timeout)

        task.result = result  # type: ignore[method-assign]
        self.tasks.append(task)
        self.calls.append(args)
        self.most = max(self.most, sum(not one.done() for one in self.tasks))
        return task


def raced(count: int, judged_by: str, executor: Executor, size: int, at_once: int = AT_ONCE) -> Any:
    return race(
        range(8),
        range(count),
        looks(count, judged_by),
        size,
        lambda number, draws: executor.submit(some, number, draws),
        lambda met: is_beaten([one.cost for one in met], count, judged_by, BEST),
        at_once,
    )


def step_by_step(count: int, judged_by: str) -> dict[int, list[Outcome]]:
    """Race in its plainest form: look after look, all of it before anything is looked at."""
    found: dict[int, list[Outcome]] = {number: [] for number in range(8)}
    racing = list(found)
    for start, end in pairwise([0, *looks(count, judged_by)]):
        for number in racing:
            found[number] += some(number, range(count)[start:end])[0]
        racing = [
            number
            for number in racing
            if not is_beaten([one.cost for one in found[number]], count, judged_by, BEST)
        ]
    return found


@pytest.mark.parametrize("judged_by", ["worst", "p95"])
@pytest.mark.parametrize("count", [1, 7, 8, 50, 64])
def test_the_outcomes_are_the_same_however_the_draws_are_cut_and_how_many_are_under_way(
    count: int, judged_by: str
) -> None:
    expected = step_by_step(count, judged_by)
    if count == 50:
        assert len({len(met) for met in expected.values()}) > 1
    for size in (1, 2, 3, 5, MOST_DRAWS):
        for at_once in (1, 7, AT_ONCE, 1000):
            assert raced(count, judged_by, Kept(), size, at_once) == expected
        with ThreadPoolExecutor(3) as pool:
            assert raced(count, judged_by, pool, size) == expected


@pytest.mark.parametrize("judged_by", ["worst", "p95"])
@pytest.mark.parametrize("count", [1, 7, 20, 50, 2000])
def test_nothing_is_asked_before_it_can_be_answered_and_the_last_time_of_all_draws(
    count: int, judged_by: str
) -> None:
    found = looks(count, judged_by)
    assert found == sorted(set(found))
    assert found[-1] == count
    assert is_beaten([1.0] * found[0], count, judged_by, 1.0)
    assert not is_beaten([1.0] * (found[0] - 1), count, judged_by, 1.0)


def test_fifty_draws_of_eight_trials_keep_fifty_cores_busy() -> None:
    experiment = load_preset("paper").patched({"uncertainty": {"payload": [0.0, 2.0]}})
    executor = Kept()
    raced(50, "p95", executor, draws_a_task(experiment))
    assert executor.most == AT_ONCE > 50


def test_what_is_given_up_is_cancelled_and_nothing_is_left_under_way() -> None:
    executor = Kept()
    found = raced(50, "p95", executor, 2)
    assert all(task.done() for task in executor.tasks)
    run = [
        call
        for call, task in zip(executor.calls, executor.tasks, strict=True)
        if not task.cancelled()
    ]
    assert sum(len(draws) for _, draws in run) == sum(len(met) for met in found.values())
    assert any(task.cancelled() for task in executor.tasks)


def test_a_task_that_fails_cancels_all_others() -> None:
    class Failing(Kept):
        def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
            task = super().submit(fn, *args, **kwargs)
            if len(self.tasks) == 5:
                task.set_exception(OSError("lost"))
            return task

    executor = Failing()
    with pytest.raises(OSError, match="lost"):
        raced(50, "p95", executor, 2)
    assert all(task.cancelled() for task in executor.tasks[5:])


def horizon(seconds: float, **simulation: Any) -> Experiment:
    return load_preset("paper").patched({"simulation": {"horizon": seconds, **simulation}})


def test_a_task_has_more_draws_the_shorter_a_run_is() -> None:
    sizes = [draws_a_task(horizon(seconds)) for seconds in (0.1, 1.0, 5.0, 10.0, 60.0)]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] == MOST_DRAWS
    assert sizes[-1] == 1
    assert sizes[3] == 3
    assert draws_a_task(load_preset("realistic")) == 1
    fine = draws_a_task(horizon(1.0, mode="sampled", plant_substeps=40))
    assert fine < draws_a_task(horizon(1.0, mode="sampled", plant_substeps=10))


@pytest.mark.parametrize("judged_by", ["worst", "p95"])
def test_a_search_finds_the_same_with_long_runs_as_with_tasks_of_one_draw(judged_by: str) -> None:
    goals = {"near": {"kind": "figure", "figure": "mae", "bound": 0.01}}
    patch = {"simulation": {"horizon": 0.2}, "goals": goals, "uncertainty": {"payload": [0.0, 3.0]}}
    experiment = load_preset("paper").patched(patch)
    wanted = Tuning(lane=LANE, trials=16, draws=20, judged_by=judged_by)

    class OneByOne(ThreadPoolExecutor):
        """Cuts every task into its draws."""

        def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
            *others, draws = args
            whole: Future[Any] = Future()
            whole.set_result([[fn(*others, (index,))[0][0] for index in draws]])
            return whole

    with OneByOne(1) as cut, ThreadPoolExecutor(2) as pool:
        assert list(tune(experiment, wanted, cut)) == list(tune(experiment, wanted, pool))
