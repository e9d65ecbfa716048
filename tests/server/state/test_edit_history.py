"""Who changed what, and the way back."""

from __future__ import annotations

from random import Random
from typing import Any

import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.merge_patch import difference
from slidetune.server.state.document import Change
from slidetune.server.state.edit_history import JOIN, EditHistory

START = Experiment.from_document({"lanes": {"A": {"law": "nftsm"}, "B": {"law": "smc"}}})


class Scribe:
    """Makes changes at times that the test chooses."""

    def __init__(self) -> None:
        self.now = 1000.0
        self.experiment = START
        self.revision = 1
        self.history = EditHistory(START, clock=lambda: self.now)

    def change(self, author: str = "me", **lane: Any) -> None:
        self.revision += 1
        patch = {"lanes": {"A": lane}}
        self.experiment = self.experiment.patched(patch)
        self.history.note(Change(self.revision, self.experiment, patch, author))


def test_an_edit_names_author_field_and_values() -> None:
    scribe = Scribe()
    scribe.change(nu=3.0)
    (edit,) = scribe.history.entries()
    assert (edit["number"], edit["revision"], edit["author"]) == (1, 2, "me")
    assert edit["changes"] == [{"path": ["lanes", "A", "nu"], "from": 0.3, "to": 3.0}]


def test_a_drag_is_one_entry_from_its_first_to_its_last_value() -> None:
    scribe = Scribe()
    for value in (1.0, 2.0, 5.0):
        scribe.now += 0.1
        scribe.change(nu=value)
    (edit,) = scribe.history.entries()
    assert edit["changes"][0]["from"] == 0.3
    assert edit["changes"][0]["to"] == 5.0
    assert edit["revision"] == 4


def test_a_pause_another_field_or_another_author_begins_a_new_entry() -> None:
    scribe = Scribe()
    scribe.change(nu=1.0)
    scribe.now += JOIN + 0.1
    scribe.change(nu=2.0)
    scribe.change(c=2.0)
    scribe.change("you", c=3.0)
    assert len(scribe.history.entries()) == 4


def test_every_entry_leads_back_to_the_experiment_after_it() -> None:
    scribe = Scribe()
    scribe.change(nu=1.0)
    first = scribe.experiment
    scribe.change(c=2.0)
    assert scribe.history.after(1) == first
    assert scribe.history.after(2) == scribe.experiment
    assert scribe.history.after(99) is None


def test_a_change_that_changes_nothing_is_no_entry() -> None:
    scribe = Scribe()
    scribe.change(nu=0.3)
    assert scribe.history.entries() == []


def test_an_edit_that_is_taken_back_at_once_leaves_no_entry() -> None:
    scribe = Scribe()
    scribe.change(c=2.0)
    before = scribe.history.entries()
    scribe.change(nu=30.0)
    scribe.change(nu=0.3)
    assert scribe.history.entries() == before
    assert scribe.history.after(1) == scribe.experiment
    # A page that still shows the entry must not get to another one by its number.
    assert scribe.history.after(2) is None
    scribe.change(nu=5.0)
    assert [edit["number"] for edit in scribe.history.entries()] == [1, 3]


def test_the_first_edit_of_all_is_taken_back_like_any_other() -> None:
    scribe = Scribe()
    scribe.change(nu=30.0)
    scribe.change(nu=0.3)
    assert scribe.history.entries() == []


def test_a_drag_through_its_beginning_is_told_from_there() -> None:
    scribe = Scribe()
    for value in (1.0, 0.3, 0.2):
        scribe.now += 0.1
        scribe.change(nu=value)
    (edit,) = scribe.history.entries()
    assert edit["changes"] == [{"path": ["lanes", "A", "nu"], "from": 0.3, "to": 0.2}]


def test_what_another_author_or_a_later_edit_takes_back_stays_told() -> None:
    scribe = Scribe()
    scribe.change(nu=30.0)
    scribe.change("you", nu=0.3)
    scribe.change("you", c=2.0)
    scribe.now += JOIN + 0.1
    scribe.change("you", c=10.0)
    entries = scribe.history.entries()
    assert [edit["changes"][0]["to"] for edit in entries] == [30.0, 0.3, 2.0, 10.0]


@pytest.mark.parametrize(
    "there",
    [
        {"C": {"law": "smc"}},
        {"B": None},
        {"A": None, "New": START.lanes["A"].model_dump(mode="json")},
        {"A": {"law": "computed_torque"}},
    ],
    ids=["added", "removed", "renamed", "another law"],
)
def test_a_lane_that_is_changed_as_a_whole_and_back_leaves_no_entry(there: dict[str, Any]) -> None:
    history = EditHistory(START, clock=lambda: 1000.0)
    patch = {"lanes": there}
    changed = START.patched(patch)
    history.note(Change(2, changed, patch, "me"))
    (edit,) = history.entries()
    assert edit["changes"]
    history.note(Change(3, START, difference(changed.document(), START.document()), "me"))
    assert history.entries() == []


def test_no_entry_ever_is_without_a_change_and_the_last_leads_to_the_present() -> None:
    scribe, dice = Scribe(), Random(1)
    for _ in range(2000):
        scribe.now += dice.choice([0.1, JOIN + 0.1])
        field = dice.choice(["nu", "c"])
        scribe.change(dice.choice(["me", "you"]), **{field: dice.choice([1.0, 2.0])})
        entries = scribe.history.entries()
        assert all(edit["changes"] for edit in entries)
        if entries:
            assert scribe.history.after(entries[-1]["number"]) == scribe.experiment
        numbers = [edit["number"] for edit in entries]
        assert numbers == sorted(set(numbers))


def test_added_and_removed_lanes_are_told_whole() -> None:
    scribe = Scribe()
    patch = {"lanes": {"B": None}}
    scribe.history.note(Change(2, START.patched(patch), patch, "me"))
    (edit,) = scribe.history.entries()
    assert edit["changes"] == [{"path": ["lanes", "B"], "from": "all", "to": "none"}]
