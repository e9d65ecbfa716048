"""Wrong values, and instances of a JSON Schema that are right or wrong in one place."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from random import Random
from typing import Any

Schema = Mapping[str, Any]


class Raw(str):
    """A token that goes into JSON or YAML as it stands."""

    __slots__ = ()


TEXTS = (
    "", " ", "\x00", "\x07", "\n", "\t", "\ud800", "\udfff\ud800", "\ufeff", "\u2028", "\ufffe",
    "e\u0301", "ν = 0.5", "a.b", 'a"b', "a/b", "../../etc/passwd", "<<", "*a", "&a", "!!str",
    "null",
    "NaN", "1e400", "-1", "0x1F", "yes", "True", "None", "<b>", "%s{0}", "lanes.A.nu", "NFTSM",
    "nftsm",
    "law", "kind", "sine", "__class__", "constructor", "🤖" * 10, "x" * 41, "x" * 121, "y" * 5000,
)  # fmt: skip
RAW_NUMBERS = (
    "1e400", "-1e400", "1e-400", "1" + "0" * 400, "1" + "0" * 5000, "-" + "9" * 4301, "NaN",
    "Infinity", "-Infinity", "0." + "3" * 3000, "1E+0000000000000009", "-0", "-0.0",
    "9007199254740993",
)  # fmt: skip
BAD_JSON = (
    "01", "+1", ".5", "1.", "0x10", "1_000", "'a'", "undefined", "nan", "inf", "True", "None",
    "{,}",
    "[1,]", "{a:1}", '{"a":1,"a":2}', '"\\ud800"', '"\\x41"', '"\t"', "/**/1", "[" * 100_000,
    '{"a":' * 50_000, "[" * 400 + "]" * 400,
)  # fmt: skip
NUMBERS: tuple[float, ...] = (
    0, -0.0, 1, -1, 0.5, 2, 3, 1e-12, 5e-324, 1e308, -1e308, 1e15, 1e16, 2**53 + 1, 10**40,
    -(10**40),
    math.inf, -math.inf, math.nan, 1e6, 1e9, 0.1 + 0.2,
)  # fmt: skip


def nested(random: Random) -> Any:
    """Return lists and mappings in each other, at depths around every limit."""
    value: Any = {} if random.random() < 0.5 else 1
    for _ in range(random.choice((2, 11, 12, 13, 100, 900, 1100, 5000))):
        value = {"a": value} if random.random() < 0.5 else [value]
    return value


def wrong(random: Random) -> Any:
    """Return a value that hardly any place takes."""
    kind = random.randrange(9)
    if kind < 3:
        return random.choice(NUMBERS)
    if kind < 5:
        return random.choice(TEXTS)
    if kind == 5:
        return random.choice((None, True, False, [], {}, [[]], {"": {}}, [None] * 6, [1, 2, 3]))
    if kind == 6:
        return random.choice((10**5000, -(10**4400), "x" * 100_000, list(range(2000))))
    if kind == 7:
        return {random.choice(TEXTS): wrong(random) for _ in range(random.randrange(1, 4))}
    return nested(random) if random.random() < 0.1 else [random.choice(NUMBERS)]


def json_text(value: Any) -> str:
    """Return a value as JSON; ``Raw`` goes in as it stands, whole numbers of any length too."""
    if isinstance(value, Raw):
        return str(value)
    if isinstance(value, Mapping):
        pairs = (f"{json.dumps(str(key))}: {json_text(item)}" for key, item in value.items())
        return "{" + ", ".join(pairs) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(json_text(item) for item in value) + "]"
    if isinstance(value, int) and abs(value) > 10**100:
        return ("-" if value < 0 else "") + "1" + "0" * (value.bit_length() * 3 // 10)
    return json.dumps(value)


class Instances:
    """Makes values after a JSON Schema: right, at its bounds, past them, or of another kind."""

    def __init__(self, schema: Schema, document: Schema, names: tuple[str, ...] = ("A",)) -> None:
        """Follow ``schema``; ``document`` holds what it refers to, ``names`` a mapping's keys."""
        self._schema = schema
        self._document = document
        self._names = names

    def make(self, random: Random, wildness: float) -> Any:
        """Return one value, each part of which is wrong with a probability of ``wildness``."""
        return self._value(self._schema, random, wildness)

    def _value(self, schema: Schema, random: Random, wild: float) -> Any:
        schema = self._resolved(schema)
        if random.random() < wild * 0.3:
            return wrong(random)
        if "const" in schema or "enum" in schema:
            choices = schema.get("enum") or [schema["const"]]
            return wrong(random) if random.random() < wild else random.choice(choices)
        for key in ("oneOf", "anyOf", "allOf"):
            if key in schema:
                bounds = {k: schema[k] for k in ("minimum", "maximum", "odd") if k in schema}
                option = self._resolved(random.choice(schema[key]))
                return self._value({**bounds, **option}, random, wild)
        kind = schema.get("type")
        if kind == "object" or "properties" in schema:
            return self._object(schema, random, wild)
        if kind == "array":
            return self._array(schema, random, wild)
        if kind in ("number", "integer"):
            return number(schema, random, wild)
        if kind == "boolean":
            return random.random() < 0.5
        if kind == "string":
            return random.choice(TEXTS) if random.random() < wild else random.choice(self._names)
        return None if kind == "null" else wrong(random)

    def _resolved(self, schema: Schema) -> Schema:
        while "$ref" in schema:
            found: Any = self._document
            for part in schema["$ref"].removeprefix("#/").split("/"):
                found = found[part]
            schema = {**found, **{key: schema[key] for key in schema if key != "$ref"}}
        return schema

    def _object(self, schema: Schema, random: Random, wild: float) -> dict[str, Any]:
        properties = schema.get("properties", {})
        wanted = schema.get("required", ())
        made: dict[str, Any] = {}
        for name, part in properties.items():
            tag = "const" in part and name in ("law", "kind", "type")
            if tag or name in wanted or random.random() < 0.25:
                made[name] = self._value(part, random, wild * 0.5 if tag else wild)
        extra = schema.get("additionalProperties")
        if isinstance(extra, Mapping) and extra:
            for name in random.sample(self._names, random.randint(1, min(3, len(self._names)))):
                made[name] = self._value(extra, random, wild)
        if random.random() < wild * 0.4:
            made[random.choice(TEXTS)] = wrong(random)
        if made and random.random() < wild * 0.2:
            made.pop(random.choice(list(made)))
        return made

    def _array(self, schema: Schema, random: Random, wild: float) -> list[Any]:
        items = schema.get("items", {})
        low, high = schema.get("minItems", 0), schema.get("maxItems", 3)
        size = random.randint(low, max(low, min(high, 8)))
        if random.random() < wild:
            size = random.choice((0, low - 1, high + 1, 600))
        bounds = {k: schema[k] for k in ("minimum", "maximum", "odd") if k in schema}
        return [self._value({**bounds, **items}, random, wild / 4) for _ in range(max(0, size))]


def number(schema: Schema, random: Random, wild: float) -> Any:
    """Return a number after its schema: anywhere, at a bound, just past one, far past, or none."""
    low = schema.get("minimum", schema.get("exclusiveMinimum", -1e3))
    high = schema.get("maximum", schema.get("exclusiveMaximum", 1e3))
    if random.random() < wild:
        return random.choice(
            (
                math.nextafter(low, -math.inf), math.nextafter(high, math.inf), low - 1, high + 1,
                low * 1e6, high * 1e6, high * 10**400 if isinstance(high, int) else 1e308, str(low),
                [low] * 6, [low] * 5, [high] * 7, [low] * 5 + [high * 2 + 1], [[low]], None, True,
                wrong(random),
            )
        )  # fmt: skip
    if schema.get("type") == "integer" or schema.get("odd"):
        value = random.randint(math.ceil(low), math.floor(high))
        return value | 1 if schema.get("odd") and value < high else value
    return random.choice((low, high, random.uniform(low, high), low + (high - low) * 0.5))
