"""Options that several commands have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

PresetOption = Annotated[str, typer.Option(help="Name of a preset, or a YAML file.")]
LawOption = Annotated[
    list[Path] | None,
    typer.Option(
        "--law",
        metavar="FILE",
        help="A law of your own, in Python; it is run as a program. May be given several times.",
    ),
]
PresetArgument = Annotated[str, typer.Argument(help="Name of a preset, or a YAML file.")]
JsonOption = Annotated[
    str, typer.Option("--json", metavar="FILE", help="Write JSON; - for standard output.")
]
CsvOption = Annotated[
    str, typer.Option("--csv", metavar="FILE", help="Write all columns; - for standard output.")
]
PageOption = Annotated[
    str, typer.Option("--html", metavar="FILE", help="Write a page of figures; works offline.")
]

console = Console(stderr=True, highlight=False)


def take_laws(paths: list[Path] | None) -> None:
    """Add the laws of the files that the command line names.

    Raises:
        LawFileError: if one of them can't be used.
    """
    if paths:
        from slidetune.server.law_files.law_files import LawFiles

        LawFiles(paths).take()


def output() -> Console:
    """Return standard output; wide where no screen limits it, so that no table is broken."""
    found = Console(highlight=False)
    return found if found.is_terminal else Console(highlight=False, width=160)
