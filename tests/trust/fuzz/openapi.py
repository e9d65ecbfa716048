"""Schemathesis against a real server: every route after the server's own OpenAPI document."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from tests.trust.fuzz.verdict import Fault, Tally

CHECKS = (
    "not_a_server_error",
    "status_code_conformance",
    "content_type_conformance",
    "response_headers_conformance",
    "response_schema_conformance",
    "negative_data_rejection",
    "missing_required_header",
    "unsupported_method",
    "allow_header_conformance",
)
"""All that can be asked of routes whose answer depends on what is live: whether a lane of a name
exists, and whether two gains go together, no schema of one request can say."""
SHORT = {
    "lanes": {"RBFNN-NFTSM": {"law": "rbfnn_nftsm"}, "NFTSM": {"law": "nftsm"}},
    "simulation": {"horizon": 0.2, "step": 0.002},
}
"""What is live meanwhile: the lanes that the document's examples speak of, at little cost."""
_PHASES = "examples,coverage,fuzzing"


def run_schemathesis(port: int, seed: int, examples: int) -> Tally:
    """Let Schemathesis try every route of the server at ``port``; answers are in the one shape.

    Args:
        port: of this machine.
        seed: same seed, same requests.
        examples: most random requests to one route.

    Raises:
        RuntimeError: with its last words, if it could not run at all.
    """
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        command = [
            sys.executable, "-m", "schemathesis.cli", "run", f"http://127.0.0.1:{port}/openapi.json",
            "--seed", str(seed), "--max-examples", str(examples), "--phases", _PHASES,
            "--checks", ",".join(CHECKS), "--continue-on-failure", "--request-timeout", "60",
            "--suppress-health-check", "all", "--no-color", "--report", "json",
            "--report-json-path", str(report),
        ]  # fmt: skip
        done = subprocess.run(
            command, cwd=folder, capture_output=True, encoding="utf-8", check=False
        )
        if not report.is_file():
            raise RuntimeError(
                f"schemathesis did not run: {done.stdout[-800:]}{done.stderr[-800:]}"
            )
        return _tally(json.loads(report.read_text("utf-8")), done.stdout)


def _tally(report: dict[str, Any], said: str) -> Tally:
    cases = report["test_cases"]
    tally = Tally(accepted=cases["generated"] - cases["with_failures"] - cases["errored"])
    for failure in report["failures"]:
        where = ", ".join(failure["operations"])
        tally.add(Fault(f"{failure['title']}: {where}"[:120], _part(said, where), where))
    for error in report["errors"]:
        tally.add(Fault(error["title"], said[-1500:], "", error["count"]))
    if not report["complete"] or report["operations"]["tested"] != report["operations"]["total"]:
        tally.add(Fault("not every route was tried", str(report["operations"]), ""))
    return tally


def _part(said: str, operation: str) -> str:
    """Return what was printed of one route."""
    place = said.find(f"_ {operation.split(', ')[0]} _")
    return said[max(0, place) :][:1500]
