"""The command that hands a lane over, as people run it: in a process of its own."""

from __future__ import annotations

import json
import re
from pathlib import Path
from zipfile import ZipFile

import pytest

from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from slidetune.robot.experiment.presets import load_preset
from slidetune.server.report.output_file import OutputError
from slidetune.server.report.package_file import check_package_target, write_package
from tests.own_laws import EXAMPLE
from tests.robot.handover.built import check_everywhere, run_python
from tests.server.test_cli import ROOT, slidetune

GUIDE = (ROOT / "docs" / "hand-over.md").read_text(encoding="utf-8")
GOAL = {"near": {"kind": "figure", "figure": "max_error", "bound": 0.1}}


@pytest.fixture
def uncertain(tmp_path: Path) -> Path:
    patch = {"simulation": {"horizon": 0.3}, "goals": GOAL, "uncertainty": {"payload": [0.0, 3.0]}}
    file = tmp_path / "uncertain.yaml"
    file.write_text(experiment_to_yaml(load_preset("realistic").patched(patch)), encoding="utf-8")
    return file


def test_the_guide_hands_a_lane_over(tmp_path: Path) -> None:
    command, rebuilt = (
        line.split()
        for line in re.findall(r"^```\n((?:python|make) .*)\n```$", GUIDE, re.MULTILINE)
    )
    assert command[:3] == ["python", "-m", "slidetune"]
    done = slidetune(*command[3:], folder=tmp_path)
    assert done.returncode == 0, done.stderr
    package = tmp_path / "nftsm-package"
    assert "begin with README.md" in done.stderr
    assert rebuilt == ["make", "verify", "check"]
    assert run_python(package).returncode == 0
    check_everywhere(package)
    readme = (package / "README.md").read_text(encoding="utf-8")
    for language in ("c", "python"):
        blocks = re.findall(rf"```{language}\n(.*?)```", GUIDE, re.DOTALL)
        assert len(blocks) == 1
        assert blocks[0] in readme
    named = re.findall(r"^\| (`[^|]*`) \|", GUIDE, re.MULTILINE)
    listed = {name for cell in named for name in re.findall(r"`([\w.-]+)`", cell)}
    assert listed == {file.name for file in package.iterdir()} - {"check-law", "__pycache__"}


def test_the_code_of_the_guide_compiles(tmp_path: Path) -> None:
    from slidetune.robot.experiment.packed import pack
    from slidetune.robot.handover.law_text import law_texts
    from slidetune.robot.handover.sampled_run import vectors_of

    packed = pack(load_preset("realistic"))
    texts = law_texts(packed, "NFTSM")
    (block,) = re.findall(r"```c\n(.*?)```", GUIDE, re.DOTALL)
    for name, text in {**texts, "law.c": texts["law.c"] + block}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    vectors = "".join(vectors_of(packed, "NFTSM", 20).csv_lines())
    (tmp_path / "vectors.csv").write_text(vectors, encoding="utf-8")
    check_everywhere(tmp_path)


def test_an_archive_has_what_was_drawn(uncertain: Path, tmp_path: Path) -> None:
    arguments = ("--to", "p.zip", "--draws", "4", "--worst", "3", "--controller", "mine")
    done = slidetune("export", uncertain.name, "NFTSM", *arguments, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    with ZipFile(tmp_path / "p.zip") as archive:
        conditions = json.loads(archive.read("p/conditions.json"))
        assert archive.read("p/gains.yaml").decode().splitlines()[2] == "mine:"
    robustness = conditions["robustness"]
    assert (robustness["draws"], robustness["tried_for_worst"]) == (4, 3)
    assert robustness["worst_found"] is not None


def test_a_loop_that_does_not_last_ends_with_3(tmp_path: Path) -> None:
    done = slidetune("export", "paper", "--to", "p", folder=tmp_path)
    assert done.returncode == 3, done.stderr
    assert "did not last" in done.stderr
    assert (tmp_path / "p" / "README.md").is_file()


def test_bad_arguments_are_refused(uncertain: Path, tmp_path: Path) -> None:
    (tmp_path / "own.py").write_text(EXAMPLE)
    law = re.search(r'name="(\w+)"', EXAMPLE)
    assert law
    (tmp_path / "own.yaml").write_text(f"slidetune: 1\nlanes:\n  A: {{law: {law[1]}}}\n")
    for arguments, words in {
        ("realistic",): "--to",
        ("realistic", "NFTSM", "--to", "."): "new or an empty folder",
        ("realistic", "NFTSM", "--to", "none/p"): "there is no folder",
        ("realistic", "B", "--to", "p"): "no lane is named B",
        ("realistic", "NFTSM", "--to", "p", "--controller", "a b"): "controller: must be letters",
        ("own.yaml", "A", "--law", "own.py", "--to", "p"): "only the laws that ship",
    }.items():
        done = slidetune("export", *arguments, folder=tmp_path)
        assert done.returncode == 2, done.stderr
        assert words in " ".join(done.stderr.split())
        assert not (tmp_path / "p").exists()


def test_a_package_is_there_whole_or_not_at_all(tmp_path: Path) -> None:
    folder, archive = tmp_path / "p", tmp_path / "p.zip"
    folder.mkdir()
    write_package(str(folder), {"a": "one\n"})
    assert (folder / "a").read_text() == "one\n"
    for place in (str(folder), str(folder / "a")):
        with pytest.raises(OutputError, match="new or an empty folder"):
            check_package_target(place)
    write_package(str(archive), {"a": "one\n"})
    write_package(str(archive), {"a": "two\n"})
    with ZipFile(archive) as opened:
        assert opened.read("p/a") == b"two\n"
    (tmp_path / "q.zip").mkdir()
    with pytest.raises(OutputError, match="it is a folder"):
        write_package(str(tmp_path / "q.zip"), {})
    with pytest.raises(ValueError, match="null"):
        write_package(str(tmp_path / "r"), {"a\0": ""})
    assert sorted(file.name for file in tmp_path.iterdir()) == ["p", "p.zip", "q.zip"]
