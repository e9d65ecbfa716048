"""The AsyncAPI document of the live WebSocket, made from the models of its messages."""

from __future__ import annotations

import inspect
import struct
from functools import cache
from typing import Any, get_args

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue, models_json_schema
from pydantic_core import core_schema

from slidetune.robot import __version__
from slidetune.robot.fields.plain_values import MOST_KEYS
from slidetune.server.contract.live_messages import SERVER_MESSAGES
from slidetune.server.contract.messages import ClientMessage
from slidetune.server.guard.limits import (
    CLIENT_BURST,
    CLIENT_RATE,
    MAX_CLIENTS,
    MAX_LIVE_MESSAGE,
    MAX_MESSAGE,
    TOTAL_BURST,
    TOTAL_RATE,
)
from slidetune.server.guard.message_size import SHORT
from slidetune.server.live.telemetry import HEADER, HEADER_FIELDS, LAG
from slidetune.server.state.hub import FRAME, OUTBOX, SOONEST

CLIENT_MESSAGES: tuple[type[BaseModel], ...] = get_args(get_args(ClientMessage)[0])
"""All messages that a client may send."""

_DESCRIPTION = (
    "Open a WebSocket, read `hello`, then send and receive messages: JSON text messages with a "
    "`type`, and binary frames of telemetry. A client that misses a message needs no history: "
    "`hello` and every `patch` contain the whole experiment. Ignore a `type` or a field that you "
    "don't know: later versions may add some."
)
_ANSWERS = {"patch": ["patch"], "lane": ["patch", "hello"], "kick": []}
"""Types that tell that a message was acted on; ``state`` where nothing else is said."""
_TYPES = {"I": "uint32", "d": "float64"}

_PACE = (
    ("clients", MAX_CLIENTS, "", "Concurrent clients; one more is closed with 1013."),
    ("message", MAX_MESSAGE, "bytes", "Largest message; a larger one closes with 1009."),
    ("characters", MAX_LIVE_MESSAGE, "", "Longest text message; `error`: `too_large`."),
    ("keys", MOST_KEYS, "", "Keys and values of a message; `error`: `too_large`."),
    ("rate", CLIENT_RATE, "1/s", "Messages from one client; `error`: `too_many_patches`."),
    ("burst", CLIENT_BURST, "", "Burst of messages from one client."),
    ("control frames", CLIENT_RATE, "1/s", "Pings and message fragments; beyond: 1008."),
    ("weight", SHORT, "", "Characters after which a message counts as one more."),
    ("total rate", TOTAL_RATE, "1/s", "Patches and new lanes from all clients together."),
    ("total burst", TOTAL_BURST, "", "Burst of patches and new lanes from all clients."),
    ("frames", 1.0 / FRAME, "1/s", "Frames to one client; more often only after an edit."),
    ("most frames", 1.0 / SOONEST, "1/s", "Most frames to one client."),
    ("lag", LAG, "rows", "A client further behind is skipped ahead: `dropped` says how far."),
    ("outbox", OUTBOX, "", "Messages queued for a slow client; then a new `hello`."),
)
CLOSE_CODES = (
    (1002, "Not a valid WebSocket frame."),
    (1007, "A text message is not UTF-8."),
    (1008, "Pings, pongs or message fragments exceeded the rate limit."),
    (1009, "A message is larger than 256 KiB."),
    (1011, "The client did not answer a ping for 20 s."),
    (1012, "The server is stopping or restarting."),
    (1013, "The maximum number of clients is connected; try again later."),
)
"""How the server ends a connection; what it refuses beforehand is answered with HTTP 403."""


class _Draft07(GenerateJsonSchema):
    """Schemas of the kind that AsyncAPI takes where no other is named."""

    def tagged_union_schema(self, schema: core_schema.TaggedUnionSchema) -> JsonSchemaValue:
        """Leave out OpenAPI's ``discriminator``: the constants of the alternatives say as much."""
        value = super().tagged_union_schema(schema)
        value.pop("discriminator", None)
        return value

    def tuple_schema(self, schema: core_schema.TupleSchema) -> JsonSchemaValue:
        """Say once what all items of a tuple are."""
        value = super().tuple_schema(schema)
        items = value.pop("prefixItems", None)
        if items:
            assert all(item == items[0] for item in items)
            value["items"] = items[0]
        return value


def type_of(model: type[BaseModel]) -> str:
    """Return the ``type`` by which a message is known."""
    (name,) = get_args(model.model_fields["type"].annotation)
    return str(name)


def _reference(kind: str, name: str) -> dict[str, str]:
    return {"$ref": f"#/components/{kind}/{name}"}


def _in_channel(name: str) -> dict[str, str]:
    return {"$ref": f"#/channels/live/messages/{name}"}


def _example(model: type[BaseModel]) -> dict[str, Any]:
    """Return a message with all that has an example or must be there."""
    values = {
        name: field.examples[0] for name, field in model.model_fields.items() if field.examples
    }
    return {"type": type_of(model), **values}


def _message(model: type[BaseModel], *, example: bool) -> dict[str, Any]:
    summary, _, more = inspect.cleandoc(model.__doc__ or "").partition("\n\n")
    name = type_of(model)
    message: dict[str, Any] = {
        "name": name,
        "title": name,
        "summary": summary,
        "contentType": "application/json",
        "payload": _reference("schemas", model.__name__),
    }
    if more:
        message["description"] = " ".join(more.split())
    if example:
        message["examples"] = [{"payload": _example(model)}]
    return message


def _telemetry() -> dict[str, Any]:
    """Return the binary message, with the place of every number in it."""
    header, offset = [], 0
    for name, code, unit, meaning in HEADER_FIELDS:
        place = {"name": name, "type": _TYPES[code], "offset": offset, "unit": unit}
        header.append({**place, "description": meaning})
        offset += struct.calcsize(f"<{code}")
    assert offset == HEADER.size
    return {
        "name": "telemetry",
        "title": "telemetry, binary",
        "summary": "Rows of the columns that `hello` lists as `channels`.",
        "description": "Little-endian: a header, then columns × rows numbers of float32, column by "
        "column. All rows of a frame have one revision and one period, in order of time.",
        "contentType": "application/octet-stream",
        "payload": {"type": "string", "format": "binary"},
        "x-layout": {
            "byteOrder": "little-endian",
            "header": header,
            "data": {"type": "float32", "offset": offset, "order": "column by column"},
        },
    }


def _operations(sent: dict[str, Any], told: dict[str, Any]) -> dict[str, Any]:
    """Return what the server does with the messages of either side."""
    channel = {"$ref": "#/channels/live"}
    operations: dict[str, Any] = {}
    for name, message in sent.items():
        answers = [*_ANSWERS.get(name, ["state"]), "error"]
        operations[f"hear_{name}"] = {
            "action": "receive",
            "channel": channel,
            "summary": message["summary"],
            "messages": [_in_channel(f"to_{name}")],
            "reply": {
                "channel": channel,
                "messages": [_in_channel(f"from_{answer}") for answer in answers],
            },
        }
    for name, message in told.items():
        operations[f"tell_{name}"] = {
            "action": "send",
            "channel": channel,
            "summary": message["summary"],
            "messages": [_in_channel(f"from_{name}")],
        }
    return operations


@cache
def _lasting() -> dict[str, Any]:
    """Return all of the document that is the same wherever the server is."""
    sent = {type_of(model): _message(model, example=True) for model in CLIENT_MESSAGES}
    told = {type_of(model): _message(model, example=False) for model in SERVER_MESSAGES}
    told["telemetry"] = _telemetry()
    messages = {f"to_{name}": message for name, message in sent.items()}
    messages |= {f"from_{name}": message for name, message in told.items()}
    _, schemas = models_json_schema(
        [
            *((model, "validation") for model in CLIENT_MESSAGES),
            *((model, "serialization") for model in SERVER_MESSAGES),
        ],
        ref_template="#/components/schemas/{model}",
        schema_generator=_Draft07,
    )
    # Its fields fill a page of their own.
    schemas["$defs"]["Experiment"]["x-address"] = "/api/schema"
    return {
        "asyncapi": "3.0.0",
        "info": {
            "title": "Slidetune, the live session",
            "version": __version__,
            "description": _DESCRIPTION,
        },
        "defaultContentType": "application/json",
        "channels": {
            "live": {
                "address": "/api/live",
                "title": "The live WebSocket",
                "messages": {name: _reference("messages", name) for name in messages},
                "bindings": {"ws": {"method": "GET"}},
                "x-limits": [
                    {"name": name, "value": value, "unit": unit, "description": meaning}
                    for name, value, unit, meaning in _PACE
                ],
                "x-close-codes": [
                    {"code": code, "description": meaning} for code, meaning in CLOSE_CODES
                ],
            }
        },
        "operations": _operations(sent, told),
        "components": {
            "messages": messages,
            "schemas": schemas["$defs"],
            "securitySchemes": {
                "bearer": {
                    "type": "http",
                    "scheme": "bearer",
                    "description": "The token that the server printed, if it requires one.",
                },
                "query": {
                    "type": "httpApiKey",
                    "in": "query",
                    "name": "token",
                    "description": "The same token as `?token=`.",
                },
            },
        },
    }


def asyncapi_document(host: str, secure: bool) -> dict[str, Any]:
    """Return the AsyncAPI 3 document of the live WebSocket.

    Args:
        host: name and port by which the server was reached.
        secure: whether over TLS.
    """
    server = {
        "host": host,
        "protocol": "wss" if secure else "ws",
        "security": [_reference("securitySchemes", name) for name in ("bearer", "query")],
    }
    return {**_lasting(), "servers": {"this": server}}
