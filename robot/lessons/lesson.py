"""Lessons: short steps, each an experiment, a prediction and what a run of it shows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, ValidationError, model_validator

from slidetune.robot.errors import (
    FieldError,
    InvalidExperimentError,
    InvalidLessonError,
    UnknownLessonError,
    unknown_lane,
)
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.plain_yaml import LARGEST_TEXT, PlainDocument, read_plain_yaml
from slidetune.robot.experiment.presets import SHIPPED_FOLDER, load_preset
from slidetune.robot.fields.quantity import Section, refusal
from slidetune.robot.fields.refusal import field_errors
from slidetune.robot.lessons.claim import Claim

MOST_EXAGGERATION = 50.0
"""Greatest factor by which deviations from the desired arm are enlarged (*ours*)."""
LESSON_FOLDER = SHIPPED_FOLDER / "lessons"
"""Beside the presets that ship, in a checkout and in an installed wheel alike."""

View = Literal[
    "error",
    "tracking",
    "velocity",
    "torque",
    "surface",
    "network",
    "flange",
    "flange-error",
    "spectrum",
]
Lens = Literal["sliding", "network", "chattering", "prediction"]


class Question(Section):
    """A prediction to be made before the step's change is."""

    text: str = Field(min_length=1, max_length=300)
    choices: tuple[str, ...] = Field(min_length=2, max_length=5)
    answer: int = Field(ge=0, description="Place of the right choice, counted from 0.")
    explanation: str = Field(min_length=1, max_length=600)

    @model_validator(mode="after")
    def _answer_is_a_choice(self) -> Question:
        if self.answer >= len(self.choices):
            last = len(self.choices) - 1
            text = f"answer must be one of the choices, 0 to {last}, got {self.answer}"
            raise refusal("answer", self.answer, text)
        return self


class Step(Section):
    """One step of a lesson.

    Its preset and patch act on entering it; where it asks a question, once that is answered.
    """

    title: str = Field(min_length=1, max_length=80)
    text: str = Field(min_length=1, max_length=600, description="Paragraphs, a line each.")
    preset: str = Field("", description="Begin with this preset; empty: go on from the last step.")
    patch: dict[str, Any] = Field({}, description="JSON Merge Patch to what was before.")
    lane: str = Field("", description="Lane to select; empty: leave it.")
    view: View | None = Field(None, description="Tab of the plots to open.")
    lens: Lens | None = Field(None, description="Lens to open instead.")
    exaggeration: float | None = Field(None, ge=1.0, le=MOST_EXAGGERATION)
    reset: bool = Field(False, description="Whether time starts again at 0.")
    samples: int = Field(
        0, ge=0, le=1000, description="Hold the plots on so many samples; 0: follow the newest."
    )
    seconds: float | None = Field(None, gt=0.0, description="Length of the claims' run [s].")
    question: Question | None = None
    claims: tuple[Claim, ...] = ()

    @model_validator(mode="after")
    def _one_thing_is_opened(self) -> Step:
        if self.view and self.lens:
            text = f"a step opens a view or a lens, got {self.view} and {self.lens}"
            raise refusal("lens", self.lens, text)
        return self


class Lesson(Section):
    """A lesson: the document behind its YAML file."""

    number: int = Field(ge=1, description="Place among the lessons.")
    title: str = Field(min_length=1, max_length=80)
    summary: str = Field(min_length=1, max_length=300)
    minutes: int = Field(ge=1, le=60, description="How long it takes.")
    steps: tuple[Step, ...] = Field(min_length=1, max_length=20)

    @model_validator(mode="after")
    def _first_step_sets_the_scene(self) -> Lesson:
        first = self.steps[0]
        if not first.preset:
            raise refusal("steps.0.preset", "", "the first step needs a preset to start from")
        if first.question:
            text = (
                "the first step can't ask a question: there is nothing on the screen yet to "
                "predict from"
            )
            raise refusal("steps.0.question", first.question.text, text)
        return self

    @model_validator(mode="after")
    def _claims_have_their_own_names(self) -> Lesson:
        known: set[str] = set()
        for index, step in enumerate(self.steps):
            for place, claim in enumerate(step.claims):
                path = f"steps.{index}.claims.{place}"
                if claim.name in known:
                    text = f"name {claim.name} appears twice in the lesson"
                    raise refusal(f"{path}.name", claim.name, text)
                if claim.than and claim.than not in known:
                    text = f"than needs an earlier claim, got {claim.than}"
                    raise refusal(f"{path}.than", claim.than, text)
                known.add(claim.name)
        return self


@dataclass(frozen=True)
class LoadedLesson:
    """A lesson with its experiments, all of them valid.

    Attributes:
        name: its file's name without the ending.
        lesson: its document.
        experiments: the experiment of every step, changes of earlier steps included.
        presets: the preset from which every step's experiment comes.
    """

    name: str
    lesson: Lesson
    experiments: tuple[Experiment, ...]
    presets: tuple[str, ...]


def _experiments(
    lesson: Lesson, preset: Callable[[str], Experiment]
) -> tuple[tuple[Experiment, ...], tuple[str, ...]]:
    """Return every step's experiment and the preset it comes from.

    Raises:
        InvalidLessonError: naming the step's field.
    """
    experiments: list[Experiment] = []
    presets: list[str] = []
    for index, step in enumerate(lesson.steps):
        try:
            before = preset(step.preset) if step.preset else experiments[-1]
        except KeyError as error:
            fields = [FieldError(f"steps.{index}.preset", str(error), step.preset)]
            raise InvalidLessonError(fields) from error
        try:
            experiments.append(before.patched(step.patch))
        except InvalidExperimentError as error:
            path = f"steps.{index}.patch"
            fields = [replace(field, path=f"{path}.{field.path}") for field in error.fields]
            raise InvalidLessonError(fields) from error
        presets.append(step.preset or presets[-1])
        _check_lanes(index, step, experiments[-1])
    return tuple(experiments), tuple(presets)


def _check_lanes(index: int, step: Step, experiment: Experiment) -> None:
    named = {f"steps.{index}.claims.{i}.lane": claim.lane for i, claim in enumerate(step.claims)}
    if step.lane:
        named[f"steps.{index}.lane"] = step.lane
    wrong = [
        unknown_lane(path, lane, experiment.lanes)
        for path, lane in named.items()
        if lane not in experiment.lanes
    ]
    if wrong:
        raise InvalidLessonError(wrong)


def _built(document: PlainDocument, name: str) -> LoadedLesson:
    try:
        lesson = Lesson.model_validate(document.values)
    except ValidationError as error:
        raise InvalidLessonError(field_errors(error, Lesson)) from error
    experiments, presets = _experiments(lesson, load_preset)
    return LoadedLesson(name, lesson, experiments, presets)


def lesson_from_yaml(text: str | bytes, name: str = "") -> LoadedLesson:
    """Read a lesson and build every step's experiment.

    Args:
        text: at most 64 KiB of UTF-8, one plain mapping.
        name: its name.

    Raises:
        PresetSyntaxError: when the text isn't a plain YAML mapping.
        InvalidLessonError: naming every refused field with its line.
    """
    document = read_plain_yaml(text)
    try:
        return _built(document, name)
    except InvalidLessonError as error:
        located = [replace(field, line=document.line(field.path)) for field in error.fields]
        raise InvalidLessonError(located) from error


@lru_cache(maxsize=32)
def _parsed(content: bytes, name: str) -> LoadedLesson:
    return lesson_from_yaml(content, name)


def _read(path: Path) -> LoadedLesson:
    with path.open("rb") as file:
        return _parsed(file.read(LARGEST_TEXT + 1), path.stem)


def lessons(folder: Path = LESSON_FOLDER) -> list[LoadedLesson]:
    """Return all lessons in their order.

    Raises:
        InvalidLessonError: if a file is broken; all of them ship with the program.
    """
    return sorted(map(_read, folder.glob("*.yaml")), key=lambda loaded: loaded.lesson.number)


def load_lesson(name: str, folder: Path = LESSON_FOLDER) -> LoadedLesson:
    """Return the lesson of a name; never a file outside the folder.

    Raises:
        UnknownLessonError: listing the known ones.
        InvalidLessonError: if its file is broken.
    """
    known = {path.stem: path for path in sorted(folder.glob("*.yaml"))}
    if name not in known:
        text = f"no lesson {name[:60]!r}. Known: {', '.join(known)}"
        raise UnknownLessonError(text)
    return _read(known[name])
