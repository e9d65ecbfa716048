"""The commands about recordings: a motion made of one, logs beside lanes, what a log knows."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from slidetune.server.cli_options import (
    CsvOption,
    JsonOption,
    LawOption,
    PresetArgument,
    console,
    output,
    take_laws,
)
from slidetune.server.recordings.options import (
    AnglesOption,
    MapOption,
    RecordingArgument,
    SourceOption,
    TimeOption,
    shifts_of,
    wanted_of,
)

OutOption = Annotated[
    str, typer.Option(metavar="FILE", help="Write the changed experiment as YAML.")
]


def reference(
    preset: PresetArgument,
    recording: RecordingArgument,
    spacing: Annotated[
        float | None, typer.Option(metavar="SECONDS", help="Time between two waypoints.")
    ] = None,
    mapped: MapOption = None,
    source: SourceOption = None,
    angles: AnglesOption = "",
    time: TimeOption = "",
    out: OutOption = "",
    json: JsonOption = "",
) -> None:
    """Make a recording the desired motion of an experiment, smoothed by a spline.

    Exit status: 0, or 2 if something is refused.
    """
    from slidetune.robot.arm.known import arm_named
    from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
    from slidetune.robot.experiment.presets import load_preset
    from slidetune.robot.recordings.recording import read_recording
    from slidetune.robot.recordings.reference import reference_of
    from slidetune.server.recordings.tables import print_reference, reference_document
    from slidetune.server.report.output_file import check_outputs, write_output
    from slidetune.server.report.run_report import json_text

    experiment = load_preset(preset)
    check_outputs(json, out)
    arm = arm_named(experiment.robot.model)
    read = read_recording(recording, arm, wanted_of(mapped, source, angles, time))
    found = reference_of(read, arm, spacing)
    document = reference_document(found)
    document["remarks"] = [*read.remarks, *document["remarks"]]
    if json:
        write_output(json, [json_text({"preset": preset, **document}), "\n"])
    if out:
        write_output(out, [experiment_to_yaml(experiment.patched(found.patch()))])
    if "-" not in (json, out):
        print_reference(document, arm.slides, output())


def log(
    preset: PresetArgument,
    logs: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="Logs of the real arm, CSV or MCAP.")
    ],
    shift: Annotated[
        list[str] | None,
        typer.Option(
            metavar="SECONDS",
            help="What is added to a log's time, auto to find it; once, or for each log.",
        ),
    ] = None,
    own: Annotated[
        bool, typer.Option(help="Take the log's own desired motion where it has one.")
    ] = True,
    since: Annotated[
        float, typer.Option(min=0.0, metavar="SECONDS", help="Ignore everything before this time.")
    ] = 0.0,
    mapped: MapOption = None,
    source: SourceOption = None,
    angles: AnglesOption = "",
    time: TimeOption = "",
    json: JsonOption = "",
    law: LawOption = None,
) -> None:
    """Print the figures of logs of the real arm beside those of an experiment's lanes.

    Exit status: 0, or 2 if something is refused.
    """
    from slidetune.robot.arm.known import arm_named
    from slidetune.robot.experiment.packed import pack
    from slidetune.robot.experiment.presets import load_preset
    from slidetune.robot.logs.measured import MeasuredLane, measured_lane
    from slidetune.robot.recordings.recording import read_recording
    from slidetune.server.recordings.tables import logs_document, print_logs
    from slidetune.server.report.output_file import check_outputs, write_output
    from slidetune.server.report.run_bar import simulate_with_bar
    from slidetune.server.report.run_report import json_text, report

    take_laws(law)
    experiment = load_preset(preset)
    horizon = experiment.simulation.horizon
    if not since < horizon:
        text = f"must be less than the horizon of {horizon:g} s, got {since:g}."
        raise typer.BadParameter(text, param_hint="--since")
    check_outputs(json)
    shifts, wanted = shifts_of(shift, len(logs)), wanted_of(mapped, source, angles, time)
    packed, arm = pack(experiment), arm_named(experiment.robot.model)
    lanes: dict[str, MeasuredLane] = {}
    for path, seconds in zip(logs, shifts, strict=True):
        read = read_recording(path, arm, wanted)
        name = _free(path.name, {*experiment.lanes, *lanes})
        lanes[name] = measured_lane(read, packed, seconds, "auto" if own else "experiment")
    document = report(simulate_with_bar(experiment, console), since)
    document["logs"] = logs_document(lanes, since, horizon)
    if json:
        write_output(json, [json_text({"preset": preset, **document}), "\n"])
    if json != "-":
        print_logs(document, output())


def _free(name: str, taken: set[str]) -> str:
    number, free = 1, name
    while free in taken:
        number += 1
        free = f"{name} ({number})"
    return free


def identify(
    preset: PresetArgument,
    recording: RecordingArgument,
    fit: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PART",
            help="payload, armature, viscous_friction, coulomb_friction or constant (a constant "
            "torque); all by default. May be given several times.",
        ),
    ] = None,
    torque_constants: Annotated[
        str,
        typer.Option(
            metavar="N·m/A,...",
            help="Torque at each joint per ampere, gear included: currents count, not torques.",
        ),
    ] = "",
    bandwidth: Annotated[
        float | None, typer.Option(metavar="HZ", help="Cutoff of the filter; 10 Hz by default.")
    ] = None,
    mapped: MapOption = None,
    source: SourceOption = None,
    angles: AnglesOption = "",
    time: TimeOption = "",
    out: OutOption = "",
    json: JsonOption = "",
    csv: CsvOption = "",
) -> None:
    """Fit friction, payload and rotor inertia to a log with torques, each with its interval.

    Exit status: 0, or 2 if something is refused.
    """
    from slidetune.robot.arm.known import arm_named
    from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
    from slidetune.robot.experiment.presets import load_preset
    from slidetune.robot.identification.identify import identify as identify_arm
    from slidetune.robot.identification.numbers import PARTS
    from slidetune.robot.recordings.recording import read_recording
    from slidetune.server.recordings.tables import (
        identification_document,
        print_identification,
        residual_lines,
    )
    from slidetune.server.report.output_file import check_outputs, write_output
    from slidetune.server.report.run_report import json_text

    experiment = load_preset(preset)
    check_outputs(json, csv, out)
    constants = _numbers(torque_constants) if torque_constants else None
    arm = arm_named(experiment.robot.model)
    read = read_recording(recording, arm, wanted_of(mapped, source, angles, time))
    load = experiment.disturbance.constant
    found = identify_arm(read, experiment.robot, fit or PARTS, constants, bandwidth, load)
    if json:
        text = json_text({"preset": preset, **identification_document(found)})
        write_output(json, [text, "\n"])
    if csv:
        write_output(csv, residual_lines(found))
    if out:
        write_output(out, [experiment_to_yaml(experiment.patched(found.patch))])
    if "-" not in (json, csv, out):
        print_identification(found, arm.slides, output())


def _numbers(text: str) -> list[float]:
    try:
        return [float(one) for one in text.split(",")]
    except ValueError:
        message = f"must be numbers with commas between them, got {text!r}."
        raise typer.BadParameter(message, param_hint="--torque-constants") from None
