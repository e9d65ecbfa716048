"""Options that several commands have."""

from __future__ import annotations

from typing import Annotated

import typer
from rich.console import Console

PresetOption = Annotated[str, typer.Option(help="Name of a preset, or a YAML file.")]
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


def output() -> Console:
    """Return standard output; wide where no screen limits it, so that no table is broken."""
    found = Console(highlight=False)
    return found if found.is_terminal else Console(highlight=False, width=160)
