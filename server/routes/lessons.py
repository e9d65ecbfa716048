"""Lessons over HTTP: the list, and one lesson with every step's experiment."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter
from pydantic import BaseModel, Field

from slidetune.robot.lessons.lesson import Lens, LoadedLesson, View, lessons, load_lesson
from slidetune.robot.lessons.text import LessonText
from slidetune.robot.loop.figures import Reduction
from slidetune.server.contract.messages import ErrorAnswer

_UNKNOWN: dict[int | str, dict[str, Any]] = {404: {"model": ErrorAnswer}}


class LessonSummary(BaseModel):
    """One lesson in a list."""

    name: str = Field(examples=["chattering"])
    title: str
    summary: str
    minutes: int
    steps: int = Field(description="How many.")


class LessonList(BaseModel):
    """All lessons in their order."""

    lessons: list[LessonSummary]


class LessonFigure(BaseModel):
    """One quoted figure, and what to measure in the live session beside it."""

    label: str
    window: str = Field(description="Time span, in words.")
    quoted: str
    unit: str
    factor: float = Field(description="From SI units to `unit`.")
    metric: str
    lane: str
    joint: int | None = Field(description="null: all of them.")
    reduced: Reduction = Field(description="What all of them become; none: it has no joint.")
    since: float
    until: float
    at: float | None
    layer: list[float] = Field(description="|S| within which S = 0 counts as reached [rad/s].")
    high_frequency: float = Field(description="Above which torque counts as chattering [Hz].")


class LessonQuestion(BaseModel):
    """A prediction to make before the step's change is applied."""

    text: str
    choices: list[str]
    answer: int = Field(description="Index of the right choice, counted from 0.")
    explanation: list[str] = Field(description="Paragraphs.")
    figures: list[LessonFigure] = Field(description="Those of text and explanation, answered.")


class LessonChange(BaseModel):
    """One value that a step changes, in words and units."""

    path: str
    label: str
    was: str
    now: str


class LessonStep(BaseModel):
    """One step; its experiment acts on entering it, or once its question is answered."""

    title: str
    text: list[str] = Field(description="Paragraphs.")
    preset: str = Field(description="Where the experiment comes from.")
    experiment: dict[str, Any] = Field(description="What the step is about, whole.")
    changes: list[LessonChange]
    figures: list[LessonFigure] = Field(description="Those of the text, before any answer.")
    lane: str = Field(description="Lane to select; empty: keep the selection.")
    view: View | None = Field(description="Tab of the plots to open.")
    lens: Lens | None = Field(description="Lens to open instead.")
    exaggeration: float | None
    reset: bool = Field(description="Whether time starts again at 0.")
    samples: int = Field(description="Freeze the plots on this many samples; 0: follow the newest.")
    question: LessonQuestion | None


class LessonAnswer(BaseModel):
    """One complete lesson, with all numbers filled in."""

    name: str
    title: str
    summary: str
    minutes: int
    steps: list[LessonStep]


def _head(loaded: LoadedLesson) -> dict[str, Any]:
    lesson = loaded.lesson
    return {
        "name": loaded.name,
        "title": lesson.title,
        "summary": lesson.summary,
        "minutes": lesson.minutes,
    }


def lessons_router() -> APIRouter:
    """Return the routes of the lessons."""
    router = APIRouter(prefix="/api/lessons", tags=["lessons"])

    @router.get("", response_model=LessonList)
    def all_lessons() -> dict[str, Any]:
        """All lessons, in the order in which they build on each other."""
        known = [{**_head(loaded), "steps": len(loaded.lesson.steps)} for loaded in lessons()]
        return {"lessons": known}

    @router.get("/{name}", response_model=LessonAnswer, responses=_UNKNOWN)
    def one_lesson(name: str) -> dict[str, Any]:
        """One lesson: its steps, their texts and the experiment of each."""
        loaded = load_lesson(name)
        texts = LessonText(loaded)
        steps = [texts.step(index) for index in range(len(loaded.lesson.steps))]
        return {**_head(loaded), "steps": steps}

    return router
