"""Commands: serve, run, paper, bench; studies; export; arms; recordings."""

from __future__ import annotations

import io
import sys
from typing import Annotated

import typer
from rich.text import Text

from slidetune.server.arm_commands import arm_cli, arms, doctor
from slidetune.server.cli_options import (
    CsvOption,
    JsonOption,
    LawOption,
    McapOption,
    PackageDirOption,
    PageOption,
    ParquetOption,
    PresetOption,
    ReportOption,
    TipOption,
    TotalMassOption,
    UrdfOption,
    arm_options,
    console,
    output,
    take_laws,
    urdf_choice,
)
from slidetune.server.export_command import export
from slidetune.server.fit_command import fit
from slidetune.server.recording_commands import identify, log, reference
from slidetune.server.study_commands import robustness, sweep, tune

# Everything that is slow to import waits for the command that needs it.

BAD_INPUT = 2
"""Exit code where a value, a file or a name is refused."""
DIVERGED = 3
"""Exit code of ``run`` where a lane left its bounds."""

cli = typer.Typer(
    help="Tune sliding-mode controllers of a robot arm in the browser.",
    add_completion=False,
    no_args_is_help=False,
    pretty_exceptions_enable=False,
)
HostOption = Annotated[
    str,
    typer.Option(help="Address to bind to; 0.0.0.0 for all. Any but loopback requires a token."),
]
TokenOption = Annotated[
    bool,
    typer.Option("--token", help="Require a token on loopback too, such as behind a TLS proxy."),
]
Port = Annotated[
    int, typer.Option(min=0, max=65535, help="Port; the next free one if it is taken.")
]


@cli.callback(invoke_without_command=True)
def default(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    """Serve the dashboard where no command is given."""
    if version:
        from slidetune.robot.version import __version__

        print(__version__)
        raise typer.Exit
    if context.invoked_subcommand is None:
        serve()


@cli.command()
def serve(
    host: HostOption = "127.0.0.1",
    port: Port = 8000,
    preset: PresetOption = "",
    browser: Annotated[bool, typer.Option(help="Open the dashboard in a browser.")] = True,
    token: TokenOption = False,
    scheduler: Annotated[
        str, typer.Option(metavar="ADDRESS", help="Cluster that makes the runs of studies (Dask).")
    ] = "",
    law: LawOption = None,
    urdf: UrdfOption = None,
    package_dir: PackageDirOption = None,
    tip: TipOption = "",
    total_mass: TotalMassOption = None,
) -> None:
    """Serve the dashboard.

    An arm of one's own that --urdf names is kept: presets about it can be loaded later without.

    Prints the address to open. Where it asks for a token there are two of them, new at every
    start: the owner's, and one with which others may watch but change nothing.
    """
    from slidetune.robot.experiment.preset_name import is_preset_name
    from slidetune.server.chosen_experiment import chosen_experiment
    from slidetune.server.hosting.end_of_process import end_on_sigterm
    from slidetune.server.law_files.law_files import LawFiles
    from slidetune.server.report.warmup_bar import warm_up_with_bar
    from slidetune.server.serve import serve as serve_dashboard

    end_on_sigterm()
    law_files = LawFiles(law or [])
    law_files.take(apart=True)
    arm = urdf_choice(urdf, package_dir, tip, total_mass)
    experiment = chosen_experiment(preset, arm, console, kept=True)
    warm_up_with_bar(console, experiment.robot.model)
    named = preset or "paper"
    name = named if arm is None and is_preset_name(named) else ""
    serve_dashboard(experiment, name, host, port, browser, token, scheduler, law_files)


@cli.command()
def run(
    preset: Annotated[
        str,
        typer.Argument(
            help="Name of a preset, or a YAML file; with --urdf by default an experiment made for "
            "that arm."
        ),
    ] = "",
    since: Annotated[
        float, typer.Option(min=0.0, metavar="SECONDS", help="Ignore everything before this time.")
    ] = 0.0,
    json: JsonOption = "",
    csv: CsvOption = "",
    parquet: ParquetOption = "",
    mcap: McapOption = "",
    report: ReportOption = "",
    law: LawOption = None,
    urdf: UrdfOption = None,
    package_dir: PackageDirOption = None,
    tip: TipOption = "",
    total_mass: TotalMassOption = None,
) -> None:
    """Run an experiment over its horizon and print the figures of every lane.

    Exit status: 0 on success, 2 if something is refused, 3 if a lane left its bounds.
    """
    from slidetune.server.chosen_experiment import chosen_experiment
    from slidetune.server.exports.formats import written_as
    from slidetune.server.exports.mcap_file import mcap_of
    from slidetune.server.exports.recorded_run import recorded_run
    from slidetune.server.report.output_file import check_outputs, write_output
    from slidetune.server.report.run_bar import progress_bar, simulate_with_bar
    from slidetune.server.report.run_report import json_text, print_report
    from slidetune.server.report.run_report import report as report_of
    from slidetune.server.run_report.page import run_report
    from slidetune.server.run_report.recording import record

    arm = urdf_choice(urdf, package_dir, tip, total_mass)
    if not preset and arm is None:
        raise typer.BadParameter("give a preset, a YAML file, or --urdf FILE", param_hint="PRESET")
    take_laws(law)
    experiment = chosen_experiment(preset, arm, console)
    horizon = experiment.simulation.horizon
    if not since < horizon:
        text = f"must be less than the horizon of {horizon:g} s, got {since:g}."
        raise typer.BadParameter(text, param_hint="--since")
    check_outputs(json, csv, parquet, mcap, report)
    result = simulate_with_bar(experiment, console)
    document = report_of(result, since)
    if json:
        write_output(json, [json_text({"preset": preset, **document}), "\n"])
    recorded = recorded_run(result)
    if csv:
        write_output(csv, written_as(recorded, "csv"))
    if parquet:
        write_output(parquet, written_as(recorded, "parquet"))
    if mcap:
        with progress_bar(console, "Writing MCAP") as show:
            write_output(mcap, [mcap_of(recorded, show)])
    if report:
        named = arm_options(arm)
        write_output(report, [run_report(result, document, record, named).html])
    if "-" not in (json, csv, parquet, mcap, report):
        print_report(document, output())
    if any(lane.freeze for lane in result.lanes.values()):
        raise typer.Exit(DIVERGED)


@cli.command()
def paper(html: PageOption = "") -> None:
    """Compare with the published Table 2, and draw Figures 4 to 15 and 17 to 19."""
    from slidetune.server.report.output_file import check_outputs, write_output
    from slidetune.server.report.paper_figures import paper_page
    from slidetune.server.report.paper_table import PRESETS, print_comparison
    from slidetune.server.report.run_bar import simulate_presets

    check_outputs(html)
    runs = simulate_presets(PRESETS, console)
    if html:
        write_output(html, [paper_page(runs)])
    if html != "-":
        print_comparison(runs, output())


@cli.command()
def bench(
    quick: Annotated[
        bool, typer.Option("--quick", help="Takes seconds, not minutes; noisy.")
    ] = False,
    live: Annotated[bool, typer.Option(help="Measure a running server as well.")] = True,
    json: JsonOption = "",
) -> None:
    """Measure the control step, whole runs and the live session on this machine."""
    from slidetune.server.bench.table import bench_text, measure, print_bench
    from slidetune.server.report.output_file import check_outputs, write_output
    from slidetune.server.report.warmup_bar import warm_up_with_bar

    check_outputs(json)
    warm_up_with_bar(console)
    results = measure(quick, live, console)
    if json:
        write_output(json, [bench_text(results), "\n"])
    if json != "-":
        print_bench(results, output())


for command in (tune, robustness, sweep, fit, export, doctor, arms, reference, log, identify):
    cli.command()(command)
cli.add_typer(arm_cli, name="arm")


def _tell(error: Exception) -> None:
    console.print(Text("Error: ", style="red"), Text(str(error)), sep="", soft_wrap=True)


def main() -> None:
    """Run the command line; errors of ours are told in words, without a traceback."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a console that knows no Greek still gets numbers
    try:
        cli()
    except Exception as error:
        from slidetune.robot.errors import SlidetuneError

        if not isinstance(error, SlidetuneError | OSError):
            raise
        _tell(error)
        sys.exit(BAD_INPUT if isinstance(error, SlidetuneError) else 1)
