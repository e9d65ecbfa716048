"""The HTTP API, from the OpenAPI document of the application."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from docs.site.json_type import model_name, properties_table, type_words
from docs.site.table import code, json_block, page, table, told
from slidetune.server.contract.openapi import REFUSALS

_SAYS_NOTHING = {"Successful Response", "Unprocessable Entity", "Request Entity Too Large"}
"""Descriptions that only repeat the status."""
METHODS = ("get", "put", "post", "patch", "delete")
Operation = Mapping[str, Any]


def operations(openapi: Mapping[str, Any]) -> Iterator[tuple[str, str, Operation]]:
    """Yield method, path and description of every route."""
    for path, methods in openapi["paths"].items():
        for method in METHODS:
            if method in methods:
                yield method.upper(), path, methods[method]


def _link(name: str) -> str:
    return f"[{name}](http-messages.md#{name.lower()})"


def _here(name: str) -> str:
    return f"[{name}](#{name.lower()})"


def _examples(media: Mapping[str, Any]) -> Iterator[Any]:
    for one in media.get("examples", {}).values():
        yield one.get("value", one) if isinstance(one, Mapping) else one
    if "example" in media:
        yield media["example"]
    yield from media.get("schema", {}).get("examples", ())


def _body(operation: Operation, openapi: Mapping[str, Any]) -> str:
    content = operation.get("requestBody", {}).get("content", {})
    parts = []
    for kind, media in content.items():
        schema = media.get("schema", {})
        parts.append(f"Body, {code(kind)}: {type_words(schema, _link)}.")
        parts.append(properties_table(schema, _link))
        named = schema.get("$ref")
        described = openapi["components"]["schemas"][model_name(named)] if named else {}
        examples = [*_examples(media), *described.get("examples", ())]
        parts += [json_block(one) for one in examples[:1]]
    return page(*parts) if parts else ""


def _answers(operation: Operation) -> Iterator[list[str]]:
    everywhere = {str(status): one["description"] for status, one in REFUSALS.items()}
    for status, answer in operation["responses"].items():
        words = answer.get("description", "")
        if words in _SAYS_NOTHING:
            words = ""
        if status in everywhere and words in ("", everywhere[status]):
            continue
        content = answer.get("content", {})
        kinds = dict.fromkeys(
            type_words(media.get("schema", {}), _link) if "json" in kind else f"{code(kind)}"
            for kind, media in content.items()
        )
        yield [status, " or ".join(kinds), told(words)]


def _parameters(operation: Operation) -> Iterator[list[str]]:
    for one in operation.get("parameters", ()):
        schema = one.get("schema", {})
        default = "required" if one.get("required") else ""
        if schema.get("default") is not None:
            default = code(schema["default"])
        words = told(one.get("description", ""))
        yield [code(one["name"]), one["in"], type_words(schema, _link), default, words]


def _route(method: str, path: str, operation: Operation, openapi: Mapping[str, Any]) -> str:
    words = [told(text) for text in operation.get("description", "").split("\n\n")]
    return page(
        f"### {method} {path}",
        *words,
        table(["parameter", "in", "type", "default", ""], _parameters(operation)),
        _body(operation, openapi),
        table(["status", "answer", ""], _answers(operation)),
    )


def http_page(openapi: Mapping[str, Any]) -> str:
    """Return the page of every route, by topic."""
    topics: dict[str, list[str]] = {}
    for method, path, operation in operations(openapi):
        topic = operation.get("tags", ["other"])[0]
        topics.setdefault(topic, []).append(_route(method, path, operation, openapi))
    return page(
        "# HTTP API",
        "Everything that the page does it asks for by these routes, and so can any program. A "
        "server that runs shows the same at `/docs`, where requests can be tried, and at "
        "`/openapi.json` for other programs. [Messages](http-messages.md) has every object by "
        "name, [the WebSocket](websocket.md) the live session, [Security](../security.md) who may "
        "ask for what. Refusals have one form, [ErrorAnswer](http-messages.md#erroranswer). From "
        "Python [`slidetune.connect`](python.md) does the same.",
        "Every route may refuse so; it lists what it may answer besides.",
        table(["status", ""], [[str(one), told(REFUSALS[one]["description"])] for one in REFUSALS]),
        *[page(f"## {topic}", *routes) for topic, routes in topics.items()],
    )


def _model(name: str, schema: Mapping[str, Any]) -> str:
    words = [told(text) for text in schema.get("description", "").split("\n\n")]
    examples = [json_block(one) for one in schema.get("examples", ())[:1]]
    whole = "" if "properties" in schema else f"{type_words(schema, _here)}."
    return page(f"## {name}", *words, whole, properties_table(schema, _here), *examples)


def messages_page(openapi: Mapping[str, Any]) -> str:
    """Return the page of every object that routes take or return."""
    schemas = openapi["components"]["schemas"]
    return page(
        "# Messages of the HTTP API",
        "What the [routes](http.md) take and return, by name.",
        *[_model(name, schemas[name]) for name in sorted(schemas)],
    )
