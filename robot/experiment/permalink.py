"""A text short enough to paste that stands for an experiment: a shipped preset and what differs.

It reads ``1.paper.0a1b2c3d.q1bKScxLUbKqVkrLL1KyMjbQUSpOzC3IUbKqrQUA.4e5f6071``: the format, the
preset, a digest of the experiment, the difference as a merge patch (JSON, raw DEFLATE, base64url),
and a check sum of all that stands before it. Without a preset the difference is the whole document.
"""

from __future__ import annotations

import hashlib
import json
import re
import zlib
from base64 import urlsafe_b64decode, urlsafe_b64encode
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.merge_patch import difference

LONGEST = 8000
"""Characters of a link (*ours*): browsers take longer addresses, what carries them often not."""
_LONGEST_ADDRESS = LONGEST + 2000
LARGEST_PATCH = 64 * 1024
"""Bytes of the difference as JSON (*ours*), as much as a preset file may have."""
_FORMAT = "1"
_DIGITS = 8
_PARTS = re.compile(r"(\d+)\.([a-z0-9-]*)\.([0-9a-f]{8})\.([A-Za-z0-9_-]*)\.([0-9a-f]{8})")
_IN_ADDRESS = re.compile(r"(?:^|[#&])x=([^&\s]*)")


@dataclass(frozen=True)
class Linked:
    """What a link stands for.

    Attributes:
        experiment: the experiment.
        preset: name of the shipped preset from which it differs, or an empty text.
        baseline: that preset, or the experiment itself where there is none.
    """

    experiment: Experiment
    preset: str
    baseline: Experiment


def permalink(experiment: Experiment, shipped: Iterable[tuple[str, Experiment]]) -> str:
    """Return the shortest text that stands for an experiment.

    Args:
        experiment: any.
        shipped: the presets that every Slidetune of this version has, by name.

    Raises:
        InvalidExperimentError: if it would be longer than ``LONGEST``: a recorded motion, say.
    """
    wanted = _written(experiment.document())
    texts = [_text("", wanted, experiment.document())]
    for name, base in shipped:
        patch = difference(base.document(), experiment.document())
        # A patch can't change the order of lanes, for one.
        if _written(_patched(base, patch)) == wanted:
            texts.append(_text(name, wanted, patch))
    shortest = min(texts, key=len)
    if len(shortest) > LONGEST:
        text = (
            f"a link to this experiment would have {len(shortest)} characters, more than "
            f"{LONGEST}: export it as YAML"
        )
        raise InvalidExperimentError([FieldError("link", text)])
    return shortest


def read_permalink(
    link: str, shipped: Callable[[str], Experiment], despite: bool = False
) -> Linked:
    """Return what a link stands for.

    Args:
        link: the text, or an address with ``#x=`` and the text in it.
        shipped: returns the shipped preset of a name, and raises for another.
        despite: whether an experiment other than the one of which the link was made will do: where
            presets or defaults have become others since.

    Raises:
        InvalidExperimentError: naming ``link`` if it is none, was cut off or changed, or stands for
            another experiment here, and every refused field.
        UnknownPresetError: if no preset of its name ships.
    """
    if len(link) > _LONGEST_ADDRESS:
        raise _refused(f"must have at most {LONGEST} characters, got {len(link)}")
    found = _IN_ADDRESS.search(link)
    text = found[1] if found else link.strip()
    parts = _PARTS.fullmatch(text)
    if parts is None:
        raise _refused("is no link to an experiment, or was cut off: copy it again")
    version, preset, digest, data, check = parts.groups()
    if version != _FORMAT:
        raise _refused(f"has format {version}, this Slidetune reads format {_FORMAT}")
    if _digest(text.rpartition(".")[0]) != check:
        raise _refused("was cut off or changed on its way: copy it again")
    patch = _unpacked(data)
    if preset:
        baseline = shipped(preset)
        experiment = baseline.patched(patch)
    else:
        baseline = experiment = Experiment.from_document(patch)
    if not despite and _digest(_written(experiment.document())) != digest:
        whose = f"preset {preset} or defaults" if preset else "defaults"
        text = (
            f"the link was made with another version of Slidetune, whose {whose} are others: what "
            "opens here is not quite the same experiment"
        )
        raise InvalidExperimentError([FieldError("link", text, allowed="despite")])
    return Linked(experiment, preset, baseline)


def is_permalink(text: str) -> bool:
    """Tell whether a text is meant as a link and not as a preset's name or path."""
    return "#x=" in text or _PARTS.fullmatch(text) is not None


def _patched(base: Experiment, patch: Any) -> Any:
    try:
        return base.patched(patch).document()
    except InvalidExperimentError:
        return None


def _text(preset: str, wanted: str, patch: Any) -> str:
    packer = zlib.compressobj(9, wbits=-15)
    packed = packer.compress(_written(patch).encode()) + packer.flush()
    data = urlsafe_b64encode(packed).decode().rstrip("=")
    text = f"{_FORMAT}.{preset}.{_digest(wanted)}.{data}"
    return f"{text}.{_digest(text)}"


def _unpacked(data: str) -> dict[str, Any]:
    unpacker = zlib.decompressobj(wbits=-15)
    try:
        packed = urlsafe_b64decode(data + "=" * (-len(data) % 4))
        content = unpacker.decompress(packed, LARGEST_PATCH)
        patch = json.loads(content, parse_constant=_not_a_number) if unpacker.eof else None
    except (ValueError, RecursionError, zlib.error) as error:
        raise _refused("holds nothing that can be read") from error
    if not unpacker.eof:
        raise _refused(f"was cut off, or stands for more than {LARGEST_PATCH // 1024} KiB")
    if not isinstance(patch, dict):
        raise _refused("holds no experiment")
    return patch


def _not_a_number(text: str) -> float:
    raise ValueError(text)


def _written(document: Any) -> str:
    return json.dumps(document, ensure_ascii=False, separators=(",", ":"), allow_nan=False)


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]


def _refused(text: str) -> InvalidExperimentError:
    return InvalidExperimentError([FieldError("link", f"the link {text}")])
