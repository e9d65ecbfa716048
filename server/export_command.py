"""Command: export."""

from __future__ import annotations

from typing import Annotated

import typer
from rich.text import Text

from slidetune.server.cli_options import (
    LawOption,
    PackageDirOption,
    PresetArgument,
    TipOption,
    TotalMassOption,
    UrdfOption,
    WorkersOption,
    console,
    take_laws,
    urdf_choice,
)

# Everything that is slow to import waits for the command that needs it.

LOST = 3
"""Exit code where the loop that is handed over left its bounds in the simulation."""


def export(
    preset: PresetArgument,
    lane: Annotated[
        str, typer.Argument(help="Lane; by default the first one, as the preset lists them.")
    ] = "",
    to: Annotated[
        str,
        typer.Option(metavar="DIR|ZIP", help="A new or empty folder, or a file ending in .zip."),
    ] = "",
    controller: Annotated[
        str, typer.Option(metavar="NAME", help="Name of the controller in gains.yaml.")
    ] = "slidetune_controller",
    draws: Annotated[
        int,
        typer.Option(
            min=0, max=2000, help="Draws of what the experiment calls uncertain; 0 for none."
        ),
    ] = 200,
    worst: Annotated[
        int, typer.Option(min=0, max=5000, help="Tries in a search for the worst; 0 for none.")
    ] = 0,
    workers: WorkersOption = 0,
    law: LawOption = None,
    urdf: UrdfOption = None,
    package_dir: PackageDirOption = None,
    tip: TipOption = "",
    total_mass: TotalMassOption = None,
) -> None:
    """Write what a real controller needs to run a lane's gains: code, gains, conditions, a check.

    Exit status: 0 on success, 2 if something is refused, 3 if the loop left its bounds in the
    simulation; the package is written all the same, and says so.
    """
    from slidetune.robot.handover.package import package
    from slidetune.robot.handover.sampled_run import sampled_experiment
    from slidetune.server.chosen_experiment import chosen_experiment
    from slidetune.server.report.package_file import check_package_target, write_package
    from slidetune.server.report.study_bar import draws_with_bar, study_executor
    from slidetune.server.report.warmup_bar import warm_up_with_bar

    arm = urdf_choice(urdf, package_dir, tip, total_mass)
    if not to:
        raise typer.BadParameter("say where to: --to DIR, or --to FILE.zip", param_hint="--to")
    take_laws(law)
    check_package_target(to)
    experiment = chosen_experiment(preset, arm, console)
    name = lane or next(iter(experiment.lanes))
    experiment.lane(name)
    warm_up_with_bar(console, experiment.robot.model)
    wanted = draws if experiment.uncertainty.uncertain else 0
    with study_executor(workers, "", console) as executor:
        sampled = sampled_experiment(experiment, name)
        made, tried = (
            draws_with_bar(sampled, name, wanted, worst, executor, console) if wanted else ([], [])
        )
    handed = package(experiment, name, controller, made, tried)
    write_package(to, handed.files)
    for warning in handed.conditions["warnings"]:
        console.print(Text(warning, style="yellow"), soft_wrap=True)
    console.print(Text(f"{to} has {len(handed.files)} files; begin with README.md."))
    if handed.conditions["outcome"]["frozen"] is not None:
        raise typer.Exit(LOST)
