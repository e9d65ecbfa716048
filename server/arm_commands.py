"""Commands about arms: doctor, arms, arm add, arm remove."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich import box
from rich.table import Table
from rich.text import Text

from slidetune.server.cli_options import (
    JsonOption,
    PackageDirOption,
    TipOption,
    TotalMassOption,
    console,
    output,
)

# Everything that is slow to import waits for the command that needs it.

REFUSED = 2
"""Exit code where a description holds no arm that can be loaded."""

UrdfArgument = Annotated[Path, typer.Argument(metavar="FILE", help="A URDF.")]

arm_cli = typer.Typer(help="Keep arms of your own, and remove them.", no_args_is_help=True)


def doctor(
    file: UrdfArgument,
    package_dir: PackageDirOption = None,
    tip: TipOption = "",
    total_mass: TotalMassOption = None,
    json: JsonOption = "",
) -> None:
    """Examine a URDF: what is missing or wrong, what would be assumed, and ways out.

    Exit status: 0 where it holds an arm that can be loaded, 2 where not.
    """
    from slidetune.robot.doctor.examine import examine
    from slidetune.robot.doctor.report import examined_document, report
    from slidetune.server.report.output_file import check_outputs, write_output
    from slidetune.server.report.run_report import json_text

    check_outputs(json)
    found = examine(file, package_dir or (), tip or None, total_mass)
    if json:
        write_output(json, [json_text(examined_document(found)), "\n"])
    if json != "-":
        screen = output()
        screen.print(Text(report(found, screen.width)), end="", soft_wrap=True)
    if found.arm is None:
        raise typer.Exit(REFUSED)


def arms(json: JsonOption = "") -> None:
    """List all arms that an experiment can be about: robot.model names one."""
    from dataclasses import asdict

    from slidetune.robot.arm.kept import KeptArm, kept_arms
    from slidetune.robot.arm.known import shipped_arms
    from slidetune.server.report.output_file import check_outputs, write_output
    from slidetune.server.report.run_report import json_text

    check_outputs(json)
    shipped = [
        KeptArm(arm.name, arm.title, arm.meaning, arm.joints) for arm in shipped_arms().values()
    ]
    own = kept_arms()
    if json:
        listed = [{**asdict(arm), "shipped": arm in shipped} for arm in (*shipped, *own)]
        write_output(json, [json_text({"arms": listed}), "\n"])
    if json == "-":
        return
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in ("robot.model", "arm", "joints", "what it is"):
        table.add_column(Text(heading), overflow="fold")
    for arm in (*shipped, *own):
        what = Text(arm.problem, style="red") if arm.problem else Text(arm.meaning)
        table.add_row(Text(arm.name), Text(arm.title), str(arm.joints or ""), what)
    output().print(table)


@arm_cli.command()
def add(
    file: UrdfArgument,
    package_dir: PackageDirOption = None,
    tip: TipOption = "",
    total_mass: TotalMassOption = None,
    title: Annotated[str, typer.Option(help="Name on the screen.")] = "",
) -> None:
    """Keep the arm of a URDF with the meshes that are drawn of it.

    Exit status: 0, or 2 where the doctor refuses it.
    """
    from slidetune.robot.arm.kept import arm_folder, keep
    from slidetune.robot.doctor.own import read_arm
    from slidetune.robot.doctor.report import report

    arm, examined = read_arm(file, package_dir or (), tip or None, total_mass, title)
    kept = keep(arm, file)
    console.print(Text(report(examined, console.width)), end="", soft_wrap=True)
    folder = arm_folder() / kept.name
    console.print(Text(f"It is kept as {kept.name}, in {folder}."), soft_wrap=True)
    output().print(Text(kept.name))


@arm_cli.command()
def remove(
    name: Annotated[str, typer.Argument(help="The arm, as slidetune arms lists it.")],
) -> None:
    """Remove an arm that is kept. Presets that are about it can't be loaded any more."""
    from slidetune.robot.arm import kept

    if not kept.remove(name):
        known = ", ".join(kept.kept_names()) or "none"
        raise typer.BadParameter(f"no arm {name} is kept; kept are: {known}", param_hint="NAME")
    console.print(Text(f"{name} is removed."), soft_wrap=True)
