"""A study as YAML reads back as itself, whatever its title, lanes and goals are called."""

from __future__ import annotations

import json

import pytest

from slidetune.robot.experiment.plain_yaml import read_plain_yaml
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.study.study import Study
from slidetune.server.studies.download import download

NAMES = ["yes", "on", "~", "null", "1e5", "0x1F", "12:30:00", 'a "b": c', "- d # e", "=f", "é"]


@pytest.mark.parametrize("name", NAMES)
def test_what_is_written_reads_back_as_itself(name: str) -> None:
    paper = load_preset("paper")
    goals = {name: {"kind": "figure", "figure": "mae", "bound": 0.01}}
    document = {**paper.document(), "lanes": {name: {"law": "nftsm"}}, "goals": goals}
    experiment = type(paper).from_document(document)
    study = Study.from_document("tune", experiment, {"lane": name})
    title = f"two\nlines: {name}\u2028"
    content, _ = download(study, title, [], "yaml")
    found = read_plain_yaml(content).values
    assert found["title"] == title
    assert found["wanted"] == study.wanted.model_dump(mode="json")
    assert found["experiment"] == json.loads(json.dumps(experiment.document()))
