"""JSON is read as it is defined, and what isn't JSON is refused with its place."""

from __future__ import annotations

import math

import pytest

from slidetune.server.guard.plain_json import NotJsonError, read_json


def test_json_is_read() -> None:
    text = '{"a": [1, -2.5e3, null, true, "ν"]}'
    assert read_json(text) == read_json(text.encode()) == {"a": [1, -2500.0, None, True, "ν"]}


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("", "line 1, character 1"),
        ('{"a": 1,\n "b" 2}', "line 2, character 6"),
        ("[1, 2", "line 1, character 6"),
        ("[NaN]", "NaN"),
        ("-Infinity", "Infinity"),
        (b'"\xff"', "UTF-8"),
        ("[" * 100_000, "deep"),
    ],
)
def test_what_is_not_json_is_refused_with_its_place(text: str | bytes, place: str) -> None:
    with pytest.raises(NotJsonError, match="JSON") as caught:
        read_json(text)
    assert place in str(caught.value)


def test_a_number_too_large_for_anything_is_infinite() -> None:
    assert read_json("[1e999, 1" + "0" * 5000 + ", -1" + "0" * 5000 + "]") == [
        math.inf,
        math.inf,
        -math.inf,
    ]
