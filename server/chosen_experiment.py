"""What a command is about: a preset, an arm's first experiment, or a preset on another arm."""

from __future__ import annotations

from dataclasses import replace

from rich.console import Console
from rich.text import Text

from slidetune.robot.arm.kept import keep
from slidetune.robot.arm.known import add_arm, arm_named
from slidetune.robot.doctor.own import read_arm
from slidetune.robot.doctor.report import summary
from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.first_experiment.first_experiment import first_experiment
from slidetune.server.cli_options import UrdfChoice


def take_arm(choice: UrdfChoice, console: Console, kept: bool) -> str:
    """Let experiments be about an arm; return its name.

    Args:
        choice: the arm.
        console: where it is said what was found.
        kept: whether it is kept for later programs, too.

    Raises:
        RefusedArmError: if the doctor refuses it.
        ArmStorageError: if it can't be kept.
    """
    arm, examined = read_arm(
        choice.file, choice.package_dirs, choice.tip or None, choice.total_mass
    )
    if kept:
        arm = keep(arm, choice.file)
    add_arm(arm)
    console.print(Text(summary(examined)), soft_wrap=True)
    if examined.findings:
        console.print(Text(f"slidetune doctor {choice.file} tells more."), soft_wrap=True)
    how = "It is kept as" if kept else "Its name in experiments is"
    console.print(Text(f"{how} {arm.name}."), soft_wrap=True)
    return arm.name


def chosen_experiment(
    preset: str, choice: UrdfChoice | None, console: Console, kept: bool = False
) -> Experiment:
    """Return the experiment that a command is about.

    Args:
        preset: name of a preset or path of a YAML file; empty for the arm's own.
        choice: the arm of one's own, if any.
        console: where it is said what was found.
        kept: whether the arm is kept for later programs, too.

    Raises:
        InvalidExperimentError: if the preset doesn't fit the arm.
        RefusedArmError: if the doctor refuses the arm.
        UnknownPresetError: if there is no such preset.
    """
    model = take_arm(choice, console, kept) if choice is not None else ""
    if preset or not model:
        experiment = load_preset(preset or "paper")
        return on_arm(experiment, model, preset) if model else experiment
    joints = arm_named(model).joints
    text = f"Making an experiment for it; laws are compiled for {_joints(joints)} once …"
    console.print(text, soft_wrap=True)
    first = first_experiment(model)
    for remark in first.remarks:
        console.print(Text(remark, style="yellow"), soft_wrap=True)
    return first.experiment


def on_arm(experiment: Experiment, model: str, preset: str) -> Experiment:
    """Return an experiment with another arm in the place of its own.

    Args:
        experiment: the experiment.
        model: the other arm.
        preset: what the experiment is called, for the refusal.

    Raises:
        InvalidExperimentError: if something of it doesn't fit that arm; names every field.
    """
    try:
        return experiment.patched({"robot": {"model": model}})
    except InvalidExperimentError as error:
        theirs, ours = arm_named(experiment.robot.model), arm_named(model)
        text = (
            f"{preset} is an experiment for {theirs.title} with {_joints(theirs.joints)} and "
            f"doesn't fit {ours.title} with {_joints(ours.joints)}: leave the preset out for an "
            "experiment made for that arm, or change these fields"
        )
        fields = [replace(field, line=None) for field in error.fields]
        raise InvalidExperimentError([FieldError("", text), *fields]) from error


def _joints(count: int) -> str:
    return f"{count} {'joint' if count == 1 else 'joints'}"
