"""Reads the plain part of YAML 1.2 (mappings, lists, numbers, text) and where each key stands.

What no preset needs (anchors, tags, merge keys, further documents, deep nesting) is refused while
the text is scanned, before anything is built: no text is costly, and none can name a Python object.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    DocumentEndEvent,
    DocumentStartEvent,
    MappingEndEvent,
    MappingStartEvent,
    NodeEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
    StreamEndEvent,
)
from ruamel.yaml.reader import ReaderError

from slidetune.robot.errors import FieldError, PresetSyntaxError
from slidetune.robot.fields.field_path import field_path, path_parts
from slidetune.robot.fields.plain_values import DEEPEST, LONGEST_KEY, MOST_VALUES

LARGEST_TEXT = 64 * 1024
"""Most bytes of a text (*ours*); the largest shipped preset has 10 KiB."""
LONGEST_NUMBER = 40

_NULL = re.compile(r"~|null|Null|NULL|")
_TRUE = re.compile(r"true|True|TRUE")
_FALSE = re.compile(r"false|False|FALSE")
_INTEGER = re.compile(r"[-+]?(0|[1-9][0-9]*)")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|(0|[1-9][0-9]*)(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
# What YAML 1.1 and 1.2, or a reader and its author, take for different things: ``no``, 010, 1_000,
# 0x10, 1:30.
_AMBIGUOUS = re.compile(
    r"(?i:y|n|yes|no|on|off|[-+]?nan|[-+]?inf(inity)?)"
    r"|[-+]?0[0-9box_][0-9a-fA-F_.]*|[-+]?[0-9][0-9,]*[_:,][0-9_:.,]*"
)
# The parser writes what it found as a tuple of one.
_SOLE = re.compile(r"\(('<[^>]*>'),\)")
_NO_CHARACTER = re.compile(r"\\U(?!0010|000)[0-9a-fA-F]{8}")
_PARSER_FAILURES = (YAMLError, ValueError, LookupError, TypeError, AttributeError, AssertionError)


@dataclass(frozen=True)
class PlainDocument:
    """A mapping read from YAML.

    Attributes:
        values: the mapping, of plain JSON values.
        lines: line of every key and list item, counted from 1, by its dotted path.
    """

    values: dict[str, Any]
    lines: dict[str, int]

    def line(self, path: str) -> int | None:
        """Return the line of a dotted path, or of the nearest key around it."""
        parts = path_parts(path)
        while parts and field_path(parts) not in self.lines:
            parts = parts[:-1]
        return self.lines.get(field_path(parts))


def read_plain_yaml(text: str | bytes) -> PlainDocument:
    """Read one YAML document whose top is a mapping.

    Args:
        text: at most 64 KiB of UTF-8.

    Raises:
        PresetSyntaxError: with the line, for anything that isn't plain.
    """
    content = _decoded(text)
    try:
        return _Builder(_bounded(YAML(typ="safe", pure=True).parse(content))).document()
    except PresetSyntaxError:
        raise
    # Built-in errors too: the parser lets a few of them out on damaged text.
    except _PARSER_FAILURES as error:
        line, problem = _described(error, content)
        raise _refused(f"not YAML: {problem}", line) from error


def is_plain_text(text: str) -> bool:
    """Whether ``text`` would be read back as itself if it stood there without quotes."""
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]*", text) or _AMBIGUOUS.fullmatch(text):
        return False
    return not any(kind.fullmatch(text) for kind in (_NULL, _TRUE, _FALSE))


def _refused(message: str, line: int | None, path: str = "") -> PresetSyntaxError:
    return PresetSyntaxError([FieldError(path, message, line=line)])


def _bounded(events: Iterator[Any]) -> Iterator[Any]:
    """Pass the parser's events on, as long as there aren't too many; it scans no further then."""
    for count, event in enumerate(events):
        if count >= MOST_VALUES:
            text = (
                f"contains more than {MOST_VALUES} keys, values and lists: no experiment needs "
                "so many"
            )
            raise _refused(text, event.start_mark.line + 1)
        yield event


def _decoded(text: str | bytes) -> str:
    # Before encoding: a text of many megabytes shouldn't be copied just to be refused.
    if len(text) > LARGEST_TEXT:
        raise _refused(f"must be at most {LARGEST_TEXT // 1024} KiB of text", None)
    try:
        content = text.encode() if isinstance(text, str) else bytes(text)
        decoded = content.decode("utf-8-sig")
    except UnicodeError as error:
        raise _refused("must be text in UTF-8", None) from error
    if len(content) > LARGEST_TEXT:
        raise _refused(f"must be at most {LARGEST_TEXT // 1024} KiB of text", None)
    return decoded


def _described(error: Exception, content: str) -> tuple[int | None, str]:
    if isinstance(error, MarkedYAMLError):
        mark = error.problem_mark or error.context_mark
        problem = " ".join(part for part in (error.context, error.problem) if part)
        plain = _SOLE.sub(r"\1", problem.replace("\n", " "))
        return (None if mark is None else mark.line + 1), plain[:200]
    if isinstance(error, ReaderError):
        return content.count("\n", 0, error.position) + 1, "contains a character that YAML forbids"
    if escape := _NO_CHARACTER.search(content):
        line = content.count("\n", 0, escape.start()) + 1
        return line, f"{escape.group()} is not a character"
    return None, "the text is damaged"


def _number(text: str, line: int, path: str) -> int | float:
    number: int | float
    if len(text) > LONGEST_NUMBER:
        raise _refused(f"a number has at most {LONGEST_NUMBER} characters", line, path)
    number = int(text) if _INTEGER.fullmatch(text) else float(text)
    if not isfinite(number):
        raise _refused(f"must be a finite number, got {text}", line, path)
    return number


def _resolved(event: ScalarEvent, path: str) -> Any:
    """Return what a scalar stands for under YAML 1.2's core schema."""
    text, line = str(event.value), event.start_mark.line + 1
    if event.style is not None:
        return text
    if _NULL.fullmatch(text):
        return None
    if _TRUE.fullmatch(text) or _FALSE.fullmatch(text):
        return text[0] in "tT"
    if _FLOAT.fullmatch(text):
        return _number(text, line, path)
    if _NOT_FINITE.fullmatch(text):
        raise _refused(f"must be a finite number, got {text}", line, path)
    if _AMBIGUOUS.fullmatch(text):
        way_out = "write true, false, null or a plain decimal number, or put it in quotes"
        raise _refused(f"{text[:LONGEST_NUMBER]} is ambiguous in YAML: {way_out}", line, path)
    return text


class _Builder:
    """Builds plain values from the parser's events, one pass, refusing as early as it can."""

    def __init__(self, events: Iterator[Any]) -> None:
        self._events = events
        self._lines: dict[str, int] = {}

    def document(self) -> PlainDocument:
        next(self._events)
        start = next(self._events)
        if isinstance(start, StreamEndEvent):
            raise _refused("is empty: an experiment is a mapping of keys to values", None)
        if isinstance(start, DocumentStartEvent) and (start.version or start.tags):
            raise _refused("directives such as %YAML and %TAG are not allowed", 1)
        top = next(self._events)
        if not isinstance(top, MappingStartEvent):
            line = top.start_mark.line + 1
            raise _refused("must be a mapping of keys to values at the top level", line)
        values = self._value(top, "", 1)
        self._expect_end()
        return PlainDocument(values, self._lines)

    def _expect_end(self) -> None:
        for event in self._events:
            if not isinstance(event, DocumentEndEvent | StreamEndEvent):
                line = event.start_mark.line + 1
                raise _refused("contains more than one document: keep one", line)

    def _value(self, event: NodeEvent, path: str, depth: int) -> Any:
        line = event.start_mark.line + 1
        if isinstance(event, AliasEvent) or event.anchor is not None:
            raise _refused("anchors & and aliases * are not allowed: repeat the value", line, path)
        if (tag := getattr(event, "tag", None)) is not None:
            raise _refused(f"tags are not allowed: remove {str(tag)[:60]}", line, path)
        if isinstance(event, ScalarEvent):
            return _resolved(event, path)
        if depth > DEEPEST:
            raise _refused(f"is nested deeper than {DEEPEST} levels", line)
        if isinstance(event, SequenceStartEvent):
            return self._list(path, depth)
        return self._mapping(path, depth)

    def _list(self, path: str, depth: int) -> list[Any]:
        items: list[Any] = []
        while not isinstance(event := next(self._events), SequenceEndEvent):
            place = f"{path}.{len(items)}"
            self._lines[place] = event.start_mark.line + 1
            items.append(self._value(event, place, depth + 1))
        return items

    def _mapping(self, path: str, depth: int) -> dict[str, Any]:
        values: dict[str, Any] = {}
        while not isinstance(event := next(self._events), MappingEndEvent):
            line = event.start_mark.line + 1
            key = self._key(event, path)
            place = f"{path}.{field_path([key])}" if path else field_path([key])
            if key in values:
                first = self._lines[place]
                raise _refused(f"appears twice, first in line {first}: remove one", line, place)
            self._lines[place] = line
            values[key] = self._value(next(self._events), place, depth + 1)
        return values

    def _key(self, event: NodeEvent, path: str) -> str:
        line = event.start_mark.line + 1
        if not isinstance(event, ScalarEvent | AliasEvent):
            raise _refused("a key must be text, not a list or a mapping", line, path)
        key = self._value(event, path, 1)
        if not isinstance(key, str) or not key:
            written = str(getattr(event, "value", ""))[:LONGEST_NUMBER]
            given = f"put {written} in quotes" if written else "it is empty"
            raise _refused(f"a key must be text: {given}", line, path)
        if key == "<<":
            raise _refused("merge keys (<<) are not allowed: write the values out", line, path)
        if len(key) > LONGEST_KEY:
            raise _refused(f"a key has at most {LONGEST_KEY} characters", line, path)
        return key
