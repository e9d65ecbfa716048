"""Tables of studies: a missed bound is told from one that is just met."""

from __future__ import annotations

import pytest

from slidetune.server.report.run_report import NONE
from slidetune.server.report.study_report import ratio_text


@pytest.mark.parametrize("digits", [3, 4])
@pytest.mark.parametrize("ratio", [0.5, 0.99996, 1.0, 1.002, 1.00002, 1.000000001, 12.34])
def test_a_missed_bound_never_reads_as_one_that_is_met(ratio: float, digits: int) -> None:
    text = ratio_text(ratio, digits)
    if ratio <= 1.0:
        assert float(text) <= 1.0
    else:
        assert text == "> 1" or float(text) > 1.0


def test_a_ratio_that_cannot_be_told_is_a_dash() -> None:
    assert ratio_text(None) == NONE
