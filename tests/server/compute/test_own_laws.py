"""Responses, studies and clusters know which version of a law's own file they are of."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.law_files.source import Source
from slidetune.robot.loop.law_trial import take_law
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.study.study import Study
from slidetune.server.compute.build import VERSION, version_of
from slidetune.server.compute.cluster_task import content_key, refuse_own_laws
from slidetune.server.compute.executor import LocalExecutor
from slidetune.server.compute.preview import Previews
from slidetune.server.compute.workers import Workers
from slidetune.server.studies.runner import StudyRunner
from slidetune.server.studies.store import StudyStore
from tests.own_laws import EXAMPLE, own_laws

OTHER = EXAMPLE.replace("+ nominal_nle[j]", "+ 0.9 * nominal_nle[j]")


@pytest.fixture(autouse=True)
def own() -> Iterator[None]:
    with own_laws():
        take_law(Source("pd.py", EXAMPLE))
        yield


def experiment() -> Experiment:
    goals = {"near": {"kind": "figure", "figure": "mae", "bound": 0.01}}
    lanes = {"A": {"law": "pd_gravity"}}
    document = {"lanes": lanes, "goals": goals, "simulation": {"horizon": 0.3}}
    return Experiment.from_document({**document, "uncertainty": {"payload": [0.0, 2.0]}})


def test_a_response_is_that_of_the_present_version() -> None:
    assert OTHER != EXAMPLE
    workers = Workers(1)
    previews = Previews(workers)

    def response() -> np.ndarray:
        found = asyncio.run(previews.respond(experiment(), False, ""))
        assert found is not None
        return found["A"].columns

    first = response()
    take_law(Source("pd.py", OTHER), "pd_gravity")
    assert not np.array_equal(response(), first)
    workers.stop()


def test_build_and_content_key_know_the_version() -> None:
    before, key = version_of(experiment()), content_key(simulate, (experiment(),))
    take_law(Source("pd.py", OTHER), "pd_gravity")
    assert before.startswith(VERSION)
    assert version_of(experiment()) != before
    assert content_key(simulate, (experiment(),)) != key
    assert version_of(Experiment()) == VERSION


def test_no_study_goes_on_with_entries_of_another_version(tmp_path: Path) -> None:
    study = Study.from_document("robustness", experiment(), {"lane": "A", "draws": 4})
    store = StudyStore(tmp_path)
    runner = StudyRunner(store, lambda: LocalExecutor(1))
    number = runner.begin(study)
    with LocalExecutor(1) as pool:
        first = next(study.entries(pool))
    store.append(number, 0, [(first.document(), None)])
    take_law(Source("pd.py", OTHER), "pd_gravity")
    runner._run(store.one(number))
    state, message, made = store.progress(number)
    assert (state, made) == ("failed", 1)
    assert "Begin it anew" in message
    store.close()


@pytest.mark.parametrize("kind", ["tune", "robustness", "worst"])
def test_a_study_under_way_ends_in_words_when_the_file_is_taken_anew(kind: str) -> None:
    wanted = {"tune": {"trials": 30}, "robustness": {"draws": 30}, "worst": {"trials": 30}}[kind]
    study = Study.from_document(kind, experiment(), {"lane": "A", **wanted})  # type: ignore[arg-type]
    with LocalExecutor(1) as pool:
        entries = study.entries(pool)
        made = [next(entries)]
        take_law(Source("pd.py", OTHER), "pd_gravity")
        with pytest.raises(Exception, match="was read again meanwhile"):
            made += list(entries)
    assert len(made) < 30


def test_a_cluster_s_workers_are_never_sent_a_law() -> None:
    with pytest.raises(InvalidExperimentError, match="don't know pd_gravity") as caught:
        refuse_own_laws((experiment(), {}, 3))
    assert caught.value.fields[0].path == "scheduler"
    refuse_own_laws((Experiment(), {}, 3))
