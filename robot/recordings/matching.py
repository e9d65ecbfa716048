"""Which columns of a file are which quantity of which joint."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from slidetune.robot.recordings.headers import ANGLE, CURRENT, TORQUE, VELOCITY, Meaning, meaning_of
from slidetune.robot.recordings.refused import RecordingError, listed, quoted
from slidetune.robot.recordings.units import factor_of, split_unit

Slot = tuple[str, bool]
"""A quantity, and whether it is what was asked for."""

MEASURED = (ANGLE, False)
DESIRED = (ANGLE, True)
_MAPPED = {
    "": MEASURED,
    "angle": MEASURED,
    "velocity": (VELOCITY, False),
    "torque": (TORQUE, False),
    "current": (CURRENT, False),
    "desired": DESIRED,
}
_UNMAPPED = ((VELOCITY, True),)
_SLOTS = (*dict.fromkeys(_MAPPED.values()), *_UNMAPPED)
TIME = "time"
_UNITS = {
    (ANGLE, False): "angle",
    (ANGLE, True): "place",
    (VELOCITY, False): "angle rate",
    (VELOCITY, True): "place rate",
    (TORQUE, False): "torque",
    (TORQUE, True): "force",
    (CURRENT, False): "current",
    (CURRENT, True): "current",
}
"""What is measured, by quantity and whether the joint slides."""
_SI = {
    "angle": "rad",
    "place": "m",
    "angle rate": "rad/s",
    "place rate": "m/s",
    "torque": "N·m",
    "force": "N",
    "current": "A",
}


@dataclass(frozen=True)
class Layout:
    """Where everything stands in a file.

    Attributes:
        columns: number of the column of each joint, by quantity. Every list is complete.
        factors: what makes SI units of each, by quantity.
        assumed: the units taken where headers have none, by quantity.
        remarks: what was left out or assumed, in words.
    """

    columns: dict[Slot, list[int]]
    factors: dict[Slot, list[float]]
    assumed: dict[Slot, tuple[str, ...]]
    remarks: tuple[str, ...] = field(default=())


def match(
    names: Sequence[str],
    joints: Sequence[str],
    slides: Sequence[bool],
    mapping: Mapping[str, str],
    source: str | None = None,
    angles: str = "",
) -> Layout:
    """Find the columns of an arm's joints.

    Args:
        names: headers of the file.
        joints: names of the arm's joints.
        slides: which of them slide.
        mapping: header by ``joint``, ``joint.velocity``, ``joint.torque``, ``joint.current`` or
            ``joint.desired``; a joint is its name or its number from 1. It wins over what headers
            say.
        source: which columns count where several lanes or topics have all angles: what stands
            before their names.
        angles: unit of angles whose header has none.

    Raises:
        RecordingError: if not every joint has an angle, saying which columns there are; if numbers
            count from 0 to as many as there are joints, so that either end may be the one too many.
    """
    found = [meaning_of(name, joints) for name in names]
    chosen = _source(found, len(joints), source)
    given = _given(names, joints, mapping)
    columns: dict[Slot, list[int]] = {}
    remarks: list[str] = []
    for slot in dict.fromkeys(_MAPPED.values()):
        places = {**_said(found, slot, chosen, names, len(joints), given), **given.get(slot, {})}
        if len(places) == len(joints):
            columns[slot] = [places[joint] for joint in range(len(joints))]
        elif places and slot not in (MEASURED, DESIRED):
            lacking = [joints[joint] for joint in range(len(joints)) if joint not in places]
            remarks.append(f"{slot[0]} is left out: {listed(lacking)} has none")
    for slot in _UNMAPPED:
        places = _said(found, slot, chosen, names, len(joints), given)
        if len(places) == len(joints):
            columns[slot] = [places[joint] for joint in range(len(joints))]
    if MEASURED not in columns and DESIRED not in columns:
        raise _no_angles(names, joints, found, chosen, given)
    units = [
        split_unit(name).unit if meaning is None else meaning.unit
        for name, meaning in zip(names, found, strict=True)
    ]
    factors = {
        slot: [
            _factor(names[c], units[c], slot, slide, angles)
            for c, slide in zip(places, slides, strict=True)
        ]
        for slot, places in columns.items()
    }
    unused = [column for slot in _SLOTS for column in _surplus(found, slot, chosen, joints, given)]
    if unused:
        left = listed([names[column] for column in sorted(unused)])
        remarks.append(f"not used, as the arm has {len(joints)} joints: {left}")
    assumed = {
        slot: tuple(
            dict.fromkeys(
                _bare(slot, slide, angles)
                for column, slide in zip(places, slides, strict=True)
                if not units[column]
            )
        )
        for slot, places in columns.items()
    }
    return Layout(columns, factors, assumed, tuple(remarks))


def _source(found: Sequence[Meaning | None], joints: int, wanted: str | None) -> str:
    """Return which source counts: the only one with all angles, or the one that is asked for."""
    seen = Counter(
        meaning.source
        for meaning in found
        if meaning is not None and meaning.quantity == ANGLE and not meaning.reference
    )
    full = [source for source, count in seen.items() if count >= joints]
    if wanted is not None:
        text = wanted.strip("/")
        if text not in {meaning.source for meaning in found if meaning is not None}:
            raise RecordingError(
                f"no columns of {quoted(wanted)}: there are {listed(full) or 'none'}",
                names=tuple(full),
            )
        return text
    if len(full) > 1:
        raise RecordingError(
            f"there are the angles of {listed(full)}: say whose count by naming one as the source",
            names=tuple(full),
        )
    return full[0] if full else ""


def _said(
    found: Sequence[Meaning | None],
    slot: Slot,
    source: str,
    names: Sequence[str],
    joints: int,
    given: Mapping[Slot, Mapping[int, int]],
) -> dict[int, int]:
    """Return the column of each joint, as far as headers say it."""
    fitting = _fitting(found, slot, source)
    begin = _first(fitting)
    taken = _taken(given)
    numbers = {meaning.index for column, meaning in fitting if column not in taken}
    if numbers == set(range(joints + 1)) and len(given.get(slot, {})) < joints:
        headers = listed([names[column] for column, _ in fitting])
        raise RecordingError(
            f"{headers}: numbers from 0 to {joints} for {joints} joints, of which the first or the "
            "last may be the one too many: say by a mapping which column is which joint's",
            names=tuple(names),
        )
    places: dict[int, int] = {}
    for column, meaning in fitting:
        joint = meaning.joint if meaning.index is None else meaning.index - begin
        if joint is None or joint >= joints or column in taken:
            continue
        other = places.get(joint)
        if other is not None and joint not in given.get(slot, {}):
            raise RecordingError(
                f"{quoted(names[other])} and {quoted(names[column])} are both the {slot[0]} of "
                f"joint {joint + 1}: say by a mapping which one counts",
                column=names[column],
                names=tuple(names),
            )
        places[joint] = column
    return places


def _fitting(found: Sequence[Meaning | None], slot: Slot, source: str) -> list[tuple[int, Meaning]]:
    """Return the columns of a quantity, of any joint."""
    return [
        (column, meaning)
        for column, meaning in enumerate(found)
        if meaning is not None
        and (meaning.quantity, meaning.reference) == slot
        and meaning.source in (source, "")
    ]


def _first(fitting: Sequence[tuple[int, Meaning]]) -> int:
    """Return from which number on the columns of a quantity count."""
    return 0 if any(meaning.index == 0 for _, meaning in fitting) else 1


def _taken(given: Mapping[Slot, Mapping[int, int]]) -> set[int]:
    return {column for places in given.values() for column in places.values()}


def _surplus(
    found: Sequence[Meaning | None],
    slot: Slot,
    source: str,
    joints: Sequence[str],
    given: Mapping[Slot, Mapping[int, int]],
) -> list[int]:
    """Return the columns of a quantity whose number is beyond the arm's joints."""
    fitting, taken = _fitting(found, slot, source), _taken(given)
    last = _first(fitting) + len(joints) - 1
    return [
        column
        for column, meaning in fitting
        if meaning.index is not None and meaning.index > last and column not in taken
    ]


def _given(
    names: Sequence[str], joints: Sequence[str], mapping: Mapping[str, str]
) -> dict[Slot, dict[int, int]]:
    given: dict[Slot, dict[int, int]] = {}
    for key, header in mapping.items():
        if key.lower() == TIME:
            continue
        joint, slot = _key(key, joints)
        given.setdefault(slot, {})[joint] = column_named(header, names)
    return given


def _key(key: str, joints: Sequence[str]) -> tuple[int, Slot]:
    known = {name.lower(): joint for joint, name in enumerate(joints)}
    known |= {str(joint + 1): joint for joint in range(len(joints))}
    name, _, quantity = key.lower().rpartition(".")
    if key.lower() in known:
        return known[key.lower()], MEASURED
    if name in known and quantity in _MAPPED:
        return known[name], _MAPPED[quantity]
    raise RecordingError(
        f"a mapping names {quoted(key)}: it may name time or a joint ({listed(list(joints))}), "
        f"with .velocity, .torque, .current or .desired behind it"
    )


def column_named(header: str, names: Sequence[str]) -> int:
    """Return a column by its header, with or without its unit.

    Raises:
        RecordingError: if there is none, or are several; lists those that there are.
    """
    wanted = header.strip().lower()
    for spelt in (lambda name: name.strip().lower(), lambda name: split_unit(name).name.lower()):
        found = [column for column, name in enumerate(names) if spelt(name) == wanted]
        if len(found) == 1:
            return found[0]
        if found:
            raise RecordingError(f"{len(found)} columns are called {quoted(header)}")
    raise RecordingError(
        f"no column is called {quoted(header)}: there are {listed(list(names))}", names=tuple(names)
    )


def _factor(name: str, unit: str, slot: Slot, slides: bool, angles: str) -> float:
    measured = _UNITS[slot[0], slides]
    factor = factor_of(unit or _bare(slot, slides, angles), measured)
    if factor is None:
        raise RecordingError(
            f"its unit {quoted(unit)} is none of {measured}: write it as q1 [rad] or q1 [deg], "
            "v1 [rad/s], tau1 [N·m], i1 [A]; m, m/s and N where a joint slides",
            column=name,
        )
    return factor


def _bare(slot: Slot, slides: bool, angles: str) -> str:
    """Return the unit of a quantity without one: angles' own, and per second, of what turns."""
    measured = _UNITS[slot[0], slides]
    if angles and measured in ("angle", "angle rate"):
        return angles if measured == "angle" else f"{angles}/s"
    return _SI[measured]


def _no_angles(
    names: Sequence[str],
    joints: Sequence[str],
    found: Sequence[Meaning | None],
    source: str,
    given: Mapping[Slot, Mapping[int, int]],
) -> RecordingError:
    places = {**_said(found, MEASURED, source, names, len(joints), given)}
    places |= given.get(MEASURED, {})
    lacking = [name for joint, name in enumerate(joints) if joint not in places]
    return RecordingError(
        f"no column is known to hold the angle of {listed(lacking)}. There are "
        f"{listed(list(names))}. Call them like the joints, or q1 to q{len(joints)}, or map them "
        f"by name: {lacking[0]}=COLUMN",
        names=tuple(names),
    )
