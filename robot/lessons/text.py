"""The words of a lesson, with every number filled in from where it is pinned.

A lesson's text holds no figures of its own. ``{name}`` is a claim's number, which a test compares
with a run; ``{lanes.NFTSM.nu}`` is a value of the step's experiment, ``{was lanes.NFTSM.nu}`` of
the one before, each with its unit. So no text can say what no run shows.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from slidetune.robot.errors import FieldError, InvalidLessonError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.merge_patch import difference
from slidetune.robot.fields.quantity import Section
from slidetune.robot.lessons.claim import Claim
from slidetune.robot.lessons.figures import figures
from slidetune.robot.lessons.lesson import LoadedLesson, Step

PLACEHOLDER = re.compile(r"\{(was )?([^{}]+)\}")
_MOST_CHANGES = 4
"""Most values that a step shows as changed (*ours*): more is a new scene, not a change."""


@dataclass(frozen=True)
class Change:
    """One value that a step changes.

    Attributes:
        path: where it stands, dotted.
        label: what it is, such as ``ν of NFTSM``.
        was: the value before, in words and units.
        now: the value after.
    """

    path: str
    label: str
    was: str
    now: str


def written(value: object, unit: str = "") -> str:
    """Return a value as people write it: ``2400 N·m/s``, ``160,000 N·m/s``, ``−22.5 N·m``."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if value is None:
        return "off"
    if isinstance(value, tuple):
        return written(value[0], unit) if len(set(value)) == 1 else _list(value, unit)
    if not isinstance(value, int | float):
        return str(value)
    if unit == "mrad" and abs(value) >= 100:
        return written(value / 1000, "rad")
    text = f"{value:,.10g}" if abs(value) >= 10_000 else f"{value:.10g}"
    return text.replace("-", "−") + _with_blank(unit)


def _list(values: tuple[float, ...], unit: str) -> str:
    return ", ".join(written(value) for value in values) + _with_blank(unit)


def _with_blank(unit: str) -> str:
    """Return a unit behind a blank that doesn't break; 4 1/s would read as a sum."""
    return unit and f"\u00a0{'s⁻¹' if unit == '1/s' else unit}"


def _setting(experiment: Experiment, path: str) -> tuple[Any, Mapping[str, Any], str]:
    """Return a value, its schema record and its title.

    Args:
        experiment: where to look.
        path: dotted; a joint's share of a list is its number, from 1.

    Raises:
        KeyError: if nothing stands there.
    """
    node: Any = experiment
    extra: Mapping[str, Any] = {}
    title = path
    for part in path.split("."):
        if isinstance(node, Mapping):
            node = node[part]
        elif isinstance(node, Section) and part in type(node).model_fields:
            info = type(node).model_fields[part]
            title = info.title or part
            extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
            node = getattr(node, part)
        elif isinstance(node, tuple) and part.isdecimal() and 0 < int(part) <= len(node):
            node = node[int(part) - 1]
        else:
            raise KeyError(path)
    if isinstance(node, Mapping | Section):
        raise KeyError(path)
    return node, extra, title


def _leaves(patch: Mapping[str, Any], above: str = "") -> Iterator[str]:
    for key, value in patch.items():
        path = f"{above}.{key}" if above else key
        if isinstance(value, Mapping):
            yield from _leaves(value, path)
        else:
            yield path


def _label(path: str, extra: Mapping[str, Any], title: str) -> str:
    section, _, rest = path.partition(".")
    if section != "lanes":
        return title
    return f"{extra.get('symbol') or title} of {rest.rpartition('.')[0]}"


def changes(before: Experiment, after: Experiment) -> list[Change]:
    """Return what differs between two experiments, or nothing where that is too much to show."""
    found = []
    for path in _leaves(difference(before.document(), after.document())):
        try:
            now, extra, title = _setting(after, path)
            was = _setting(before, path)[0]
        except KeyError:
            return []
        words = [written(value, str(extra.get("unit", ""))) for value in (was, now)]
        found.append(Change(path, _label(path, extra, title), *words))
    return found if len(found) <= _MOST_CHANGES else []


class LessonText:
    """The texts of one lesson, ready to be shown."""

    def __init__(self, loaded: LoadedLesson) -> None:
        """Gather what its texts may quote."""
        self._loaded = loaded
        self._claims: dict[str, Claim] = {
            claim.name: claim for step in loaded.lesson.steps for claim in step.claims
        }

    def filled(self, index: int, text: str, field: str = "text") -> str:
        """Return a text of a step with its numbers filled in.

        Args:
            index: which step, from 0.
            text: with placeholders.
            field: where it stands in the step, for messages.

        Raises:
            InvalidLessonError: if a placeholder names nothing.
        """

        def number(match: re.Match[str]) -> str:
            try:
                return self._quoted(index, bool(match[1]), match[2])
            except KeyError as error:
                known = ", ".join(self._claims)
                message = f"{match[0]} is neither a claim nor a value. Claims: {known}"
                refused = FieldError(f"steps.{index}.{field}", message, match[0])
                raise InvalidLessonError([refused]) from error

        return PLACEHOLDER.sub(number, text)

    def _quoted(self, index: int, was: bool, name: str) -> str:
        if name in self._claims and not was:
            claim = self._claims[name]
            return written(claim.quoted, claim.unit)
        head, _, part = name.rpartition(".")
        if head in self._claims and part in ("at", "since") and not was:
            return written(getattr(self._claims[head], part), "s")
        if was and index == 0:
            raise KeyError(name)
        value, extra, _ = _setting(self._loaded.experiments[index - was], name)
        return written(value, str(extra.get("unit", "")))

    def paragraphs(self, index: int, text: str, field: str = "text") -> list[str]:
        """Return a filled text, a line each."""
        return [line for line in self.filled(index, text, field).split("\n") if line.strip()]

    def step(self, index: int) -> dict[str, Any]:
        """Return one step as plain values, its texts filled in."""
        step, loaded = self._loaded.lesson.steps[index], self._loaded
        return {
            "title": self.filled(index, step.title, "title"),
            "text": self.paragraphs(index, step.text),
            "preset": loaded.presets[index],
            "experiment": loaded.experiments[index].document(),
            "changes": [] if step.preset else self._changes(index),
            "lane": step.lane,
            "view": step.view,
            "lens": step.lens,
            "exaggeration": step.exaggeration,
            "reset": step.reset,
            "samples": step.samples,
            "figures": self._figures(step.text, index - 1 if step.question else index),
            "question": self._question(index, step),
        }

    def _figures(self, texts: str, index: int) -> list[dict[str, Any]]:
        return [asdict(figure) for figure in figures(self._loaded, texts, index)]

    def _changes(self, index: int) -> list[dict[str, str]]:
        before, after = self._loaded.experiments[index - 1 : index + 1]
        return [asdict(change) for change in changes(before, after)]

    def _question(self, index: int, step: Step) -> dict[str, Any] | None:
        question = step.question
        if question is None:
            return None
        return {
            "text": self.filled(index, question.text, "question.text"),
            "choices": [
                self.filled(index, choice, f"question.choices.{place}")
                for place, choice in enumerate(question.choices)
            ],
            "answer": question.answer,
            "explanation": self.paragraphs(index, question.explanation, "question.explanation"),
            "figures": self._figures(f"{question.text} {question.explanation} {step.text}", index),
        }
