"""What a running server says of its lanes when a law doesn't play along."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import pytest

from slidetune.robot.laws import LAWS
from tests.server.conftest import Served


def until_metrics_of(served: Served, lane: str) -> dict[str, Any]:
    """Return the figures of all lanes once the session has taken a new one."""
    end = time.monotonic() + 30.0
    while True:
        told: dict[str, Any] = served.http.get("/api/metrics").raise_for_status().json()["lanes"]
        if lane in told:
            return told
        assert time.monotonic() < end, f"no figures of {lane}"
        time.sleep(0.02)


@pytest.mark.parametrize("mode", ["continuous", "sampled"])
def test_a_law_that_fails_has_no_remarks_and_the_others_have_theirs(
    mode: str, served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*given: object) -> None:
        raise ArithmeticError("no torque for this pose")

    monkeypatch.setitem(LAWS, "smc", replace(LAWS["smc"], control=fail))
    lanes = {"fails": {"law": "smc"}, "torque": {"law": "rbfnn_nftsm", "k1": 300.0}}
    document = {"lanes": lanes, "simulation": {"mode": mode}, "robot": {"torque_limit": 5.0}}
    served.http.put("/api/experiment", json=document).raise_for_status()
    told = until_metrics_of(served, "fails")
    assert (told["fails"]["gamma"], told["fails"]["notes"]) == (None, [])
    assert told["torque"]["notes"]
    assert served.http.get("/api/session").json()["playing"]
