"""Every route after the server's own OpenAPI document, tried by Schemathesis.

``make fuzz`` tries more, and from another process.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from hypothesis.errors import Unsatisfiable
from schemathesis import APIOperation, GenerationMode
from schemathesis.specs.openapi.checks import positive_data_acceptance

from slidetune.robot.experiment.document import Experiment
from tests.server.conftest import LANES, Served, serving

Route = APIOperation[Any, Any, Any, Any]
SHORT = {"lanes": LANES, "simulation": {"horizon": 0.2, "step": 0.002}}


@pytest.fixture(scope="module")
def described(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """Start a server of its own: what is tried here changes whatever it can."""
    with serving(tmp_path_factory.mktemp("presets")) as served:
        served.app_state.document.replace(Experiment.from_document(SHORT))
        yield served


@pytest.fixture(scope="module")
def api(described: Served) -> Any:
    """Return what the document describes."""
    return schemathesis.openapi.from_url(f"{described.url}/openapi.json")


@settings(
    max_examples=6,
    deadline=None,
    derandomize=True,
    database=None,
    phases=(Phase.explicit, Phase.generate),
    suppress_health_check=list(HealthCheck),
)
@given(st.data())
def tried(
    operation: APIOperation[Any, Any, Any, Any], mode: GenerationMode, data: st.DataObject
) -> None:
    """Send requests to one route, right or wrong ones."""
    case = data.draw(operation.as_strategy(generation_mode=mode))
    # Whether a lane of a name exists, and whether two gains go together, no schema can say.
    case.call_and_validate(excluded_checks=[positive_data_acceptance], timeout=60)


@pytest.mark.parametrize("mode", list(GenerationMode))
def test_every_route_answers_as_it_is_documented(api: Any, mode: GenerationMode) -> None:
    operations = [result.ok() for result in api.get_all_operations()]
    assert len(operations) >= 25
    for operation in operations:
        try:
            tried(operation, mode)
        except Unsatisfiable:
            assert mode is GenerationMode.NEGATIVE  # a route that takes nothing takes nothing wrong


def test_every_refusal_is_documented_in_the_one_shape(described: Served) -> None:
    document = described.http.get("/openapi.json").json()
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            refusals = {
                code: answer for code, answer in operation["responses"].items() if code >= "4"
            }
            assert {"400", "401", "403", "413", "422"} <= set(refusals), (method, path)
            for code, answer in refusals.items():
                reference = answer["content"]["application/json"]["schema"]["$ref"]
                assert reference.endswith("/ErrorAnswer"), (method, path, code)


@pytest.mark.parametrize(
    ("path", "methods"),
    [
        ("/api/experiment", {"GET", "PATCH", "PUT"}),
        ("/api/presets/paper", {"GET", "PUT", "DELETE"}),
    ],
)
def test_a_wrong_method_is_told_all_the_right_ones(
    described: Served, path: str, methods: set[str]
) -> None:
    answer = described.http.request("OPTIONS", path)
    assert answer.status_code == 405
    assert set(answer.headers["allow"].split(", ")) == methods
    assert path in answer.json()["error"]["message"]
