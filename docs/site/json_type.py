"""JSON Schema in words."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from docs.site.table import code, table, told

Schema = Mapping[str, Any]
Link = Callable[[str], str]
"""Markdown of a named model: a link to where it is described."""


def model_name(reference: str) -> str:
    """Return the last part of a reference such as ``#/components/schemas/Health``."""
    return reference.rsplit("/", 1)[-1]


def _written(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def type_words(schema: Schema, link: Link) -> str:
    """Return what a schema allows, in words, as Markdown."""
    if "$ref" in schema:
        return link(model_name(schema["$ref"]))
    if "const" in schema:
        return code(_written(schema["const"]))
    if "enum" in schema:
        return ", ".join(code(_written(one)) for one in schema["enum"])
    options = schema.get("anyOf") or schema.get("oneOf") or schema.get("allOf")
    if options:
        return " or ".join(dict.fromkeys(type_words(one, link) for one in options))
    kind = schema.get("type")
    if isinstance(kind, list):
        return " or ".join(type_words({**schema, "type": one}, link) for one in kind)
    if kind == "array":
        inner = type_words(schema.get("items", {}), link)
        return f"list of {inner}"
    if kind == "object":
        values = schema.get("additionalProperties")
        return f"object of {type_words(values, link)}" if isinstance(values, Mapping) else "object"
    return str(kind or "any value")


def limits(schema: Schema) -> str:
    """Return the bounds of a value in words, as far as it has any."""
    low = schema.get("minimum", schema.get("exclusiveMinimum"))
    high = schema.get("maximum", schema.get("exclusiveMaximum"))
    words = [f"at least {low:.10g}"] if low is not None else []
    words += [f"at most {high:.10g}"] if high is not None else []
    if "maxLength" in schema:
        words.append(f"at most {schema['maxLength']} characters")
    if "maxItems" in schema:
        words.append(f"at most {schema['maxItems']}")
    return ", ".join(words)


def properties_table(schema: Schema, link: Link) -> str:
    """Return the properties of an object as a table; nothing where it has none."""
    required = schema.get("required", ())

    def rows() -> Iterator[list[str]]:
        for name, part in schema.get("properties", {}).items():
            kind = type_words(part, link)
            bounds = limits(part)
            default = "required" if name in required else ""
            if "default" in part and part["default"] is not None:
                default = code(_written(part["default"]))
            words = told(part.get("description", ""))
            yield [code(name), f"{kind}; {bounds}" if bounds else kind, default, words]

    return table(["name", "type", "default", ""], rows())
