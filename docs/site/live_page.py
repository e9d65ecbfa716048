"""The WebSocket of the live session, from the AsyncAPI document of the application."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from docs.site.json_type import model_name, properties_table
from docs.site.table import code, json_block, page, table, told

Document = Mapping[str, Any]


def resolved(part: Document, document: Document) -> Document:
    """Return what a reference within a document stands for."""
    while "$ref" in part:
        found: Any = document
        for name in part["$ref"].removeprefix("#/").split("/"):
            found = found[name]
        part = found
    return part


def messages(document: Document, action: str) -> Iterator[tuple[str, Document, Document]]:
    """Yield name, operation and message of all that one side sends.

    Args:
        document: the AsyncAPI document.
        action: ``receive`` for what the server takes, ``send`` for what it tells.
    """
    for operation in document["operations"].values():
        if operation["action"] == action:
            for reference in operation["messages"]:
                message = resolved(reference, document)
                name = message.get("name", model_name(reference["$ref"]))
                yield name, operation, message


def _message(name: str, operation: Document, message: Document, document: Document) -> str:
    payload = resolved(message.get("payload", {}), document)
    payload = resolved(payload.get("schema", payload), document)
    said = dict.fromkeys((operation.get("summary", ""), message.get("summary", "")))
    words = [told(one) for one in said if one]
    words += [told(text) for text in message.get("description", "").split("\n\n")]
    answers = [
        model_name(one["$ref"]).removeprefix("from_")
        for one in operation.get("reply", {}).get("messages", ())
    ]
    reply = f"Answer: {' or '.join(code(one) for one in answers)}." if answers else ""
    examples = [json_block(one.get("payload", one)) for one in message.get("examples", ())[:1]]
    return page(
        f"### {name}", *words, properties_table(payload, lambda one: code(one)), reply, *examples
    )


def live_page(document: Document) -> str:
    """Return the page of the live WebSocket."""
    (channel,) = document["channels"].values()
    extra = channel["bindings"]["ws"]
    limits = channel.get("x-limits", extra.get("x-limits", ()))
    codes = channel.get("x-close-codes", extra.get("x-close-codes", ()))
    return page(
        "# Live WebSocket",
        f"Address: {code(channel['address'])}. A server that runs shows the same at `/docs/live`, "
        "with a script to begin from, and as AsyncAPI 3 at `/asyncapi.json`. From Python "
        "[`slidetune.connect`](python.md) follows the session by it.",
        told(document["info"]["description"]),
        "## To the server",
        *[_message(*one, document) for one in messages(document, "receive")],
        "## From the server",
        *[_message(*one, document) for one in messages(document, "send")],
        "## Limits",
        table(
            ["limit", "value", ""],
            [
                [
                    told(one["name"]),
                    told(f"{one['value']:g} {one['unit']}"),
                    told(one["description"]),
                ]
                for one in limits
            ],
        ),
        "## Close codes",
        table(["code", ""], [[code(one["code"]), told(one["description"])] for one in codes]),
    )
