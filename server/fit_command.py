"""The command that fits numbers of an experiment to published figures."""

from __future__ import annotations

from typing import Annotated

import typer

from slidetune.server.cli_options import (
    JsonOption,
    LawOption,
    PresetArgument,
    console,
    output,
    take_laws,
)


def fit(
    preset: PresetArgument,
    study: Annotated[
        str,
        typer.Argument(
            metavar="FILE", help="YAML that says which numbers are fitted to which figures."
        ),
    ],
    trials: Annotated[int | None, typer.Option(min=1, help="How many are tried.")] = None,
    workers: Annotated[
        int, typer.Option(min=0, max=256, help="Threads; 0 for one a core. They change no result.")
    ] = 0,
    out: Annotated[
        str, typer.Option(metavar="FILE", help="Write the experiment that fits best as YAML.")
    ] = "",
    json: JsonOption = "",
    law: LawOption = None,
) -> None:
    """Find which unknown numbers of an experiment bring its figures closest to published ones.

    Exit status: 0, or 2 if something is refused.
    """
    from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
    from slidetune.robot.experiment.presets import load_preset
    from slidetune.server.report.fit_bar import fit_with_bar
    from slidetune.server.report.fit_report import fit_document, print_fit
    from slidetune.server.report.output_file import check_outputs, write_output
    from slidetune.server.report.run_report import json_text
    from slidetune.server.report.study_file import wanted_fitting

    take_laws(law)
    experiment = load_preset(preset)
    wanted = wanted_fitting(study, trials)
    check_outputs(json, out)
    document = fit_document(experiment, wanted, fit_with_bar(experiment, wanted, workers, console))
    if json:
        write_output(json, [json_text({"preset": preset, **document}), "\n"])
    if out:
        fitted = experiment.patched(document["best"]["patch"])
        write_output(out, [experiment_to_yaml(fitted)])
    if "-" not in (json, out):
        print_fit(wanted, document, output())
