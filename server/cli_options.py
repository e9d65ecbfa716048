"""Options that several commands have."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

PresetOption = Annotated[
    str,
    typer.Option(
        help="Name of a preset, or a YAML file; by default paper, or with --urdf an experiment "
        "made for that arm."
    ),
]
UrdfOption = Annotated[
    Path | None,
    typer.Option(
        "--urdf", metavar="FILE", help="An arm of your own; slidetune doctor tells of it."
    ),
]
PackageDirOption = Annotated[
    list[Path] | None,
    typer.Option(
        "--package-dir",
        metavar="DIR",
        help="Folder in or beside which packages of meshes lie. May be given several times.",
    ),
]
TipOption = Annotated[
    str,
    typer.Option(metavar="LINK", help="Link at the arm's end; by default of the longest chain."),
]
TotalMassOption = Annotated[
    float | None,
    typer.Option(
        "--total-mass",
        metavar="KG",
        help="Mass of the whole arm, spread by volume over links without one.",
    ),
]
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
WorkersOption = Annotated[
    int, typer.Option(min=0, max=256, help="Threads; 0 for one a core. They change no result.")
]
CsvOption = Annotated[
    str, typer.Option("--csv", metavar="FILE", help="Write all columns; - for standard output.")
]
ParquetOption = Annotated[
    str, typer.Option("--parquet", metavar="FILE", help="Write all columns as Parquet.")
]
McapOption = Annotated[
    str,
    typer.Option(
        "--mcap", metavar="FILE", help="Write messages of ROS 2, for Foxglove and PlotJuggler."
    ),
]
ReportOption = Annotated[
    str,
    typer.Option(
        "--report",
        metavar="FILE",
        help="Write one HTML file with figures, plots, a 3D replay and the experiment; works "
        "offline.",
    ),
]
PageOption = Annotated[
    str, typer.Option("--html", metavar="FILE", help="Write a page of figures; works offline.")
]


@dataclass(frozen=True)
class UrdfChoice:
    """An arm that the command line names.

    Attributes:
        file: its URDF.
        package_dirs: folders of its packages.
        tip: link at its end; empty for the end of its longest chain.
        total_mass: of the whole arm in [kg].
    """

    file: Path
    package_dirs: tuple[Path, ...] = ()
    tip: str = ""
    total_mass: float | None = None


console = Console(stderr=True, highlight=False)


def take_laws(paths: list[Path] | None) -> None:
    """Add the laws of the files that the command line names.

    Raises:
        LawFileError: if one of them can't be used.
    """
    if paths:
        from slidetune.server.law_files.law_files import LawFiles

        LawFiles(paths).take()


def urdf_choice(
    urdf: Path | None, package_dirs: list[Path] | None, tip: str, total_mass: float | None
) -> UrdfChoice | None:
    """Return the arm that the command line names, ``None`` if it names none.

    Raises:
        typer.BadParameter: for an option that says something of an arm that isn't named.
    """
    if urdf is None:
        given = {"--package-dir": package_dirs, "--tip": tip, "--total-mass": total_mass}
        for option, value in given.items():
            if value:
                raise typer.BadParameter("says something of --urdf FILE", param_hint=option)
        return None
    return UrdfChoice(urdf, tuple(package_dirs or ()), tip, total_mass)


def arm_options(choice: UrdfChoice | None) -> list[str]:
    """Return the options that name an arm, as a command to repeat has them: files by their names.

    Args:
        choice: the arm, if one was named.
    """
    if choice is None:
        return []
    words = ["--urdf", choice.file.name]
    for folder in choice.package_dirs:
        words += ["--package-dir", folder.name or "."]
    words += ["--tip", choice.tip] if choice.tip else []
    return (
        words if choice.total_mass is None else [*words, "--total-mass", f"{choice.total_mass:g}"]
    )


def output() -> Console:
    """Return standard output; wide where no screen limits it, so that no table is broken."""
    found = Console(highlight=False)
    return found if found.is_terminal else Console(highlight=False, width=160)
