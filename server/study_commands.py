"""Commands that make many runs: tune, robustness, sweep."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Annotated

import typer

from slidetune.server.cli_options import (
    CsvOption,
    JsonOption,
    LawOption,
    PackageDirOption,
    ParquetOption,
    PresetArgument,
    TipOption,
    TotalMassOption,
    UrdfOption,
    WorkersOption,
    console,
    output,
    take_laws,
    urdf_choice,
)

if TYPE_CHECKING:
    from slidetune.robot.experiment.document import Experiment
    from slidetune.robot.study.study import Entry
    from slidetune.robot.study.sweep import Axis

# Everything that is slow to import waits for the command that needs it.

MISSED = 4
"""Exit code where a hard goal is not kept."""

LaneOption = Annotated[
    str, typer.Option(help="Lane; by default the first one, as the preset lists them.")
]
SchedulerOption = Annotated[
    str,
    typer.Option(
        metavar="ADDRESS",
        help="Scheduler of a Dask cluster that makes the runs in place of this machine, such as "
        "tcp://10.0.0.1:8786.",
    ),
]


def _executor(workers: int, scheduler: str) -> AbstractContextManager[Executor]:
    """Return where the runs are made; see ``study_executor``."""
    from slidetune.server.report.study_bar import study_executor

    if scheduler and workers:
        raise typer.BadParameter(
            "runs are made by threads of this machine (--workers) or by a cluster, not both",
            param_hint="--scheduler",
        )
    return study_executor(workers, scheduler, console)


def _write_tables(
    experiment: Experiment,
    entries: Sequence[Entry],
    csv: str,
    parquet: str,
    axes: Sequence[Axis] = (),
) -> None:
    """Write what was tried, one row each, to where it is asked for."""
    from slidetune.server.report.output_file import write_output
    from slidetune.server.studies.download import csv_of, parquet_of

    if csv:
        write_output(csv, [csv_of(experiment, entries, axes)])
    if parquet:
        write_output(parquet, [parquet_of(experiment, entries, axes)])


def tune(
    preset: PresetArgument,
    lane: LaneOption = "",
    study: Annotated[
        str,
        typer.Option(
            metavar="FILE",
            help="YAML that says what is searched: gains with their ranges, sampler, trials, "
            "draws, judged_by, quiet, seed. Options given here count more.",
        ),
    ] = "",
    trials: Annotated[int | None, typer.Option(min=1, help="Sets of gains that are tried.")] = None,
    sampler: Annotated[str | None, typer.Option(help="cmaes, tpe, nsga2 or sobol.")] = None,
    draws: Annotated[
        int | None,
        typer.Option(
            min=0,
            help="Draws of what is uncertain that judge each set; 0 for the experiment as it is. "
            "By default 50 where anything is uncertain.",
        ),
    ] = None,
    judged_by: Annotated[str | None, typer.Option(help="Draw that counts: worst or p95.")] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="The same one, the same trials.")] = None,
    quiet: Annotated[
        bool | None,
        typer.Option(
            "--quiet/--any-chattering",
            help="Whether gains that chatter more than the present ones, at the same draw, are "
            "never the best; by default they are not.",
        ),
    ] = None,
    workers: WorkersOption = 0,
    scheduler: SchedulerOption = "",
    out: Annotated[
        str, typer.Option(metavar="FILE", help="Write the experiment with the best gains as YAML.")
    ] = "",
    csv: CsvOption = "",
    parquet: ParquetOption = "",
    json: JsonOption = "",
    law: LawOption = None,
    urdf: UrdfOption = None,
    package_dir: PackageDirOption = None,
    tip: TipOption = "",
    total_mass: TotalMassOption = None,
) -> None:
    """Search for the gains of a lane that keep to the experiment's goals.

    Ctrl-C stops it and keeps what is done, as does the loss of the cluster. Exit status: 0 where
    the best gains keep every hard goal, 4 where none do, 2 if something is refused or the cluster
    is lost.
    """
    from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
    from slidetune.server.chosen_experiment import chosen_experiment
    from slidetune.server.report.output_file import check_outputs, write_output
    from slidetune.server.report.run_report import json_text
    from slidetune.server.report.study_bar import search_with_bar
    from slidetune.server.report.study_file import wanted_tuning
    from slidetune.server.report.study_report import print_tuning, tuning_document

    arm = urdf_choice(urdf, package_dir, tip, total_mass)
    take_laws(law)
    experiment = chosen_experiment(preset, arm, console)
    given = {
        "lane": lane or None,
        "trials": trials,
        "sampler": sampler,
        "draws": draws,
        "judged_by": judged_by,
        "seed": seed,
        "quiet": quiet,
    }
    wanted = wanted_tuning(experiment, study, given)
    check_outputs(csv, parquet, json, out)
    with _executor(workers, scheduler) as executor:
        made, lost = search_with_bar(experiment, wanted, executor, console)
    document = tuning_document(experiment, wanted, made)
    _write_tables(experiment, made, csv, parquet)
    if json:
        write_output(json, [json_text({"preset": preset, **document}), "\n"])
    if out and document["best"]:
        write_output(out, [experiment_to_yaml(experiment.patched(document["best"]["patch"]))])
    if "-" not in (csv, parquet, json, out):
        print_tuning(experiment, document, output())
    if lost:
        console.print(f"The cluster was lost after {len(made)} trials; what is done is kept.")
        raise lost
    if not (document["best"] and document["best"]["outcome"]["kept"]):
        raise typer.Exit(MISSED)


def robustness(
    preset: PresetArgument,
    lane: LaneOption = "",
    draws: Annotated[int, typer.Option(min=1, max=2000, help="Draws of what is uncertain.")] = 200,
    worst: Annotated[
        int, typer.Option(min=0, max=5000, help="Tries in a search for the worst; 0 for none.")
    ] = 0,
    workers: WorkersOption = 0,
    scheduler: SchedulerOption = "",
    csv: CsvOption = "",
    parquet: ParquetOption = "",
    json: JsonOption = "",
    law: LawOption = None,
    urdf: UrdfOption = None,
    package_dir: PackageDirOption = None,
    tip: TipOption = "",
    total_mass: TotalMassOption = None,
) -> None:
    """Run a lane at many draws of what the experiment calls uncertain.

    Exit status: 0 where every draw keeps every hard goal, 4 where one does not, 2 if something is
    refused or the cluster is lost.
    """
    from slidetune.server.chosen_experiment import chosen_experiment
    from slidetune.server.report.output_file import check_outputs, write_output
    from slidetune.server.report.run_report import json_text
    from slidetune.server.report.study_bar import draws_with_bar
    from slidetune.server.report.study_report import print_robustness, robustness_document

    arm = urdf_choice(urdf, package_dir, tip, total_mass)
    take_laws(law)
    experiment = chosen_experiment(preset, arm, console)
    name = lane or next(iter(experiment.lanes))
    check_outputs(csv, parquet, json)
    with _executor(workers, scheduler) as executor:
        made, tried = draws_with_bar(experiment, name, draws, worst, executor, console)
    document = robustness_document(experiment, name, made, tried)
    _write_tables(experiment, made, csv, parquet)
    if json:
        write_output(json, [json_text({"preset": preset, **document}), "\n"])
    if "-" not in (csv, parquet, json):
        print_robustness(experiment, document, output())
    if not all(one.outcome.kept for one in (*made, *tried)):
        raise typer.Exit(MISSED)


def sweep(
    preset: PresetArgument,
    axes: Annotated[
        list[str],
        typer.Argument(
            metavar="FIELD=LOW:HIGH:COUNT[:log]...",
            help="One or two: a gain of the lane, or a path such as robot.payload.mass.",
        ),
    ],
    lane: LaneOption = "",
    workers: WorkersOption = 0,
    scheduler: SchedulerOption = "",
    csv: CsvOption = "",
    parquet: ParquetOption = "",
    json: JsonOption = "",
    law: LawOption = None,
    urdf: UrdfOption = None,
    package_dir: PackageDirOption = None,
    tip: TipOption = "",
    total_mass: TotalMassOption = None,
) -> None:
    """Run a lane at every combination of the values of one or two fields.

    Exit status: 0, or 2 if something is refused or the cluster is lost.
    """
    from slidetune.server.chosen_experiment import chosen_experiment
    from slidetune.server.report.output_file import check_outputs, write_output
    from slidetune.server.report.run_report import json_text
    from slidetune.server.report.study_bar import sweep_with_bar
    from slidetune.server.report.study_file import wanted_axes
    from slidetune.server.report.study_report import print_sweep, sweep_document

    arm = urdf_choice(urdf, package_dir, tip, total_mass)
    take_laws(law)
    experiment, found = chosen_experiment(preset, arm, console), wanted_axes(axes)
    name = lane or next(iter(experiment.lanes))
    check_outputs(csv, parquet, json)
    with _executor(workers, scheduler) as executor:
        points = sweep_with_bar(experiment, name, found, executor, console)
    _write_tables(experiment, points, csv, parquet, found)
    if json:
        document = sweep_document(experiment, name, found, points)
        write_output(json, [json_text({"preset": preset, **document}), "\n"])
    if "-" not in (csv, parquet, json):
        print_sweep(experiment, found, points, output())
