"""A file of XML as elements that know their line; nothing that could blow up is taken."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from slidetune.robot.doctor.urdf.finding import Findings
from slidetune.robot.fields.written_value import written

MOST_BYTES = 20_000_000
"""Largest file (*ours*)."""
MOST_ELEMENTS = 200_000
"""Most elements of a file (*ours*); a humanoid with both hands has some 5,000."""


@dataclass
class Element:
    """One element, without its text: URDF keeps all that counts in attributes.

    Attributes:
        tag: its name as it is written, prefix and all.
        attributes: by name.
        line: where it begins, counted from 1.
        children: in the file's order.
    """

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)

    def all(self, tag: str) -> list[Element]:
        """Return the children of this name."""
        return [child for child in self.children if child.tag == tag]

    def first(self, tag: str) -> Element | None:
        """Return the first child of this name."""
        return next((child for child in self.children if child.tag == tag), None)

    def within(self) -> list[Element]:
        """Return this element and all below it, in the file's order."""
        found, open_ones = [], [self]
        while open_ones:
            element = open_ones.pop()
            found.append(element)
            open_ones += reversed(element.children)
        return found


class _TreeError(Exception):
    """What ends the reading: text and way out."""


def _parse(data: bytes) -> Element:
    parser = expat.ParserCreate()
    top = Element("", {}, 0)
    open_ones, count = [top], 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > MOST_ELEMENTS:
            raise _TreeError(
                f"the file has more than {MOST_ELEMENTS:,} elements",
                "load a description of one arm",
            )
        element = Element(tag, attributes, parser.CurrentLineNumber)
        open_ones[-1].children.append(element)
        open_ones.append(element)

    def end(_: str) -> None:
        open_ones.pop()

    def doctype(*_: object) -> None:
        raise _TreeError(
            "the file has a DOCTYPE: entities could make a small file endless, none is read",
            "remove <!DOCTYPE …> and write out what its entities stand for",
        )

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.StartDoctypeDeclHandler = doctype
    try:
        parser.Parse(data, True)
    except _TreeError as error:
        raise _TreeError(*error.args, parser.CurrentLineNumber) from None
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        raise _TreeError(
            f"the file is no XML: {reason} at line {error.lineno}, column {error.offset + 1}",
            "load a URDF (text that begins with <?xml or <robot>); mend that place if it is one",
            error.lineno,
        ) from None
    except (LookupError, ValueError) as error:
        raise _TreeError(
            f"the file's encoding can't be read: {written(str(error))}", "save the file as UTF-8", 1
        ) from None
    return top.children[0]


def read_tree(path: Path, findings: Findings) -> Element | None:
    """Return the root element of a file.

    Args:
        path: a file of at most 20 MB.
        findings: takes what is wrong with the file as a whole.

    Returns:
        ``None`` where that was refused.
    """
    where = "file"
    try:
        size = path.stat().st_size
        if size > MOST_BYTES:
            text = f"the file has {size:,} bytes, at most {MOST_BYTES:,} are read"
            findings.refuse(where, None, text, "give the URDF itself; meshes are files beside it")
            return None
        data = path.read_bytes()
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        text = f"{written(path.name)} can't be read: {written(reason)}"
        findings.refuse(where, None, text, "give the path of a URDF file that you may read")
        return None
    try:
        return _parse(data)
    except _TreeError as error:
        text, remedy, line = error.args
        findings.refuse(where, line, text, remedy)
        return None
