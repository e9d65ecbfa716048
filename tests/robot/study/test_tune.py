"""The search: same trials whatever runs them, never worse than it began, honest about its race."""

from __future__ import annotations

from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import msgspec
import numpy as np
import pytest

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.loop.verdict import judge_goals
from slidetune.robot.study.draws import drawn
from slidetune.robot.study.judgement import ENDED, Present, judged, weighed
from slidetune.robot.study.outcome import FAILED, Outcome, cost_of, outcome, outcomes
from slidetune.robot.study.search_space import patch_of, search_space
from slidetune.robot.study.tune import Trial, best_of, pareto_front, tune
from slidetune.robot.study.tuning import Tuning

LANE = "RBFNN-NFTSM"
GOALS = {
    "settled": {"kind": "response", "channel": "e", "start": 0.5, "bound": 0.01},
    "quiet": {"kind": "figure", "figure": "chattering", "bound": 500.0, "priority": "hard"},
}
CALM = {"kind": "figure", "figure": "rms_torque", "bound": 30.0}
GAINS = {"nu": {"low": 0.1, "high": 30.0}, "k1": {"low": 50.0, "high": 500.0, "joints": "each"}}


def short(patch: dict[str, Any] | None = None) -> Experiment:
    paper = load_preset("paper").patched({"simulation": {"horizon": 1.0}, "goals": GOALS})
    return paper.patched(patch or {})


def tuning(**wanted: Any) -> Tuning:
    return Tuning(**{"lane": LANE, "gains": GAINS, "trials": 20, **wanted})


class Backwards(Executor):
    """Runs what it was given when a result is asked for, the last first: a cluster in disorder."""

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.waiting = getattr(self, "waiting", [])
        task: Future[Any] = Future()
        self.waiting.append((task, fn, args, kwargs))
        asked = task.result

        def result(timeout: float | None = None) -> Any:
            while self.waiting:
                late, function, given, named = self.waiting.pop()
                late.set_result(function(*given, **named))
            return asked(timeout)

        task.result = result  # type: ignore[method-assign]
        return task


@pytest.mark.parametrize("sampler", ["tpe", "cmaes", "nsga2"])
def test_a_seed_gives_the_same_trials_whatever_runs_them(sampler: str) -> None:
    wanted, found, experiment = tuning(sampler=sampler), [], short({"goals": {"calm": CALM}})
    for executor in (ThreadPoolExecutor(1), ThreadPoolExecutor(3), Backwards()):
        with executor:
            found.append([one.document() for one in tune(experiment, wanted, executor)])
    assert found[0] == found[1] == found[2]
    assert [one["number"] for one in found[0]] == list(range(20))
    with ThreadPoolExecutor(2) as pool:
        others = list(tune(experiment, tuning(sampler=sampler, seed=2), pool))
    assert [one.values for one in others[1:]] != [one["values"] for one in found[0][1:]]


def test_the_first_trial_is_the_present_one_and_the_best_is_no_worse() -> None:
    with ThreadPoolExecutor(2) as pool:
        trials = list(tune(short(), tuning(trials=40), pool))
    present = outcome(short(), LANE)
    assert replace(trials[0].outcome, cost=present.cost) == present
    best = best_of(trials)
    assert best is not None
    assert best.outcome.cost < trials[0].outcome.cost
    # And its patch does what it says.
    run = simulate(short().patched(best.patch), estimate=False).lanes[LANE]
    assert judge_goals(short().goals, run, run.metrics).score == best.outcome.score
    space = search_space(short(), tuning())
    assert len(space) == 7
    for one in space:
        assert all(one.low <= trial.values[one.name] <= one.high for trial in trials)


@pytest.mark.parametrize("draws", [0, 12])
def test_known_trials_are_not_run_again_and_the_rest_are_as_without_them(draws: int) -> None:
    experiment = short({"uncertainty": {"payload": [0.0, 4.0]}, "simulation": {"horizon": 0.3}})
    wanted = tuning(trials=30, draws=draws)

    def read(trials: list[Trial]) -> list[Trial]:
        return [
            msgspec.json.decode(msgspec.json.encode(one.document()), type=Trial) for one in trials
        ]

    with ThreadPoolExecutor(2) as pool:
        whole = list(tune(experiment, wanted, pool))
        ran: list[Any] = []

        class Counting(ThreadPoolExecutor):
            def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
                ran.append(args)
                return super().submit(fn, *args, **kwargs)

        with Counting(2) as counting_pool:
            rest = list(tune(experiment, wanted, counting_pool, read(whole[:19])))
    assert rest == whole[19:]
    numbers = [one.number for one in whole[19:]]
    # All draws of a trial in one task, where they are as short as here.
    assert len(ran) >= len(numbers) == 11
    assert not {str(args[2][0]) for args in ran} - {str(one.patch) for one in rest}


@pytest.mark.parametrize("joints", ["alike", "each"])
def test_gains_outside_of_their_range_are_run_as_they_are_and_no_trial_after_them_is(
    joints: str,
) -> None:
    experiment = short({"simulation": {"horizon": 0.2}, "lanes": {LANE: {"k1": 150.0}}})
    wanted = tuning(trials=24, gains={"k1": {"low": 600.0, "high": 601.0, "joints": joints}})
    with ThreadPoolExecutor(2) as pool:
        first, *others = tune(experiment, wanted, pool)
    assert set(first.values.values()) == {150.0}
    alone = outcome(experiment, LANE)
    assert replace(first.outcome, cost=alone.cost) == alone
    for trial in others:
        values = np.ravel(trial.patch["lanes"][LANE]["k1"])
        assert set(values.tolist()) == set(trial.values.values())
        assert np.all((values >= 600.0) & (values <= 601.0))


def test_who_has_seen_enough_stops_asking() -> None:
    with ThreadPoolExecutor(2) as pool:
        search = tune(short(), tuning(trials=2000), pool)
        assert next(search).number == 0
        search.close()  # type: ignore[attr-defined]


def test_without_ranges_every_gain_that_acts_is_searched_around_its_value() -> None:
    experiment = short({"lanes": {LANE: {"switching": "sign"}}})
    names = {one.name for one in search_space(experiment, tuning(gains={}))}
    assert "epsilon" not in names
    assert "alpha" not in names
    assert {"nu", "k1", "k2", "learning_rate"} <= names
    for one in search_space(experiment, tuning(gains={})):
        assert one.low <= one.present <= one.high


def test_gains_turned_alike_keep_their_proportion() -> None:
    six = [60.0, 50.0, 40.0, 30.0, 20.0, 10.0]
    experiment = short({"lanes": {LANE: {"k1": six}}})
    space = search_space(experiment, tuning(gains={"k1": {"low": 1.0, "high": 900.0}}))
    patch = patch_of(LANE, space, {"k1": 120.0})
    np.testing.assert_allclose(patch["lanes"][LANE]["k1"], np.multiply(six, 2.0))
    each = search_space(experiment, tuning(gains={"k1": {**GAINS["k1"]}}))
    values = {f"k1[{joint}]": 100.0 * joint for joint in range(1, 7)}
    assert patch_of(LANE, each, values)["lanes"][LANE]["k1"] == [100.0 * j for j in range(1, 7)]


def test_draws_are_the_same_for_every_trial_and_the_race_changes_no_winner() -> None:
    ranges = {"payload": [0.0, 4.0], "inertia": [0.7, 1.3]}
    experiment = short({"uncertainty": ranges, "simulation": {"horizon": 0.5}})
    wanted = tuning(trials=24, draws=20, judged_by="p95")
    with ThreadPoolExecutor(2) as pool:
        trials = list(tune(experiment, wanted, pool))
    assert any(one.beaten for one in trials)
    best = best_of(trials)
    assert best is not None
    costs = []
    for one in trials:
        (met,) = outcomes(experiment, LANE, [one.patch], range(20))
        kept = zip(met, trials[0].present, strict=True)
        weights = [weighed(made, experiment.goals, present) for made, present in kept]
        whole = judged(weights, 20, "p95")
        costs.append(whole.cost)
        if one.beaten:
            assert one.draws["draws"] < 20
            assert whole.cost >= best.outcome.cost
        else:
            assert one.outcome == whole
    assert min(costs) == best.outcome.cost


def test_cost_puts_hard_goals_before_soft_ones_and_ends_before_failures() -> None:
    ordered = [
        cost_of(0.5, 0.1, True),
        cost_of(1.0, 0.2, True),
        cost_of(0.1, 5000.0, True),
        cost_of(1.0001, 0.0, True),
        cost_of(4000.0, 0.0, True),
        FAILED,
    ]
    assert ordered == sorted(ordered)
    assert len(set(ordered)) == len(ordered)
    assert cost_of(0.2, 0.0, False) < cost_of(0.3, 0.0, False)


def test_the_best_gains_chatter_no_more_than_the_present_ones_at_the_same_draws() -> None:
    ranges = {"payload": [0.0, 3.0], "sensor_noise": [0.0, 2.0]}
    near = {"kind": "figure", "figure": "mae", "bound": 0.0001}
    goals = {"settled": near, "quiet": None}
    realistic = load_preset("realistic").patched({"simulation": {"horizon": 0.5}, "goals": goals})
    experiment = realistic.patched({"uncertainty": ranges})
    wanted = Tuning(lane=LANE, trials=65, draws=20)
    with ThreadPoolExecutor(2) as pool:
        trials = list(tune(experiment, wanted, pool))
        free = list(tune(experiment, wanted.model_copy(update={"quiet": False}), pool))
    best, loud = best_of(trials), best_of(free)
    assert best is not None
    assert loud is not None
    # By runs of their own, not by what the search says of itself.
    now, then, without = (
        [
            simulate(drawn(experiment.patched(one.patch), index), estimate=False)
            .lanes[LANE]
            .metrics
            for index in range(20)
        ]
        for one in (trials[0], best, loud)
    )
    pairs = list(zip(now, then, strict=True))
    # One draw of twenty is more than p95 leaves out.
    assert sum(after.chattering > before.chattering for before, after in pairs) == 0
    assert np.mean([one.mae for one in then]) < 0.75 * np.mean([one.mae for one in now])
    # It is the bound that keeps it so.
    assert np.mean([one.chattering for one in without]) > np.mean([one.chattering for one in now])
    assert best.draws["means"]["chattering"] == pytest.approx(
        np.mean([one.chattering for one in then])
    )
    assert not best.louder
    assert any(one.louder for one in trials)


def test_no_fewer_draws_keep_a_hard_goal_that_has_no_room_for_all_of_them() -> None:
    """At a bound that the present gains keep at some draws alone."""
    experiment = short({"uncertainty": {"payload": [0.0, 5.0]}, "simulation": {"horizon": 0.4}})
    calm = {"kind": "figure", "figure": "peak_torque", "bound": 1.0, "priority": "hard"}
    experiment = experiment.patched({"goals": {"calm": calm, "quiet": None}})
    (made,) = outcomes(experiment, LANE, [{}], range(20))
    bound = float(np.median([one.ratios["calm"] or np.nan for one in made]))
    experiment = experiment.patched({"goals": {"calm": {"bound": bound}}})
    with ThreadPoolExecutor(2) as pool:
        trials = list(tune(experiment, tuning(trials=65, draws=20), pool))
    best = best_of(trials)
    assert best is not None
    assert 0.4 <= trials[0].draws["kept"] <= 0.6
    assert best.draws["kept"] >= trials[0].draws["kept"]
    assert best.outcome.cost < trials[0].outcome.cost


def test_draws_that_gave_a_trial_up_come_first() -> None:
    experiment = short({"uncertainty": {"payload": [0.0, 4.0]}, "simulation": {"horizon": 0.3}})
    asked: list[tuple[str, list[int]]] = []

    class Noting(ThreadPoolExecutor):
        def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
            asked.append((str(args[2][0]), list(args[3])))
            return super().submit(fn, *args, **kwargs)

    with Noting(2) as pool:
        trials = list(tune(experiment, tuning(trials=17, draws=12), pool))
    of = {one.number: [some for patch, some in asked if patch == str(one.patch)] for one in trials}
    hardest = trials[0].hardest
    assert sorted(hardest) == list(range(12))
    assert [index for some in of[0] for index in some] == list(range(12))
    assert of[1][0][0] == hardest[0]
    beaten = [one for one in trials[1:9] if one.beaten]
    assert beaten
    assert of[9][0][0] == beaten[-1].hardest[0]


def test_one_gain_alone_can_be_searched() -> None:
    with ThreadPoolExecutor(2) as pool:
        trials = list(tune(short(), tuning(trials=24, gains={"nu": GAINS["nu"]}), pool))
    assert len({one.values["nu"] for one in trials}) > 20


def test_several_goals_have_a_front_that_nothing_beats() -> None:
    goals = {
        **GOALS,
        "quiet": {**GOALS["quiet"], "bound": 5000.0},
        "calm": {"kind": "figure", "figure": "rms_torque", "bound": 100.0},
        "smooth": {"kind": "figure", "figure": "chattering", "bound": 100.0},
    }
    experiment = short({"goals": goals, "simulation": {"horizon": 0.5}})
    names = ["settled", "calm", "smooth"]
    wanted = tuning(sampler="nsga2", trials=64)
    with ThreadPoolExecutor(2) as pool:
        trials = list(tune(experiment, wanted, pool))
        again = list(tune(experiment, wanted, pool))
    assert trials == again
    front = pareto_front(trials, names)
    assert len(front) > 1
    for one in front:
        assert one.outcome.kept
        for other in trials:
            if other.outcome.kept:
                mine, theirs = ([t.outcome.ratios[name] for name in names] for t in (one, other))
                assert mine == theirs or any(a < b for a, b in zip(mine, theirs, strict=True))  # type: ignore[operator]


@pytest.mark.parametrize("goals", ["ab", "abc"])
@pytest.mark.parametrize("digits", [1, 15])
def test_the_front_is_what_no_other_beats_in_every_goal(goals: str, digits: int) -> None:
    table = np.random.default_rng(digits).random((200, len(goals))).round(digits)
    trials = [
        Trial(
            number,
            {},
            {},
            Outcome(0.5, 1.0, True, dict(zip(goals, map(float, row), strict=True)), {}),
            {},
        )
        for number, row in enumerate(table)
    ]
    unbeaten = [
        number
        for number, row in enumerate(table)
        if not any(np.all(other <= row) and np.any(other < row) for other in table)
    ]
    assert [one.number for one in pareto_front(trials, list(goals))] == unbeaten
    assert pareto_front([], list(goals)) == []


def test_a_run_that_diverges_costs_more_the_sooner_it_ends() -> None:
    experiment = short({"simulation": {"mode": "sampled"}})
    soon, kept = outcome(experiment, LANE), outcome(short(), LANE)
    assert soon.diverged_at is not None
    assert soon.cost > FAILED > kept.cost
    assert soon.score is None
    goals = experiment.goals
    assert weighed(soon, goals, Present()).cost > ENDED > weighed(kept, goals, Present()).cost
    later = replace(soon, cost=soon.cost - 0.1)
    assert weighed(later, goals, Present()).cost < weighed(soon, goals, Present()).cost


@pytest.mark.parametrize(
    ("patch", "wanted", "path", "words"),
    [
        ({"goals": None}, {}, "goals", "set a goal first"),
        ({}, {"lane": "X"}, "lane", "no lane is named X"),
        ({}, {"gains": {"mass": GAINS["nu"]}}, "gains.mass", "it has:"),
        ({}, {"gains": {"nu": {"low": 0.001, "high": 1.0}}}, "gains.nu", "[0.01, 100]"),
        ({}, {"gains": {"alpha": {"low": 0.1, "high": 0.5}}}, "gains.alpha", "no effect"),
        ({}, {"sampler": "nsga2"}, "sampler", "two soft goals"),
        ({}, {"draws": 5}, "draws", "a range"),
    ],
)
def test_a_search_that_can_come_to_nothing_is_refused_before_it_runs(
    patch: dict[str, Any], wanted: dict[str, Any], path: str, words: str
) -> None:
    experiment = short()
    if patch:
        experiment = experiment.model_copy(update={"goals": {}})
    with pytest.raises(InvalidExperimentError) as caught:
        tune(experiment, tuning(**wanted), ThreadPoolExecutor(1))
    (field,) = caught.value.fields
    assert field.path == path
    assert words in field.message
