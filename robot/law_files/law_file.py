"""Reads a law from a file of one's own."""

from __future__ import annotations

import sys
from dataclasses import replace
from traceback import extract_tb
from types import ModuleType

from slidetune.robot.kernels.compiler import OWN_FILE
from slidetune.robot.law_files.check import faults
from slidetune.robot.law_files.guard import ENDLESS, EndlessLoopError, guarded
from slidetune.robot.law_files.refused import LawFileError, refused_by, trace_of
from slidetune.robot.law_files.source import Source
from slidetune.robot.laws import LAWS
from slidetune.robot.laws.law import Law

_FILES: dict[str, Source] = {}
"""Files of laws of one's own that were run in this process, by the law's version."""


def law_from(source: Source, name: str = "") -> Law:
    """Run a law's own file and return its law; nothing is added yet.

    Args:
        source: the content of the file.
        name: name of the law so far, where the file is read again.

    Raises:
        LawFileError: if it can't be run, defines no law as it must be, or one of another name.
    """
    source.keep()
    path = str(source.path)
    # Found by its name: pydantic looks up annotations there, and numba what it has kept.
    module = ModuleType(f"slidetune_law_{source.digest}")
    module.__dict__.update({"__file__": path, OWN_FILE: source.name, ENDLESS: EndlessLoopError})
    sys.modules[module.__name__] = module
    try:
        tree = guarded(source.text, path, source.name)
        exec(compile(tree, path, "exec", dont_inherit=True), module.__dict__)
        law = getattr(module, "LAW", None)
        wrong = "; ".join(faults(law))
    except Exception as error:
        raise refused_by(error, source.name, source.path) from error
    if wrong or not isinstance(law, Law):
        raise LawFileError(source.name, wrong)
    if name and law.name != name:
        text = f"its law was {name} and is {law.name} now: start anew where it has another name"
        raise LawFileError(source.name, text)
    if not name and law.name in LAWS:
        raise LawFileError(source.name, f"another file defines the law {law.name} already")
    _FILES[source.digest] = source
    return replace(law, version=source.digest)


def file_of(version: str) -> str:
    """Return the name of the file that a law's version was read from.

    Args:
        version: of a law that was read in this process.
    """
    return _FILES[version].name


def traceback_text(error: BaseException) -> str:
    """Return the lines of laws' own files through which an exception came, or an empty text."""
    names = {str(source.path): source.name for source in _FILES.values()}
    traced = any(frame.filename in names for frame in extract_tb(error.__traceback__))
    return "\n".join(trace_of(error, names)) if traced else ""
