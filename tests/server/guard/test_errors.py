"""An error can always be sent, whatever it repeats."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from slidetune.server.guard.errors import LONGEST_MESSAGE, LONGEST_TEXT, error_body


@pytest.mark.parametrize("value", [math.nan, math.inf, "\ud800", "x" * 10**6, None, 3])
def test_an_error_is_strict_json_of_bounded_length(value: Any) -> None:
    text = str(value)
    body = error_body("invalid", text, [{"path": text, "message": text, "value": value}])
    sent = json.dumps(body, allow_nan=False, ensure_ascii=False).encode()
    assert len(sent) < LONGEST_MESSAGE + 3 * LONGEST_TEXT + 200


def test_short_texts_and_numbers_are_told_as_they_are() -> None:
    field = {"path": "nu", "message": "ν < 0", "value": -1.5, "line": 3}
    body = error_body("invalid", "ν", [field])
    assert body == {"error": {"code": "invalid", "message": "ν", "fields": [field]}}
