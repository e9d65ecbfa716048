"""What was in force at every revision, as far back as it is kept."""

from __future__ import annotations

from random import Random
from typing import Any

import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.server.state import recent_edits
from slidetune.server.state.document import Change
from slidetune.server.state.recent_edits import RecentEdits

PATCHES: list[dict[str, Any]] = [
    {"lanes": {"NFTSM": {"nu": 3.0}}},
    {"lanes": {"NFTSM": {"nu": 30.0, "epsilon": 0.2}, "RBFNN-SMC": {"k1": 2.0}}},
    {"lanes": {"NFTSM": {"epsilon": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]}}},
    {"robot": {"torque_limit": [10.0] * 6}},
    {"robot": {"torque_limit": None}},
    {"trajectory": {"kind": "circle"}},
    {"trajectory": {"kind": "sine"}},
    {"goals": {"near": {"kind": "figure", "figure": "mae", "bound": 0.01, "priority": "hard"}}},
    {"goals": {"near": None}},
    {"uncertainty": {"payload": [0.0, 3.0]}},
    {"title": "Another"},
]


def scribbled(count: int, seed: int = 1) -> tuple[RecentEdits, dict[int, Experiment]]:
    """Edits drawn from the patches, and the experiment at every revision."""
    random, experiment = Random(seed), load_preset("paper")
    recent, known = RecentEdits(experiment, 1), {1: experiment}
    for revision in range(2, count + 2):
        patch = random.choice(PATCHES)
        experiment = experiment.patched(patch)
        recent.note(Change(revision, experiment, patch, "me"))
        known[revision] = experiment
    return recent, known


@pytest.mark.parametrize("seed", range(4))
def test_every_revision_comes_back_as_it_was(seed: int) -> None:
    recent, known = scribbled(40, seed)
    for revision, experiment in known.items():
        begin, document, later = recent.since(revision)
        assert begin == revision
        assert Experiment.from_document(document) == experiment
        assert [edit.revision for edit in later] == list(range(revision + 1, 42))


def test_what_is_not_kept_any_more_begins_later(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recent_edits, "LENGTH", 10)
    recent, known = scribbled(40)
    begin, document, later = recent.since(1)
    assert begin == 31
    assert Experiment.from_document(document) == known[31]
    assert len(later) == 10


def test_another_experiment_or_version_of_a_law_ends_what_was_before() -> None:
    recent, known = scribbled(5)
    other = load_preset("realistic")
    recent.note(Change(7, other, None, ""))
    begin, document, later = recent.since(1)
    assert (begin, later) == (7, [])
    assert Experiment.from_document(document) == other
    recent.note(Change(8, other.patched({"title": "x"}), {"title": "x"}, ""))
    recent.note(Change(9, known[2], {}, "", law=True))
    assert recent.since(1)[0] == 9
