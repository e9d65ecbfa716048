"""Reads JSON as it is defined: no NaN, and no text that breaks the reader."""

from __future__ import annotations

import json
import math
from typing import Any, NoReturn

_DIGITS = 400
"""Digits of a whole number beyond which no float holds it (*ours*; Python stops at 4300)."""


class NotJsonError(ValueError):
    """A text that isn't JSON; says where."""


def read_json(text: str | bytes) -> Any:
    """Return what a JSON text holds; a whole number too large for anything is infinity.

    Raises:
        NotJsonError: naming the place.
    """
    try:
        return json.loads(text, parse_constant=_constant, parse_int=_integer)
    except json.JSONDecodeError as error:
        place = f"line {error.lineno}, character {error.colno}"
        raise NotJsonError(f"isn't valid JSON: something is wrong or missing at {place}") from error
    except UnicodeError as error:
        raise NotJsonError("isn't valid JSON: it must be text in UTF-8") from error
    except RecursionError as error:
        raise NotJsonError("isn't readable JSON: it is nested too deeply") from error


def _constant(name: str) -> NoReturn:
    raise NotJsonError(f"isn't valid JSON: {name} is not a JSON number")


def _integer(digits: str) -> int | float:
    return int(digits) if len(digits) <= _DIGITS else math.copysign(math.inf, float(digits))
