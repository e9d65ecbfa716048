"""The AsyncAPI document says what really goes over the live WebSocket, both ways."""

from __future__ import annotations

import ast
import html
import json
import re
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema_rs
import pytest
from pydantic import TypeAdapter
from websockets.sync.client import connect

from slidetune.server.contract.asyncapi import CLIENT_MESSAGES, asyncapi_document, type_of
from slidetune.server.contract.messages import ClientMessage
from tests.server.conftest import Served

Document = dict[str, Any]
ROOT = Path(__file__).resolve().parents[3]
TELLING = ("state/hub.py", "state/app_state.py", "routes/live.py")
"""Where the messages to the clients are made."""


@pytest.fixture(scope="module")
def document() -> Document:
    return asyncapi_document("localhost:8000", secure=False)


def references(node: Any) -> Iterator[str]:
    if isinstance(node, dict):
        if isinstance(node.get("$ref"), str):
            yield node["$ref"]
        for value in node.values():
            yield from references(value)
    elif isinstance(node, list):
        for value in node:
            yield from references(value)


def found(document: Document, reference: str) -> Any:
    node: Any = document
    for key in reference.removeprefix("#/").split("/"):
        node = node[key]
    return node


def validator(document: Document, message: str) -> jsonschema_rs.Validator:
    """Return a validator of a message's payload that takes no field which is not described."""
    components = json.loads(json.dumps(document["components"]))
    for schema in components["schemas"].values():
        if "properties" in schema:
            schema.setdefault("additionalProperties", False)
    payload = components["messages"][message]["payload"]
    return jsonschema_rs.Draft7Validator({**payload, "components": components})


def types_told() -> set[str]:
    """Every type that the server's code puts into a message to the clients."""
    told = set()
    for name in TELLING:
        for node in ast.walk(ast.parse((ROOT / "server" / name).read_text(encoding="utf-8"))):
            if isinstance(node, ast.Dict):
                for key, value in zip(node.keys, node.values, strict=True):
                    if isinstance(key, ast.Constant) and key.value == "type":
                        assert isinstance(value, ast.Constant)
                        told.add(str(value.value))
    return told


def test_it_is_an_asyncapi_3_document(document: Document) -> None:
    schema = json.loads((ROOT / "tests/data/asyncapi-3.0.0.json").read_text(encoding="utf-8"))
    errors = jsonschema_rs.validator_for(schema).iter_errors(document)
    assert [(error.instance_path, error.message) for error in errors] == []
    for reference in references(document):
        assert found(document, reference) is not None


def test_every_message_of_either_side_is_in_it(document: Document) -> None:
    messages = set(document["channels"]["live"]["messages"])
    taken = {f"to_{type_of(model)}" for model in CLIENT_MESSAGES}
    assert {name for name in messages if name.startswith("to_")} == taken
    told = {f"from_{kind}" for kind in types_told()} | {"from_telemetry"}
    assert {name for name in messages if name.startswith("from_")} == told
    operations = document["operations"].values()
    assert {found(document, one["messages"][0]["$ref"])["$ref"] for one in operations} == {
        f"#/components/messages/{name}" for name in messages
    }


def test_every_field_of_every_message_says_what_it_is(document: Document) -> None:
    schemas = document["components"]["schemas"]
    silent = [
        f"{name}.{field}"
        for name, schema in schemas.items()
        for field, value in schema.get("properties", {}).items()
        if not {"description", "$ref", "oneOf", "const", "enum", "examples"} & set(value)
    ]
    plain = {"name", "title", "summary"}
    assert [field for field in silent if field.rpartition(".")[2] not in plain] == []


def test_every_example_is_a_message_that_the_server_takes(document: Document) -> None:
    for name, message in document["components"]["messages"].items():
        for example in message.get("examples", []):
            assert validator(document, name).is_valid(example["payload"]), name
            TypeAdapter(ClientMessage).validate_python(example["payload"])


def test_what_goes_over_a_real_socket_is_what_it_describes(served: Served) -> None:
    document = served.http.get("/asyncapi.json").json()
    assert document["servers"]["this"]["host"] == served.url.removeprefix("http://")
    layout = document["components"]["messages"]["from_telemetry"]["x-layout"]
    wanted = types_told() | {"telemetry"}
    columns, seen = 0, set()
    end = time.monotonic() + 30.0
    with connect(served.live) as socket:
        for name, message in document["components"]["messages"].items():
            if name.startswith("to_"):
                socket.send(json.dumps({**message["examples"][0]["payload"], "id": name}))
        socket.send(json.dumps({"type": "speed", "speed": 99}))
        socket.send(json.dumps({"type": "play"}))
        served.app_state.session.on_notice("Something happened.")
        served.app_state.law_files.on_change()
        while seen != wanted:
            assert time.monotonic() < end, f"no {wanted - seen} came"
            raw = socket.recv(timeout=15.0)
            if isinstance(raw, bytes):
                seen.add("telemetry")
                codes = {"uint32": "I", "float64": "d"}
                header = {
                    field["name"]: struct.unpack_from(
                        f"<{codes[field['type']]}", raw, field["offset"]
                    )[0]
                    for field in layout["header"]
                }
                assert header["columns"] == columns
                assert len(raw) == layout["data"]["offset"] + 4 * header["rows"] * columns
                continue
            message = json.loads(raw)
            kind = message["type"]
            columns = len(message["channels"]) if kind == "hello" else columns
            seen.add(kind)
            errors = validator(document, f"from_{kind}").iter_errors(message)
            assert [(kind, error.instance_path, error.message) for error in errors] == []


def test_the_script_on_its_page_runs(served: Served) -> None:
    page = served.http.get("/docs/live").text
    match = re.search(r'<code id="script">(.*?)</code>', page, re.DOTALL)
    assert match
    script = html.unescape(match[1]).replace("ws://127.0.0.1:8000/api/live", served.live)
    command = [sys.executable, "-u", "-c", script]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        lines = iter(process.stdout.readline, "")
        try:
            assert next(line for line in lines if line == "patch\n")
            assert re.fullmatch(
                r"\d+\.\d{3} s  [+-]\d\.\d{6} rad\n", next(line for line in lines if " s " in line)
            )
        finally:
            process.kill()
    assert served.app_state.document.experiment.lanes["NFTSM"].nu == 30
