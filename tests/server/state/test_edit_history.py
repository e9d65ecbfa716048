"""Who changed what, and the way back."""

from __future__ import annotations

from typing import Any

from slidetune.robot.experiment.document import Experiment
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


def test_added_and_removed_lanes_are_told_whole() -> None:
    scribe = Scribe()
    patch = {"lanes": {"B": None}}
    scribe.history.note(Change(2, START.patched(patch), patch, "me"))
    (edit,) = scribe.history.entries()
    assert edit["changes"] == [{"path": ["lanes", "B"], "from": "all", "to": "none"}]
