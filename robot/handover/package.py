"""All files of a hand-over, by name."""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from slidetune.robot.arm.known import arm_named
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from slidetune.robot.handover.choices import check_exportable, choices_of, portable
from slidetune.robot.handover.conditions import Document, conditions_of
from slidetune.robot.handover.conditions_text import conditions_markdown, table_cell
from slidetune.robot.handover.gains_file import CONTROLLER, check_controller, gains_yaml
from slidetune.robot.handover.law_text import common_values, law_texts, tuned_gains
from slidetune.robot.handover.sampled_run import sampled_experiment, vectors_of
from slidetune.robot.handover.self_check import checked_vectors, loaded
from slidetune.robot.handover.template import written_text
from slidetune.robot.laws import law_of
from slidetune.robot.study.robustness import Draw

MANIFEST = "MANIFEST.sha256"
_DATE = (1980, 1, 1, 0, 0, 0)
"""Date of all files in an archive, so that the same package is the same archive (*ours*)."""


@dataclass(frozen=True)
class Package:
    """What is handed over.

    Attributes:
        files: texts by name.
        conditions: what conditions.json says.
    """

    files: dict[str, str]
    conditions: Document


def package(
    experiment: Experiment,
    name: str,
    controller: str = CONTROLLER,
    draws: Sequence[Draw] = (),
    tried: Sequence[Draw] = (),
) -> Package:
    """Return what a lane's controller is handed over by.

    The law is tried on the vectors before.

    Args:
        experiment: what was tuned.
        name: the lane.
        controller: name of the controller in gains.yaml.
        draws: of ``robustness``, of what ``sampled_experiment`` returns.
        tried: of ``worst_case`` in the same way.

    Raises:
        InvalidExperimentError: if there is no such lane, its law is of a file of one's own, the
            controller's name is none, or the arm can't follow the trajectory.
        HandOverError: if the loop leaves its bounds at once, or the law does not do as the run.
    """
    check_exportable(experiment, name)
    check_controller(controller)
    sampled = sampled_experiment(experiment, name)
    packed = pack(sampled)
    lane, arm = sampled.lanes[name], arm_named(sampled.robot.model)
    choices, gains = choices_of(lane), tuned_gains(packed, name)
    texts = law_texts(packed, name)
    vectors = checked_vectors(loaded(texts["law.py"]), vectors_of(packed, name))
    files = {
        **texts,
        "gains.yaml": gains_yaml(controller, law_of(lane).name, arm.joint_names, gains),
        "experiment.yaml": experiment_to_yaml(portable(experiment)),
        "vectors.csv": "".join(vectors.csv_lines()),
    }
    values = {
        **common_values(packed, name),
        "RATE": f"{sampled.simulation.control_rate:g}",
        "PERIOD": repr(sampled.simulation.hold),
        "ARM": arm.title,
        "JOINT_ORDER": "\n".join(
            f"| {number} | {table_cell(joint)} | {'slides' if slides else 'turns'} |"
            for number, (joint, slides) in enumerate(
                zip(arm.joint_names, arm.slides, strict=True), 1
            )
        ),
    }
    conditions = conditions_of(experiment, sampled, name, draws, tried)
    files["conditions.json"] = plain_json(conditions)
    files["conditions.md"] = conditions_markdown(conditions)
    files["README.md"] = written_text("README.md", choices, values)
    return Package(with_manifest(files), conditions)


def with_manifest(files: Mapping[str, str]) -> dict[str, str]:
    """Return files with one that has their digests, as ``sha256sum`` writes and checks it."""
    named = {name: files[name] for name in sorted(files) if name != MANIFEST}
    lines = [f"{hashlib.sha256(text.encode()).hexdigest()}  {name}" for name, text in named.items()]
    return {**named, MANIFEST: "\n".join(lines) + "\n"}


def zipped(files: Mapping[str, str], folder: str) -> bytes:
    """Return files as an archive, the same one for the same files.

    Args:
        files: by name.
        folder: the folder in the archive that they stand in.
    """
    content = io.BytesIO()
    with ZipFile(content, "w", ZIP_DEFLATED) as archive:
        for name, text in files.items():
            entry = ZipInfo(f"{folder}/{name}", _DATE)
            entry.compress_type, entry.external_attr = ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, text.encode())
    return content.getvalue()


def plain_json(document: object) -> str:
    """Return strict JSON, one value a line.

    Raises:
        ValueError: for a number that isn't finite: a mistake of ours.
    """
    return json.dumps(document, allow_nan=False, ensure_ascii=False, indent=1) + "\n"
