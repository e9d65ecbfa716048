"""What a dashboard refuses, as the errors that it would have raised here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NoReturn

import httpx

from slidetune.robot.errors import FieldError, InvalidExperimentError, SlidetuneError


class DashboardError(SlidetuneError):
    """A dashboard can't be reached, or does not do what it was asked.

    Attributes:
        status: of its HTTP answer, 0 without one.
        code: for programs, such as ``watch_only``.
    """

    def __init__(self, message: str, status: int = 0, code: str = "") -> None:
        """Say why, with the HTTP status and the code where there are some."""
        super().__init__(message)
        self.status, self.code = status, code


def refuse(error: Mapping[str, Any], status: int) -> NoReturn:
    """Raise what an answer in the common format of errors says.

    Raises:
        InvalidExperimentError: where it names fields.
        DashboardError: otherwise.
    """
    fields = [
        FieldError(
            field["path"],
            field["message"],
            allowed=field.get("allowed") or "",
            line=field.get("line"),
        )
        for field in error.get("fields") or ()
    ]
    if fields:
        raise InvalidExperimentError(fields)
    raise DashboardError(error["message"], status, error["code"])


def checked(answer: httpx.Response) -> httpx.Response:
    """Return an answer that is good.

    Raises:
        InvalidExperimentError: where it names the fields that are refused.
        DashboardError: for any other refusal.
    """
    if answer.is_success:
        return answer
    try:
        error = answer.json()["error"]
        refuse(error, answer.status_code)
    except (ValueError, KeyError, TypeError) as unlike:
        if isinstance(unlike, InvalidExperimentError):
            raise
        text = f"{answer.url} answered {answer.status_code}, not as a Slidetune does"
        raise DashboardError(text, answer.status_code) from unlike
