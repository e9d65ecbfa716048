"""What is said of studies that are kept: what is wanted, how far they are, what they show."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, Field

from slidetune.robot.study.study import Kind
from slidetune.server.contract.messages import Strict


class NewStudy(Strict):
    """A study to be run."""

    kind: Kind = Field(
        description="`tune`: search for gains; `robustness`: draws of what is uncertain; `worst`: "
        "search for the worst draw; `sweep`: values of one or two fields."
    )
    wanted: dict[str, Any] = Field(
        {},
        examples=[{"lane": "RBFNN-NFTSM", "trials": 200}],
        description="What a study of its kind is told; whatever is left out has its default. "
        "`GET /api/studies/kinds` describes the fields.",
    )
    title: str = Field("", max_length=200, description="What people call it.")
    experiment: dict[str, Any] | None = Field(
        None, description="A whole experiment; `null`: the live one, as it is now."
    )


class StudySummary(BaseModel):
    """A study, and how far it is."""

    id: int = Field(description="Its number.")
    kind: Kind
    lane: str
    title: str
    created: float = Field(description="When it was begun, in seconds since 1970.")
    version: str = Field(description="Version of the program that began it.")
    state: Literal["waiting", "running", "stopped", "done", "failed"]
    message: str = Field(description="Why it failed.")
    total: int = Field(description="Entries that it has once it is done.")
    made: int = Field(description="Entries that there are.")
    seconds_left: float | None = Field(description="How long it will still take, where known [s].")
    tasks_done: int = Field(
        description="Tasks of a few runs each that have ended since this server goes on with it: a "
        "sign of life, as entries may come several at a time."
    )


class StudyList(BaseModel):
    """All studies that are kept."""

    studies: list[StudySummary] = Field(description="The newest first.")


class StudyAnswer(StudySummary):
    """A study, whole but for its entries."""

    wanted: dict[str, Any]
    experiment: dict[str, Any]
    result: dict[str, Any] = Field(
        description="What its entries show so far. `tune`: `present`, `best`, `front` (numbers of "
        "trials), `importance` and `correlations`; `robustness`: `quantiles`, `diverged`, `kept`; "
        "`worst`: `worst_found`, which is no proof that there is none worse; `sweep`: `axes`."
    )


class StudyEntries(BaseModel):
    """Entries of a study: trials, draws or points."""

    first: int
    entries: list[dict[str, Any]]


class StudyBands(BaseModel):
    """Within what the responses of a study's draws lie."""

    draws: int
    time: list[float] = Field(description="Middle of each piece of the horizon [s].")
    curves: dict[str, dict[str, list[float | None]]] = Field(
        description="`e1` to `e6` [rad], `tau1` to `tau6` [N·m], `flange_error` [m]: `low` and "
        "`high` (nine tenths of the draws lie between), `median`, `least`, `greatest`; `null` "
        "where it is a draw that left its bounds."
    )


class Acceptance(Strict):
    """Gains to be used from now on, as long as they hold."""

    lane: str = Field(examples=["RBFNN-NFTSM"])
    patch: dict[str, Any] = Field(
        examples=[{"lanes": {"RBFNN-NFTSM": {"nu": 30}}}],
        description="Merge patch of this lane and nothing else.",
    )
    client: str = Field("", max_length=100, description="Who asks: its id on the live WebSocket.")


class Accepting(BaseModel):
    """Gains that were accepted."""

    accepted: Literal[True] = True
    revision: int
    seconds: float = Field(
        description="For so long, in simulated time, they go back by themselves if a hard goal is "
        "left; a `notice` on the live WebSocket says so."
    )
    watched: list[str] = Field(description="Hard goals that are watched.")
    unwatched: list[str] = Field(description="Hard goals that the live session can't measure.")


class Replayed(BaseModel):
    """Two runs that the 3D scene shows in place of the live session."""

    seconds: float = Field(description="For so long; then the live session is shown again.")
