"""An experiment as YAML text, in which every number says what it is, and back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from io import StringIO
from typing import Any, get_args

from pydantic.fields import FieldInfo
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.representer import RoundTripRepresenter
from ruamel.yaml.scalarstring import DoubleQuotedScalarString, LiteralScalarString

from slidetune.robot.arm.known import arm_named
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import FORMAT, Experiment
from slidetune.robot.experiment.migration import migrated
from slidetune.robot.experiment.plain_yaml import is_plain_text, read_plain_yaml
from slidetune.robot.fields.quantity import Section
from slidetune.robot.fields.units import ANGLES, unit_of_joints
from slidetune.robot.laws import LAWS

COMMENT_COLUMN = 32

_HEADER = """\
Slidetune experiment, format {format}. Run it: python -m slidetune run FILE
A value per joint is {values}. A line that is left out keeps its
default; an unknown one is refused with its line number.
"""
_COUNTS = {2: "two", 3: "three", 4: "four", 5: "five", 6: "six", 7: "seven", 8: "eight"}
_GROUPS = ("Tag", "", "Sliding surface", "Reaching", "RBF network")
_WHERE_GIVEN = ("goals", "uncertainty")
"""Sections that are written only where they say something."""
_PROPER_NAMES = ("Coulomb",)


class _Representer(RoundTripRepresenter):
    """Writes ``null`` for None, which would otherwise be an empty place."""


_Representer.add_representer(
    type(None), lambda self, _: self.represent_scalar("tag:yaml.org,2002:null", "null")
)


def experiment_from_yaml(text: str | bytes, origin: str = "") -> Experiment:
    """Read an experiment from YAML; what the text leaves out keeps its default.

    Args:
        text: at most 64 KiB of UTF-8, one plain mapping.
        origin: where the text comes from, for messages, such as a file's name.

    Raises:
        PresetSyntaxError: when the text isn't a plain YAML mapping.
        InvalidExperimentError: naming every refused field with its line.
    """
    try:
        document = read_plain_yaml(text)
        try:
            return Experiment.from_document(migrated(document.values))
        except InvalidExperimentError as error:
            located = [replace(field, line=document.line(field.path)) for field in error.fields]
            raise InvalidExperimentError(located) from error
    except InvalidExperimentError as error:
        if origin:
            error.args = (f"{origin}: {error}",)
        raise


def experiment_to_yaml(experiment: Experiment) -> str:
    """Return an experiment as YAML that ``experiment_from_yaml`` reads back to an equal one.

    Every number carries a comment with its symbol, unit, equation and name.
    """
    document = _section(experiment, 0, arm_named(experiment.robot.model).slides)
    document.yaml_set_start_comment(_header(experiment.joints))
    yaml = YAML(pure=True)
    yaml.Representer = _Representer
    yaml.width = 1 << 20
    text = StringIO()
    yaml.dump(document, text)
    return text.getvalue()


def _header(joints: int) -> str:
    words = "both" if joints == 2 else f"all {_COUNTS.get(joints, joints)}"
    number = _COUNTS.get(joints, str(joints))
    values = f"one number for {words} or a list of {number}" if joints > 1 else "one number"
    return _HEADER.format(format=FORMAT, values=values)


def _section(section: Section, level: int, slides: Sequence[bool]) -> CommentedMap:
    """Return a section's values with their comments, nested ``level`` deep."""
    fields = type(section).model_fields
    mapping, heading = CommentedMap(), ""
    for name in sorted(fields, key=lambda name: _place(name, fields[name])):
        info, value = fields[name], getattr(section, name)
        if name in _WHERE_GIVEN and value == info.get_default(call_default_factory=True):
            continue
        mapping[name] = _plain(name, value, level, slides)
        title = _heading(info, value) if level == 0 else str(_extra(info).get("group", ""))
        if title and title != heading:
            blank = "\n" if level == 0 else ""
            mapping.yaml_set_comment_before_after_key(name, f"{blank}{title}", 2 * level)
            heading = title
        if comment := _comment(name, info, value, slides):
            mapping.yaml_add_eol_comment(comment, name, column=COMMENT_COLUMN)
    return mapping


def _place(name: str, info: FieldInfo) -> int:
    """Order: what kind it is, then group by group as on the screen, then as in the schema."""
    group = "Tag" if name in ("law", "kind") else str(_extra(info).get("group", ""))
    return _GROUPS.index(group) if group in _GROUPS else len(_GROUPS)


def _plain(name: str, value: Any, level: int, slides: Sequence[bool]) -> Any:
    if isinstance(value, Section):
        return _section(value, level + 1, slides)
    if isinstance(value, dict):
        return CommentedMap(
            (_text(key), _section(item, level + 2, slides)) for key, item in value.items()
        )
    if isinstance(value, tuple):
        items = CommentedSeq(_number(item) for item in value)
        items.fa.set_flow_style()
        return items
    if isinstance(value, str):
        return _block(value) if name == "description" or "\n" in value else _text(value)
    return _number(value)


def _number(value: Any) -> Any:
    """Write 10.0 as 10: every field takes a whole number for a real one, and it reads better."""
    whole = isinstance(value, float) and value.is_integer() and abs(value) < 1e15
    return int(value) if whole and str(value) != "-0.0" else value


def _text(value: str) -> Any:
    return value if is_plain_text(value) else DoubleQuotedScalarString(value)


def _block(value: str) -> Any:
    """Return text as a literal block where a block keeps every character of it."""
    lines = value.split("\n")
    tame = value.replace("\n", "").isprintable() and value[:1] not in ("", " ", "\n")
    # A block that keeps empty lines at its end would keep the one before the next heading too.
    tame = tame and not value.endswith("\n\n")
    if tame and not any(line.endswith(" ") for line in lines):
        return LiteralScalarString(value)
    return DoubleQuotedScalarString(value)


def _extra(info: FieldInfo) -> dict[str, Any]:
    return info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}


def _heading(info: FieldInfo, value: Any) -> str:
    if isinstance(value, Section):
        return (type(value).__doc__ or "").partition("\n")[0]
    return info.description or "" if isinstance(value, dict) else ""


def _comment(name: str, info: FieldInfo, value: Any, slides: Sequence[bool]) -> str:
    """Return symbol, unit, equation and name of a value, and the choices where it has some."""
    if name == "law":
        return LAWS[value].summary
    extra = _extra(info)
    if not extra:
        return ""
    if "unit" in extra and name not in ANGLES:
        extra = {**extra, "unit": unit_of_joints(str(extra["unit"]), slides)}
    facts = [str(extra[key]) for key in ("symbol", "unit", "equation") if key in extra]
    choices = [str(choice) for choice in get_args(info.annotation) if isinstance(choice, str)]
    title = info.title or name
    if not title.startswith(_PROPER_NAMES):
        title = title[:1].lower() + title[1:]
    if len(choices) > 1:
        title += f" ({', '.join(choices[:-1])} or {choices[-1]})"
    return f"{', '.join(facts)}: {title}" if facts else title
