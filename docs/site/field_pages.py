"""Every field of an experiment, from the schema that also makes its slider and its validation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from docs.site.table import code, page, plain, table
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.written_value import written
from slidetune.robot.laws import LAWS, SHIPPED

HEADS = ("key", "meaning", "default", "allowed", "source")
SECTIONS = {
    "robot": "The arm, its friction, drives and payload.",
    "trajectory": "The desired motion; `kind` says which of these it is.",
    "disturbance": "What pushes the arm, and what the controller does not know.",
    "simulation": "How time goes on, and where a run begins.",
    "goals": "What the lanes are held to, each by a name; `kind` says which of these it is. "
    "[Goals and studies](../studies.md) explains them.",
    "uncertainty": "What is not known exactly, each a range; nothing of it acts but in studies.",
}
"""Sections of an experiment apart from its lanes, in the order of the document."""

Schema = Mapping[str, Any]


def schema() -> Schema:
    """Return the JSON Schema of an experiment."""
    return Experiment.model_json_schema()


def _models(part: Schema) -> list[str]:
    """Return the names of the models that a field may hold."""
    if "$ref" in part:
        return [part["$ref"].rsplit("/", 1)[-1]]
    inner = part.get("additionalProperties")
    options = [*part.get("oneOf", ()), *part.get("anyOf", ())]
    found = [name for one in options for name in _models(one)]
    return found + (_models(inner) if isinstance(inner, Mapping) else [])


def fields_of(model: str, path: str, whole: Schema) -> Iterator[tuple[str, Schema]]:
    """Yield every field below a path, with its own path: ``robot.payload.mass``."""
    for name, part in whole["$defs"][model]["properties"].items():
        inner = _models(part)
        if len(inner) == 1 and "minimum" not in part:
            yield from fields_of(inner[0], f"{path}.{name}", whole)
        else:
            yield f"{path}.{name}", part


def _shapes(part: Schema) -> list[Schema]:
    return [part, *part.get("anyOf", ())]


def _allowed(part: Schema) -> str:
    words = []
    if "const" in part:
        return code(part["const"])
    if "enum" in part:
        return ", ".join(code(one) for one in part["enum"])
    low, high = part.get("minimum"), part.get("maximum")
    unit = f" {part['unit']}" if part.get("unit") else ""
    if low is not None and high is not None:
        words.append(f"{low:.10g} to {high:.10g}{unit}")
    if part.get("odd"):
        words.append("odd")
    if any(one.get("per_joint") for one in _shapes(part)):
        words.append("one for all joints, or one each")
    if any(one.get("type") == "array" and one.get("maxItems") == 2 for one in _shapes(part)):
        words.append("the least and the greatest")
    if any(one.get("type") == "null" for one in _shapes(part)):
        words.append("none")
    if any(one.get("type") == "boolean" for one in _shapes(part)):
        words.append("`true`, `false`")
    if "maxLength" in part:
        words.append(f"at most {part['maxLength']} characters")
    return "; ".join(words)


def _meaning(part: Schema) -> str:
    symbol, title = part.get("symbol", ""), part.get("title", "")
    words = [f"**{plain(title)}**" + (f" {plain(symbol)}." if symbol else ".")]
    if part.get("description"):
        words.append(plain(part["description"]))
    needs = part.get("needs", {})
    words += [
        f"Acts where {code(name)} is {' or '.join(code(one) for one in options)}."
        for name, options in needs.items()
    ]
    if part.get("applies"):
        words.append(f"Acts in {plain(part['applies'])} mode.")
    return " ".join(words)


def _default(part: Schema) -> str:
    if "default" not in part:
        return "required"
    value = part["default"]
    return "none" if value is None else code(written(value))


def _source(part: Schema) -> str:
    return ", ".join(filter(None, (part.get("source", ""), part.get("equation", ""))))


def _rows(fields: Sequence[tuple[str, Schema]], cut: str) -> Iterator[list[str]]:
    for path, part in fields:
        key = f'<a id="{path}"></a>{code(path.removeprefix(cut))}'
        yield [key, _meaning(part), _default(part), _allowed(part), _source(part)]


def _model_part(model: str, path: str, title: str, whole: Schema) -> str:
    fields = list(fields_of(model, path, whole))
    return page(title, table(HEADS, _rows(fields, f"{path}.")))


def _tag(model: str, whole: Schema) -> str:
    """Return what tells a model of several from the others, such as ``sine``."""
    for name in ("kind", "law"):
        part = whole["$defs"][model]["properties"].get(name)
        if part:
            return str(part.get("const", part.get("default", "")))
    return ""


def section_paths(name: str, whole: Schema) -> Iterator[tuple[str, str, str]]:
    """Yield model, path and kind of what a section of an experiment may be."""
    models = _models(whole["properties"][name])
    for model in models:
        kind = _tag(model, whole) if len(models) > 1 else ""
        yield model, f"{name}.{kind}" if kind else name, kind


def _section(name: str, whole: Schema) -> str:
    parts = [f"## {name}", SECTIONS[name]]
    for model, path, kind in section_paths(name, whole):
        title = f"### {name}: {kind}" if kind else ""
        parts.append(_model_part(model, path, title, whole))
    return page(*parts)


def fields_page() -> str:
    """Return the page of every field but the gains of the laws."""
    whole = schema()
    top = [
        (name, part)
        for name, part in whole["properties"].items()
        if name not in SECTIONS and name != "lanes"
    ]
    return page(
        "# Fields of an experiment",
        "An experiment is one YAML document, or the same in JSON: preset, export, slider and "
        "result share it. This is every field with the arm that ships; what is left out takes its "
        "default. In a patch the path of a field is the way to it, `robot.payload.mass`; of a "
        "section that has kinds, the kind is no part of the path. Where an arm has joints that "
        "slide, m and N stand for rad and N·m. *Source* tells where a default is from: "
        "[published, vendor, inferred or ours](../notation.md).",
        "## The document",
        table(HEADS, _rows(top, "")),
        "`lanes` holds up to six closed loops by name; each has a `law` and the gains of "
        "[that law](gains.md).",
        *[_section(name, whole) for name in SECTIONS],
    )


def gains_page() -> str:
    """Return the page of the gains of every law that ships."""
    whole = schema()
    parts = []
    for model, path, law in section_paths("lanes", whole):
        if law in SHIPPED:
            title = f"## {LAWS[law].title}"
            about = plain(LAWS[law].summary)
            fields = list(fields_of(model, path, whole))
            parts.append(page(title, f"{about}.", table(HEADS, _rows(fields, f"{path}."))))
    return page(
        "# Gains of the laws",
        "A lane is `law: NAME` and gains of that law: `lanes.NFTSM.nu` is the path of ν in a lane "
        "called NFTSM. [Equations](../equations.md) has every law as it is computed, "
        "[Notation](../notation.md) the symbols, and [your own law](../own-law.md) adds one.",
        *parts,
    )
