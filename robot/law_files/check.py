"""What a law's own file must define, looked at before anything of it is used."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import numpy as np
from pydantic import ValidationError

from slidetune.robot.fields.quantity import JOINTS, Section
from slidetune.robot.fields.refusal import field_errors
from slidetune.robot.kernels.workspace import NODES
from slidetune.robot.laws import LAWS, SHIPPED
from slidetune.robot.laws.law import Law
from slidetune.robot.laws.terms.network import NetworkGains
from slidetune.robot.laws.terms.observer import OBSERVER_MEMORY

_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")
_PARAMETERS = {"control": 5, "advance": 7}
_TAG = "law"
_FREE = {"kp", "kd"}
"""Gains that every law may call so (*ours*): nothing is read from them by their name."""


def faults(law: object) -> Iterator[str]:
    """Yield what is wrong with what a file calls its ``LAW``."""
    if not isinstance(law, Law):
        yield "defines no LAW: LAW = Law(name=…, title=…, summary=…, lane=…, control=…, …)"
        return
    yield from _name_faults(law)
    if not (isinstance(law.lane, type) and issubclass(law.lane, Section)):
        yield f"lane must be the class of its gains, a Section, got {law.lane!r}"
        return
    yield from _field_faults(law)
    yield from _function_faults("control", law.control)
    if law.advance is not None:
        yield from _function_faults("advance", law.advance)
    yield from _memory_faults(law)


def _name_faults(law: Law) -> Iterator[str]:
    if not isinstance(law.name, str) or not _NAME.fullmatch(law.name):
        yield f"name must be a to z, 0 to 9 and _, at most 40 of them, got {law.name!r}"
    elif law.name in SHIPPED:
        yield f"name {law.name} is that of a law that ships with Slidetune: choose another"
    for key in ("title", "summary"):
        if not isinstance(getattr(law, key), str) or not getattr(law, key).strip():
            yield f"{key} must be a text"


def _field_faults(law: Law) -> Iterator[str]:
    fields = law.lane.model_fields
    default = fields[_TAG].default if _TAG in fields else None
    if default != law.name:
        wanted = f'{_TAG}: Literal["{law.name}"] = "{law.name}"'
        yield f"the gains {law.lane.__name__} need the field {wanted}"
    for name, info in fields.items():
        extra = info.json_schema_extra
        if name == _TAG:
            continue
        if not isinstance(extra, dict) or not info.title or not info.description:
            yield f"gain {name} must be described by field(default, title=…, meaning=…, …)"
        elif _is_number(info.default) and not extra.keys() >= {"minimum", "maximum", "step"}:
            yield f"gain {name} needs low, high and step in its field(…): they make its slider"
        owner = _meanings().get(name)
        if owner is not None and name not in _FREE and not issubclass(law.lane, owner):
            names = " or ".join(sorted(one.__name__ for one in owner))
            yield (
                f"{name} is what Slidetune knows as a gain of {names}: inherit from there, or give "
                "it another name"
            )
    if not callable(getattr(law.lane, "pack", None)):
        yield f"the gains {law.lane.__name__} need pack(joints), which returns them as numbers"
        return
    yield from _packed_faults(law)


def _packed_faults(law: Law) -> Iterator[str]:
    try:
        lane: Any = law.lane()
    except ValidationError as error:
        yield from (f"default of {one}" for one in field_errors(error, law.lane))
        return
    for joints in (JOINTS, 2):
        yield from _block_faults(lane, joints)


def _block_faults(lane: Any, joints: int) -> Iterator[str]:
    wanted = f"pack(joints) must return float64 numbers of shape (n, joints), here (n, {joints})"
    try:
        packed = lane.pack(joints)
    except TypeError as error:
        yield f"{wanted}, and failed: {error}"
        return
    if not isinstance(packed, np.ndarray):
        yield f"{wanted}, got {type(packed).__name__}"
    elif packed.dtype != np.float64 or packed.ndim != 2 or packed.shape[1] != joints:
        yield f"{wanted}, got {packed.dtype} of shape {packed.shape}"
    elif not packed.flags.c_contiguous:
        yield f"{wanted} in one block: np.ascontiguousarray(…)"
    elif not np.isfinite(packed).all():
        yield "pack(joints) returned what is no number"


def _function_faults(name: str, function: Callable[..., Any] | None) -> Iterator[str]:
    plain = getattr(function, "py_func", function)
    count = _PARAMETERS[name]
    if not callable(plain) or len(inspect.signature(plain).parameters) != count:
        yield f"{name} must be a function of {count} arguments; see Law"


def _memory_faults(law: Law) -> Iterator[str]:
    has_network = issubclass(law.lane, NetworkGains)
    if law.network != has_network:
        yield "network must be True where the gains inherit from NetworkGains, and only there"
    room = 0 if law.network else NODES - OBSERVER_MEMORY
    if not 0 <= law.memory <= room:
        yield f"memory must be 0 to {room} rows, got {law.memory}"
    elif law.memory and law.advance is None:
        yield "memory needs advance, which moves it on"
    elif not all(0 <= row < law.memory for row in law.states):
        yield f"states must be rows of its memory, 0 to {law.memory - 1}, got {law.states}"


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


@cache
def _meanings() -> dict[str, tuple[type[Section], ...]]:
    """Return by gain the sections of the shipped laws that define it: others read it by name."""
    found: dict[str, tuple[type[Section], ...]] = {}
    for law in (LAWS[name] for name in SHIPPED):
        for section in law.lane.__mro__:
            if not issubclass(section, Section) or section is Section:
                continue
            for name in inspect.get_annotations(section):
                if name != _TAG and section not in found.get(name, ()):
                    found[name] = (*found.get(name, ()), section)
    return found
