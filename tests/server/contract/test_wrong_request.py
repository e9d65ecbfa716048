"""What is wrong with a request or a message is said in our words, for the field it is about."""

from __future__ import annotations

import json
from typing import Any

import pytest
from pydantic import TypeAdapter, ValidationError
from websockets.sync.client import connect

from slidetune.server.contract.messages import ClientMessage
from slidetune.server.contract.wrong_request import MOST_FIELDS, refused_fields
from tests.server.conftest import Served
from tests.server.routes.test_live import text as heard

_MESSAGE: TypeAdapter[Any] = TypeAdapter(ClientMessage)


def refused(message: Any) -> list[dict[str, Any]]:
    with pytest.raises(ValidationError) as caught:
        _MESSAGE.validate_python(message)
    return refused_fields(caught.value.errors())


@pytest.mark.parametrize(
    ("message", "path", "part"),
    [
        (3, "", "must be an object, got 3"),
        ({}, "type", "is required"),
        ({"type": "fly"}, "type", "'kick'"),
        ({"type": "patch"}, "patch", "is missing"),
        ({"type": "patch", "patch": 3}, "patch", "must be an object, got 3"),
        ({"type": "patch", "patch": {}, "id": 1.5}, "id", "a whole number or a text, got 1.5"),
        ({"type": "patch", "patch": {}, "id": "x" * 81}, "id", "80 characters"),
        ({"type": "kick", "torque": [0, 0, 0, 0, 0, True]}, "torque.5", "a number, got true"),
        ({"type": "kick", "torque": 3}, "torque", "a list, got 3"),
        ({"type": "step", "count": "2"}, "count", "a whole number, got 2"),
        ({"type": "view", "ghosts": 1}, "ghosts", "true or false, got 1"),
        ({"type": "play", "count": 2}, "count", "is unknown here"),
        ({"type": "lane", "origin": "a", "name": "a/b"}, "name", "1 to 40 characters"),
    ],
)
def test_a_wrong_message_names_its_field(message: Any, path: str, part: str) -> None:
    field = refused(message)[0]
    assert field["path"] == path
    assert part in field["message"]
    for word in ("Input", "pydantic", "None", "True", "dict"):
        assert word not in field["message"]


def test_at_most_twenty_fields_are_told() -> None:
    assert len(refused({"type": "play", **{f"x{i}": i for i in range(100)}})) == MOST_FIELDS


@pytest.mark.parametrize(
    "message",
    [
        '{"type": "select", "lane": "\\ud800"}',
        '{"type": "lane", "origin": "NFTSM", "name": "\\udfff"}',
        '{"type": "patch", "patch": {"lanes": {"\\ud800": null}}}',
        '{"type": "patch", "patch": {}, "id": "\\ud800"}',
        '{"type": "patch", "patch": {}, "id": "' + "x" * 10_000 + '"}',
        '{"type": "kick", "torque": [1e999, 0, 0, 0, 0, 0]}',
        '{"type": "step", "count": 1' + "0" * 5000 + "}",
        '{"type": "patch", "patch": ' + '{"a": ' * 900 + "1" + "}" * 901,
        '{"type": "patch", "patch": {"trajectory": {"kind": "\\ud800"}}}',
        "[" * 100_000,
        '{"type": "\\ud800"}',
    ],
)
def test_a_client_that_sends_nonsense_is_answered_and_goes_on(served: Served, message: str) -> None:
    before = served.app_state.document.revision
    with connect(served.live, proxy=None) as other, connect(served.live, proxy=None) as socket:
        socket.send(message)
        error = heard(socket, "error")
        assert len(json.dumps(error)) < 4000
        assert error["error"]["message"]
        socket.send('{"type": "speed", "speed": 2.0, "id": 7}')
        while heard(socket, "state")["speed"] != 2.0:
            pass
        while heard(other, "state")["speed"] != 2.0:
            pass
    assert served.app_state.document.revision == before


@pytest.mark.parametrize("body", [b"\xff", b"{", b"[" * 100_000, b'{"a": 1' + b"0" * 5000 + b"}"])
def test_a_body_that_cannot_be_read_is_refused_in_the_one_shape(
    served: Served, body: bytes
) -> None:
    headers = {"content-type": "application/json"}
    for method, path in (("PATCH", "/api/experiment"), ("POST", "/api/session/kick")):
        answer = served.http.request(method, path, content=body, headers=headers)
        assert answer.status_code in (400, 422)
        assert answer.json()["error"]["message"]


def test_a_deep_patch_is_refused_over_http(served: Served) -> None:
    body = '{"a": ' * 500 + "1" + "}" * 500
    answer = served.http.patch(
        "/api/experiment", content=body, headers={"content-type": "application/json"}
    )
    assert answer.status_code == 422
    assert "nested deeper" in answer.json()["error"]["message"]
