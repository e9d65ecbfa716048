"""What a hand-over says, and that it is checked."""

from __future__ import annotations

import dataclasses
import io
import json
import re
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest
from ruamel.yaml import YAML

from slidetune.robot.arm.known import arm_named
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.handover.choices import gains_of
from slidetune.robot.handover.gains_file import gains_yaml
from slidetune.robot.handover.law_text import law_texts, tuned_gains
from slidetune.robot.handover.package import Package, package, zipped
from slidetune.robot.handover.sampled_run import sampled_experiment, vectors_of
from slidetune.robot.handover.self_check import HandOverError, checked_vectors, loaded
from slidetune.robot.laws.smc import Smc
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.margins.margin import loop_margin
from slidetune.robot.study.robustness import robustness
from tests.own_laws import EXAMPLE, own_laws
from tests.robot.handover.built import check_everywhere, compilers, run, run_python, written

LANE = "NFTSM"
GOALS: dict[str, Any] = {
    "near": {"kind": "figure", "figure": "max_error", "bound": 1e-6},
    "quiet": {"kind": "figure", "figure": "chattering", "bound": 1e6, "priority": "hard"},
    "a | b": {"kind": "response", "channel": "e", "bound": 1.0},
}


def short(preset: str, **sections: Any) -> Experiment:
    return load_preset(preset).patched({"simulation": {"horizon": 0.5}, **sections})


@pytest.fixture(scope="module")
def handed() -> Package:
    return package(short("realistic", goals=GOALS), LANE)


@pytest.fixture
def folder(handed: Package, tmp_path: Path) -> Path:
    return written(handed.files, tmp_path / "package")


def test_it_checks_itself_by_make(handed: Package, folder: Path) -> None:
    if not compilers():
        pytest.skip("no C compiler: neither gcc nor clang nor cc is there")
    for compiler in compilers():
        done = run("make", "-B", "check-c", f"CC={compiler}", folder=folder)
        assert done.returncode == 0, done.stdout + done.stderr
    assert run_python(folder).returncode == 0
    done = run("make", "check", f"PYTHON={sys.executable}", folder=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("they agree") == 2
    bare = run("make", "check", f"PYTHON={sys.executable} -S", folder=folder)
    assert bare.returncode != 0
    assert "has no NumPy, which law.py needs: make check PYTHON=" in bare.stderr
    assert "Traceback" not in bare.stderr
    done = run("make", "verify", folder=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count(": OK") == len(handed.files) - 1  # all but itself


def test_the_check_fails_where_a_gain_is_not_the_tuned_one(folder: Path) -> None:
    for name, digit in (("law.c", r"(\.nu = \{)\d+"), ("law.py", r"(nu=np\.array\(\[)\d+")):
        text, count = re.subn(digit, r"\g<1>77", (folder / name).read_text(), count=1)
        assert count == 1
        (folder / name).write_text(text)
    done = run_python(folder)
    assert (done.returncode, "THEY DIFFER" in done.stdout) == (1, True)
    if compilers():
        with pytest.raises(AssertionError, match="THEY DIFFER"):
            check_everywhere(folder)
    assert run("make", "verify", folder=folder).returncode != 0


def test_the_experiment_is_the_one_that_was_tuned(handed: Package) -> None:
    assert experiment_from_yaml(handed.files["experiment.yaml"]) == short("realistic", goals=GOALS)


def test_the_gains_are_parameters_of_ros(handed: Package) -> None:
    document = YAML(typ="safe").load(handed.files["gains.yaml"])
    parameters = document["slidetune_controller"]["ros__parameters"]
    lane, arm = short("realistic").lanes[LANE], arm_named("jaka_zu5")
    assert parameters["joints"] == list(arm.joint_names)
    assert (parameters["law"], parameters["period"]) == ("nftsm", 0.001)
    assert parameters["torque_limit"] == [150.0, 150.0, 150.0, 28.0, 28.0, 28.0]
    for name, values in parameters["gains"].items():
        assert values == np.broadcast_to(getattr(lane, name), 6).tolist()
    # A list of whole numbers is another type there.
    assert re.findall(r"(?<=[\[ ])-?\d+(?=[,\]])", handed.files["gains.yaml"]) == []


def test_every_number_of_ros_is_a_real_one() -> None:
    gains = gains_of(Smc(epsilon=1e-4, k1=1000.0), 2, (False, False))
    texts = gains_yaml("a", "smc", ["a: b", 'c"'], gains)
    parameters = YAML(typ="safe").load(texts)["a"]["ros__parameters"]
    assert parameters["joints"] == ["a: b", 'c"']
    assert parameters["gains"]["epsilon"] == [1e-4, 1e-4]
    free = tuned_gains(pack(sampled_experiment(short("paper"), LANE)), LANE)
    assert ".inf" in gains_yaml("a", "nftsm", ["1"] * 6, free)


@pytest.mark.parametrize("name", ["", "1a", "a b", "a/b", "ä", "a\n"])
def test_a_name_that_is_none_of_a_controller_is_refused(name: str) -> None:
    with pytest.raises(InvalidExperimentError, match="controller: must be letters"):
        package(short("realistic"), LANE, name)


def test_the_conditions_are_those_of_the_run(handed: Package) -> None:
    experiment = short("realistic", goals=GOALS)
    conditions = json.loads(handed.files["conditions.json"])
    assert conditions == json.loads(json.dumps(handed.conditions))
    sampled = sampled_experiment(experiment, LANE)
    metrics = simulate(sampled).lanes[LANE].metrics
    assert conditions["outcome"]["figures"] == json.loads(json.dumps(metrics.document()))
    assert conditions["margin"] == loop_margin(pack(sampled), LANE).document()
    near, quiet = conditions["outcome"]["goals"]["near"], conditions["outcome"]["goals"]["quiet"]
    assert near["ratio"] == pytest.approx(float(np.max(metrics.max_error)) / 1e-6)
    assert (near["kept"], quiet["kept"], quiet["priority"]) == (False, True, "hard")
    assert conditions["control"]["input_delay"] == experiment.simulation.input_delay
    assert any("misses a goal" in warning for warning in conditions["warnings"])
    text = handed.files["conditions.md"]
    assert "| torque limit [N·m] | 150 | 150 | 150 | 28 | 28 | 28 |" in text
    assert "no section `uncertainty`" in text
    assert f"{conditions['margin']['gamma']:.4g}" in text


@pytest.mark.parametrize("name", ["conditions.md", "README.md"])
def test_every_row_of_a_table_has_the_cells_of_its_head(handed: Package, name: str) -> None:
    table: list[int] = []
    rows = 0
    for line in handed.files[name].splitlines():
        if not line.startswith("|"):
            table = []
            continue
        rows += 1
        table.append(len(re.findall(r"(?<!\\)\|", line)))
        assert table[-1] == table[0], line
    assert rows > 10


def test_robustness_is_told_where_it_was_drawn() -> None:
    experiment = short("realistic", goals=GOALS, uncertainty={"payload": [0.0, 3.0]})
    sampled = sampled_experiment(experiment, LANE)
    with ThreadPoolExecutor(1) as executor:
        draws = list(robustness(sampled, LANE, 5, executor))
    handed = package(experiment, LANE, draws=draws)
    told = handed.conditions["robustness"]
    assert (told["draws"], told["uncertain"], told["kept"]) == (5, {"payload": [0.0, 3.0]}, 1.0)
    worst = max(one.outcome.figures["max_error"] or 0.0 for one in draws)
    assert told["quantiles"]["figures"]["max_error"]["worst"] == worst
    assert "## Robustness" in handed.files["conditions.md"]
    assert "it was not asked for" in package(experiment, LANE).files["conditions.md"]


def test_a_continuous_experiment_is_sampled_at_its_step() -> None:
    experiment = short("pendulum", simulation={"horizon": 0.5, "step": 0.002})
    name = next(iter(experiment.lanes))
    assert experiment.simulation.mode == "continuous"
    handed = package(experiment, name)
    assert handed.conditions["control"]["rate"] == 500.0
    assert handed.conditions["outcome_as_tuned"] is not None
    assert any("continuous mode" in warning for warning in handed.conditions["warnings"])
    assert ".period = 0.002," in handed.files["law.c"]


def test_what_acts_in_sampled_mode_alone_stays_off() -> None:
    fine = {"mode": "continuous", "step": 5e-5, "input_delay": 0.01}
    noisy = {"sensor_noise": {"position": 1e-3}}
    sampled = sampled_experiment(short("paper", simulation=fine, disturbance=noisy), LANE)
    assert sampled.simulation.control_rate == 10000.0  # the highest there is
    assert sampled.simulation.input_delay == 0.0
    assert sampled.disturbance.sensor_noise.position == 0.0


def test_a_loop_that_does_not_last_is_handed_over_with_a_warning() -> None:
    handed = package(short("paper"), LANE)
    assert handed.conditions["outcome"]["frozen"] is not None
    assert "did not last" in handed.conditions["warnings"][0]
    assert "did not last" in handed.files["conditions.md"]


def test_a_law_of_ones_own_is_refused(tmp_path: Path) -> None:
    from slidetune.robot.law_files.source import Source
    from slidetune.robot.loop.law_trial import take_law

    with own_laws():
        path = tmp_path / "own.py"
        path.write_text(EXAMPLE)
        law = take_law(Source(str(path), EXAMPLE))
        lanes = {"A": {"law": law.name}, "B": {"law": "smc"}}
        experiment = Experiment.from_document({"lanes": lanes, "simulation": {"horizon": 0.2}})
        with pytest.raises(InvalidExperimentError, match=r"lanes\.A\.law: .*only the laws that"):
            package(experiment, "A")
        others = experiment_from_yaml(package(experiment, "B").files["experiment.yaml"])
        assert list(others.lanes) == ["B"]


def test_an_unknown_lane_is_refused() -> None:
    with pytest.raises(InvalidExperimentError, match="no lane is named B; there are: RBFNN"):
        package(short("realistic"), "B")


def test_a_law_that_does_otherwise_is_not_handed_over() -> None:
    packed = pack(sampled_experiment(short("realistic"), LANE))
    vectors = vectors_of(packed, LANE, 50)
    law = loaded(law_texts(packed, LANE)["law.py"])
    assert checked_vectors(law, vectors) is vectors
    wrong = vectors.tau.copy()
    wrong[30, 2] *= 1.0 + 1e-10
    with pytest.raises(HandOverError, match=r"differs from the run at 0\.03 s"):
        checked_vectors(law, dataclasses.replace(vectors, tau=wrong))


def test_vectors_end_where_rounding_alone_makes_torques_differ() -> None:
    # Time-delay estimation adds up what each period was rounded by.
    lane = {"law": "smc", "observer": "time_delay", "k1": 2.0, "k2": 1.0}
    document = {
        "robot": {"model": "two_links"},
        "lanes": {"A": lane},
        "simulation": {"mode": "sampled"},
        "disturbance": {"nominal_mismatch": 0.8},
    }
    packed = pack(Experiment.from_document(document))
    vectors = vectors_of(packed, "A")
    law = loaded(law_texts(packed, "A")["law.py"])
    assert len(checked_vectors(law, vectors).time) == 1000
    rough = vectors.tau.copy()
    rough[500:] *= 1.0 + 1e-12
    assert len(checked_vectors(law, dataclasses.replace(vectors, tau=rough)).time) == 500
    rough[500:] *= 1.0 + 1e-9
    with pytest.raises(HandOverError, match="mistake of the program"):
        checked_vectors(law, dataclasses.replace(vectors, tau=rough))


def test_a_package_is_the_same_archive_each_time(handed: Package) -> None:
    archive = zipped(handed.files, "package")
    assert archive == zipped(package(short("realistic", goals=GOALS), LANE).files, "package")
    with ZipFile(io.BytesIO(archive)) as opened:
        assert opened.read("package/law.c").decode() == handed.files["law.c"]
        assert len(opened.namelist()) == len(handed.files)


@pytest.mark.parametrize("name", ['a*"""b', "λ\u202e |`", "ctrl"])
def test_a_lane_may_be_called_as_it_is(name: str, tmp_path: Path) -> None:
    lanes = {"RBFNN-NFTSM": None, "RBFNN-SMC": None, "NFTSM": None, "Computed torque PD": None}
    experiment = short("realistic", lanes={**lanes, name: {"law": "smc"}})
    files = package(experiment, name).files
    folder = written(files, tmp_path / "package")
    assert run_python(folder).returncode == 0
    check_everywhere(folder)


def test_the_readme_is_of_the_law() -> None:
    files = {
        name: package(short("realistic"), name).files["README.md"]
        for name in ("NFTSM", "RBFNN-SMC")
    }
    assert "How to fill `a_d`, `M` and `h`" in files["NFTSM"]
    assert "`M`" not in files["RBFNN-SMC"]
    assert "weights go on learning" in files["RBFNN-SMC"]
    for text in files.values():
        assert "| 1 | joint\\_1 | turns |" in text
        assert "$" not in text
        for block in re.findall(r"```python\n(.*?)```", text, re.DOTALL):
            compile(block, "README.md", "exec")
