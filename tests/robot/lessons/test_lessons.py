"""The lessons that ship: what they say is what the robot does."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, get_args

import pytest

from slidetune.robot.errors import InvalidLessonError, PresetSyntaxError, UnknownLessonError
from slidetune.robot.lenses import LENSES
from slidetune.robot.lessons.claim import METRICS, Claim, Metric, measured
from slidetune.robot.lessons.lesson import (
    Lens,
    Lesson,
    LoadedLesson,
    Question,
    Step,
    View,
    lesson_from_yaml,
    lessons,
    load_lesson,
)
from slidetune.robot.lessons.text import PLACEHOLDER, LessonText, written
from slidetune.robot.loop.figures import FIGURES
from slidetune.robot.loop.simulate import simulate

NAMES = [loaded.name for loaded in lessons()]
MOST_WORDS = 60
MANUAL = (Path(__file__).parents[3] / "docs" / "lessons.md").read_text(encoding="utf-8")

SMALL = """\
number: 1
title: Small
summary: One step.
minutes: 1
steps:
  - title: Begin
    text: It begins with {lanes.NFTSM.nu}.
    preset: paper
  - title: Go on
    text: It was {was lanes.NFTSM.nu} and is {lanes.NFTSM.nu}; {slow} is c/ν.
    patch: {lanes: {NFTSM: {nu: 30}}}
    lane: NFTSM
    question:
      text: What now?
      choices: [this, that]
      answer: 1
      explanation: That.
    claims:
      - {name: slow, lane: NFTSM, metric: time_constant, about: 0.333}
"""


def own_texts(loaded: LoadedLesson) -> list[str]:
    """Return all that a lesson says itself: no wrong guesses, whose numbers are anybody's."""
    texts = [loaded.lesson.title, loaded.lesson.summary]
    for step in loaded.lesson.steps:
        texts += [step.title, step.text]
        if step.question:
            right = step.question.choices[step.question.answer]
            texts += [step.question.text, step.question.explanation, right]
    return texts


def refused(text: str) -> dict[str, int | None]:
    """Return path and line of every value that is refused."""
    with pytest.raises(InvalidLessonError) as caught:
        LessonText(lesson_from_yaml(text))
    return {field.path: field.line for field in caught.value.fields}


def test_lessons_are_numbered_in_their_order() -> None:
    assert [loaded.lesson.number for loaded in lessons()] == list(range(1, len(NAMES) + 1))
    assert len(NAMES) >= 6


def wrong_claims(loaded: LoadedLesson) -> list[str]:
    """Simulate every step with claims; return the claims that don't hold, and what does."""
    values: dict[str, float] = {}
    wrong = []
    for step, experiment in zip(loaded.lesson.steps, loaded.experiments, strict=True):
        if not step.claims:
            continue
        shorter = {"simulation": {"horizon": step.seconds}} if step.seconds else {}
        run = simulate(experiment.patched(shorter))
        assert all(lane.freeze is None for lane in run.lanes.values()), step.title
        for claim in step.claims:
            values[claim.name] = measured(claim, run)
            value = values[claim.name] / values.get(claim.than, 1.0)
            if not claim.holds(value):
                wrong.append(f"{claim.name} is {value:.6g}, {claim.bound} {claim.quoted:g}")
    return wrong


@pytest.mark.parametrize("name", NAMES)
def test_every_claim_holds_when_it_is_simulated(name: str) -> None:
    assert wrong_claims(load_lesson(name)) == []


def test_the_manual_has_a_lesson_that_holds() -> None:
    found = re.search(r"```yaml\n(.*?)```", MANUAL, re.DOTALL)
    assert found is not None
    loaded = lesson_from_yaml(found[1])
    texts = LessonText(loaded)
    assert "33.3\u00a0s" in texts.step(0)["text"][0]
    assert texts.step(1)["question"]["explanation"]
    assert wrong_claims(loaded) == []


def test_the_manual_names_every_field_metric_and_view() -> None:
    for part in (Lesson, Step, Question, Claim):
        missing = [name for name in part.model_fields if f"| `{name}` |" not in MANUAL]
        assert missing == [], part.__name__
    for name, metric in METRICS.items():
        assert f"| `{name}` | {metric.unit}{' ' * bool(metric.unit)}|" in MANUAL
    assert [one for one in get_args(View) + get_args(Lens) if f"`{one}`" not in MANUAL] == []


@pytest.mark.parametrize("name", NAMES)
def test_every_number_in_a_text_is_filled_in(name: str) -> None:
    loaded = load_lesson(name)
    # S = 0 is the surface's name, not a figure.
    bare = [PLACEHOLDER.sub("", text).replace("S = 0", "") for text in own_texts(loaded)]
    assert [text for text in bare if re.search("[0-9]", text)] == []
    for index, step in enumerate(loaded.lesson.steps):
        shown = LessonText(loaded).step(index)
        assert not re.search("[{}]", "".join([shown["title"], *shown["text"]]))
        if step.question:
            question = shown["question"]
            texts = [question["text"], *question["choices"], *question["explanation"]]
            assert not re.search("[{}]", "".join(texts))


@pytest.mark.parametrize("name", NAMES)
def test_no_step_is_long(name: str) -> None:
    loaded = load_lesson(name)
    texts = LessonText(loaded)
    for index in range(len(loaded.lesson.steps)):
        step = texts.step(index)
        question: dict[str, Any] = step["question"] or {"explanation": []}
        for paragraphs in (step["text"], question["explanation"]):
            assert len(" ".join(paragraphs).split()) <= MOST_WORDS, step["title"]


@pytest.mark.parametrize("name", NAMES)
def test_a_question_comes_before_a_change_that_can_be_seen(name: str) -> None:
    loaded = load_lesson(name)
    asking = [step for step in loaded.lesson.steps if step.question]
    assert len(asking) >= 3
    for index, step in enumerate(loaded.lesson.steps[1:], start=1):
        changed = loaded.experiments[index] != loaded.experiments[index - 1]
        if changed and not step.question:
            assert step.claims, f"{step.title}: changes something and shows nothing"


@pytest.mark.parametrize("name", NAMES)
def test_every_figure_of_a_run_can_be_seen_beside_the_text_that_quotes_it(name: str) -> None:
    loaded = load_lesson(name)
    texts = LessonText(loaded)
    for index, step in enumerate(loaded.lesson.steps):
        shown = texts.step(index)
        figures = shown["figures"] + (shown["question"] or {"figures": []})["figures"]
        seen = {(each["metric"], each["lane"], each["joint"], each["at"]) for each in figures}
        told = step.text + (step.question.explanation if step.question else "")
        for claim in step.claims:
            if f"{{{claim.name}}}" in told and METRICS[claim.metric].label and not claim.than:
                assert (claim.metric, claim.lane, claim.joint, claim.at) in seen, claim.name


def test_an_open_question_has_no_figure_of_its_answer_beside_it() -> None:
    step = LessonText(load_lesson("chattering")).step(1)
    assert [each["lane"] for each in step["figures"]] == ["tanh"]
    assert {each["lane"] for each in step["question"]["figures"]} == {"sign", "tanh"}


@pytest.mark.parametrize("name", NAMES)
def test_no_text_says_where_on_the_screen_something_stands(name: str) -> None:
    """On a phone it stands elsewhere."""
    for text in own_texts(load_lesson(name)):
        assert not re.search(r"on the (left|right)|under the table|table below", text), text


def test_tabs_are_those_of_the_plots() -> None:
    source = Path(__file__).parents[3] / "web" / "live" / "views.js"
    assert set(get_args(View)) <= set(re.findall(r"id: '([\w-]+)', title", source.read_text()))


def test_lenses_are_those_that_there_are() -> None:
    assert set(get_args(Lens)) == set(LENSES)


def test_a_figure_of_no_joint_is_reduced_as_in_the_tables() -> None:
    """Beside a mean of six stands ``mean``, beside the greatest ``greatest``."""
    loaded = load_lesson("drive-lag")
    run = simulate(loaded.experiments[0].patched({"simulation": {"horizon": 1.0}}), estimate=False)
    figures = run.lanes["sign"].metrics_since(0.5)
    known: list[tuple[Metric, str]] = [
        ("switches", "switches"),
        ("mean_error", "mae"),
        ("peak_torque", "peak_torque"),
        ("chattering", "chattering"),
    ]
    for metric, name in known:
        claim = Claim(name="x", metric=metric, lane="sign", since=0.5, at_least=0.0)
        factor = FIGURES[name].factor
        wanted = FIGURES[name].overall(getattr(figures, name))
        assert measured(claim, run) == pytest.approx(factor * wanted), metric
    shown = LessonText(loaded).step(0)["figures"]
    assert [each["label"] for each in shown] == [
        "switches a second of sign, greatest of the joints",
        "mean |e| of tanh, mean of the joints",
    ]


def test_every_metric_can_be_worked_out() -> None:
    assert set(get_args(Metric)) == set(METRICS)


def test_metrics_that_are_figures_are_quoted_as_the_table_says() -> None:
    for name, figure in {"mean_error": "mae", "margin_limit": "gamma_limit"}.items():
        metric, entry = METRICS[name], FIGURES[figure]  # type: ignore[index]
        assert (metric.unit, metric.factor) == (entry.shown_unit, entry.factor)
        assert metric.label == entry.label
    for name in METRICS.keys() & FIGURES.keys():
        assert METRICS[name].label == FIGURES[name].label
        assert METRICS[name].factor == FIGURES[name].factor


def test_texts_are_filled_from_claims_and_experiments() -> None:
    texts = LessonText(lesson_from_yaml(SMALL))
    assert texts.step(0)["text"] == ["It begins with 0.3\u00a0s⁻¹."]
    step = texts.step(1)
    assert step["text"] == ["It was 0.3\u00a0s⁻¹ and is 30\u00a0s⁻¹; 0.333\u00a0s is c/ν."]
    assert [(c["label"], c["was"], c["now"]) for c in step["changes"]] == [
        ("ν of NFTSM", "0.3\u00a0s⁻¹", "30\u00a0s⁻¹")
    ]
    assert step["experiment"]["lanes"]["NFTSM"]["nu"] == 30
    assert step["preset"] == "paper"


@pytest.mark.parametrize(
    ("before", "after", "path", "line"),
    [
        ("preset: paper", "preset: papre", "steps.0.preset", 8),
        ("preset: paper", "view: error", "steps.0.preset", 6),
        ("nu: 30", "nu: -3", "steps.1.patch.lanes.NFTSM.nu", 11),
        ("lane: NFTSM\n    q", "lane: nobody\n    q", "steps.1.lane", 12),
        ("lane: NFTSM, m", "lane: nobody, m", "steps.1.claims.0.lane", 19),
        ("answer: 1", "answer: 2", "steps.1.question.answer", 16),
        ("answer: 1", "answr: 1", "steps.1.question.answr", 16),
        ("about: 0.333", "about: 1, at_most: 2", "steps.1.claims.0.name", 19),
        ("lane: NFTSM\n    q", "view: error\n    lens: network\n    q", "steps.1.lens", 13),
        ("metric: time_constant", "metric: error_at", "steps.1.claims.0.at", 19),
        ("metric: time_constant", "metric: luck", "steps.1.claims.0.metric", 19),
        ("about: 0.333", "about: 1, than: nobody", "steps.1.claims.0.than", 19),
    ],
)
def test_a_broken_lesson_is_refused_with_field_and_line(
    before: str, after: str, path: str, line: int
) -> None:
    assert SMALL.count(before) == 1
    found = refused(SMALL.replace(before, after))
    assert path in found
    assert found[path] == line


def test_a_text_that_quotes_nothing_known_is_refused() -> None:
    for text in ("{slwo} is", "{lanes.NFTSM.nuu} is", "{was nothing} is", "{lanes} is"):
        texts = LessonText(lesson_from_yaml(SMALL.replace("{slow} is", text)))
        with pytest.raises(InvalidLessonError, match=r"steps\.1\.text"):
            texts.step(1)


def test_what_is_no_plain_yaml_is_refused() -> None:
    with pytest.raises(PresetSyntaxError):
        lesson_from_yaml("number: &a 1")


@pytest.mark.parametrize("name", ["nobody", "../paper", "chattering.yaml", "", "\x00"])
def test_unknown_lessons_are_refused_and_list_the_known(name: str) -> None:
    with pytest.raises(UnknownLessonError, match="chattering"):
        load_lesson(name)


@pytest.mark.parametrize(
    ("bound", "yes", "no"),
    [
        ({"about": 0.98}, (0.975, 0.985), (0.974, 0.986)),
        ({"about": 500.0}, (490.0, 510.0), (487.0, 513.0)),
        ({"at_least": 3.0}, (3.0, 9.0), (2.99,)),
        ({"at_most": 3.0}, (3.0, 0.0), (3.01, float("nan"))),
    ],
)
def test_a_claim_is_as_exact_as_it_is_written(
    bound: dict[str, float], yes: tuple[float, ...], no: tuple[float, ...]
) -> None:
    claim = Claim(name="x", metric="chattering", lane="A", **bound)  # type: ignore[arg-type]
    assert all(claim.holds(value) for value in yes)
    assert not any(claim.holds(value) for value in no)


def test_numbers_are_written_as_people_write_them() -> None:
    assert written(160000.0, "N·m/s") == "160,000\u00a0N·m/s"
    assert written(-22.5, "N·m") == "−22.5\u00a0N·m"
    assert written(413.0, "mrad") == "0.413\u00a0rad"
    assert written((1.0, 1.0, 1.0), "kg") == "1\u00a0kg"
    assert written((4.0, 2.5)) == "4, 2.5"
    assert (written(True), written(None), written("tanh")) == ("yes", "off", "tanh")
