"""A law from a file of one's own runs as any other, or is refused with its lines."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from slidetune.robot.arm.known import SHIPPED
from slidetune.robot.errors import InvalidExperimentError, LawChangedError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from slidetune.robot.law_files.fitted import fitted
from slidetune.robot.law_files.law_file import law_from
from slidetune.robot.law_files.refused import LawFileError
from slidetune.robot.law_files.source import Source
from slidetune.robot.laws import LAWS, law_of, own_versions, register
from slidetune.robot.lenses import look_through
from slidetune.robot.loop.law_trial import take_law
from slidetune.robot.loop.simulate import LaneRun, simulate
from tests.own_laws import EXAMPLE, PLAIN, before_torque, own_laws

SHORT = {"horizon": 0.5}


@pytest.fixture(autouse=True)
def own() -> Iterator[None]:
    with own_laws():
        yield


def experiment(mode: str = "continuous", arm: str = SHIPPED) -> Experiment:
    simulation = {**SHORT, "mode": mode}
    lanes = {"A": {"law": "pd_gravity"}}
    return Experiment.from_document(
        {"robot": {"model": arm}, "lanes": lanes, "simulation": simulation}
    )


def run(mode: str = "continuous", arm: str = SHIPPED) -> LaneRun:
    return simulate(experiment(mode, arm)).lanes["A"]


def refused(text: str) -> LawFileError:
    with pytest.raises(LawFileError) as caught:
        take_law(Source("mine.py", text))
    assert "pd_gravity" not in LAWS
    return caught.value


@pytest.mark.parametrize("arm", [SHIPPED, "pendulum", "two_links"])
@pytest.mark.parametrize("mode", ["continuous", "sampled"])
def test_the_documented_example_tracks_and_plain_numpy_gives_the_same(mode: str, arm: str) -> None:
    take_law(Source("pd.py", EXAMPLE))
    compiled = run(mode, arm)
    assert compiled.freeze is None
    assert np.max(np.abs(compiled.e)) < 0.05
    LAWS.pop("pd_gravity")
    take_law(Source("pd.py", PLAIN))
    assert np.array_equal(run(mode, arm).q, compiled.q)


def test_plain_python_counts_the_joints_of_the_arm_that_it_runs_on() -> None:
    take_law(Source("pd.py", EXAMPLE))
    compiled = run(arm="two_links")
    LAWS.pop("pd_gravity")
    take_law(Source("pd.py", EXAMPLE.replace("@kernel\n", "")))
    assert np.array_equal(run(arm="two_links").q, compiled.q)


def test_a_law_of_one_s_own_is_seen_through_every_lens() -> None:
    take_law(Source("pd.py", EXAMPLE))
    seen = look_through(experiment("sampled"), "A", ["sliding", "network", "chattering"])
    assert None not in (seen["sliding"], seen["chattering"])
    assert look_through(experiment("sampled"), "A", ["prediction"])["prediction"] is None


def test_a_preset_keeps_it_by_name_and_is_refused_with_the_way_out_where_it_is_unknown() -> None:
    take_law(Source("pd.py", EXAMPLE))
    text = experiment_to_yaml(experiment())
    assert experiment_from_yaml(text) == experiment()
    LAWS.pop("pd_gravity")
    with pytest.raises(InvalidExperimentError, match=r"--law FILE\.py"):
        experiment_from_yaml(text)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (EXAMPLE.replace("range(JOINTS):", "range(JOINTS:"), "SyntaxError"),
        (EXAMPLE.replace("import numpy as np", "import numpi as np"), "No module named 'numpi'"),
        (EXAMPLE.replace("LAW = ", "LAWS = "), "defines no LAW"),
        (EXAMPLE.replace('"pd_gravity"', '"smc"'), "ships with Slidetune"),
        (EXAMPLE.replace('    name="pd_gravity"', '    name="other"'), "need the field law"),
        (EXAMPLE.replace("kp: PerJoint", "k2: PerJoint").replace("self.kp", "self.k2"), "inherit"),
        (EXAMPLE.replace("step=10.0,", ""), "kp needs low, high and step"),
        (EXAMPLE.replace("np.empty((2, joints))", "np.empty((joints, 2))"), "pack"),
        (EXAMPLE.replace("        return block", "        return [1.0]"), "got list"),
        (EXAMPLE.replace("nominal_M, nominal_nle, work):", "work):"), "5 arguments"),
        (EXAMPLE.replace("work[TAU, j] =", "unused ="), "wrote no torque"),
        (before_torque("work[100000, j] = 1.0"), "out of bounds"),
        (before_torque("wrok[0, j] = 1.0"), "name 'wrok' is not defined"),
        (before_torque("if work[QD, 1] > 0.05:", "    raise ValueError('high')"), "high"),
        (EXAMPLE.replace("def control(", "def f(a):\n    return f(a)\n\n\ndef control("), "itself"),
    ],
)
def test_a_wrong_file_is_refused_in_words(text: str, words: str) -> None:
    assert text != EXAMPLE
    assert words in str(refused(text))


@pytest.mark.parametrize("kernel", ["@kernel\n", ""])
@pytest.mark.parametrize("condition", ["True", "work[QD, 0] == work[QD, 0]"])
def test_a_loop_without_an_end_is_ended_and_its_line_told(kernel: str, condition: str) -> None:
    text = before_torque(f"while {condition}:", "    e += 1.0").replace("@kernel\n", kernel)
    error = refused(text)
    line = text.splitlines().index(f"        while {condition}:") + 1
    assert error.message.startswith(f"line {line}: EndlessLoopError")
    assert f'File "mine.py", line {line}, in control' in error.trace


def test_a_loop_without_an_end_is_ended_where_a_file_is_read() -> None:
    assert "EndlessLoopError" in refused(f"while True:\n    pass\n{EXAMPLE}").message


def test_a_law_that_fails_later_freezes_its_lane_with_the_lines_of_the_file() -> None:
    late = before_torque("while work[QD, 0] > 0.25:", "    e += 1.0")
    take_law(Source("late.py", late))
    freeze = (
        simulate(Experiment.from_document({"lanes": {"A": {"law": "pd_gravity"}}}))
        .lanes["A"]
        .freeze
    )
    assert freeze is not None
    assert freeze.joint is None
    assert 'File "late.py"' in freeze.trace
    assert "    while work[QD, 0] > 0.25:" in freeze.trace


def test_an_index_beyond_an_array_is_told_with_a_way_out() -> None:
    late = before_torque("if work[QD, 0] > 0.25:", "    work[QD, 99] = 1.0")
    take_law(Source("late.py", late))
    (lane,) = simulate(
        Experiment.from_document({"lanes": {"A": {"law": "pd_gravity"}}})
    ).lanes.values()
    assert lane.freeze is not None
    assert "IndexError" in lane.freeze.cause
    assert lane.freeze.cause.endswith("Mend its file, or reset.")
    assert ('File "late.py"' in lane.freeze.trace) != ("names no line" in lane.freeze.cause)


def test_what_goes_on_keeps_its_version_and_mixes_it_with_no_other() -> None:
    first = take_law(Source("pd.py", EXAMPLE))
    before = experiment()
    second = take_law(Source("pd.py", before_torque("e += 0.0")), "pd_gravity")
    assert law_of(before.lanes["A"]) is first
    assert law_of(experiment().lanes["A"]) is second
    assert own_versions(before.lanes) != own_versions(experiment().lanes)
    assert before != experiment()
    with pytest.raises(LawChangedError, match="pd_gravity"):
        before.patched({"title": "Another"})


def test_a_version_that_fails_leaves_the_one_before_in_place() -> None:
    first = take_law(Source("pd.py", EXAMPLE))
    with pytest.raises(LawFileError):
        take_law(Source("pd.py", before_torque("e.bad")), "pd_gravity")
    assert LAWS["pd_gravity"] is first


def test_a_law_keeps_its_name_and_two_files_have_two() -> None:
    take_law(Source("pd.py", EXAMPLE))
    with pytest.raises(LawFileError, match="another file"):
        take_law(Source("pd2.py", EXAMPLE))
    with pytest.raises(LawFileError, match="was pd_gravity and is pd_other"):
        take_law(Source("pd.py", EXAMPLE.replace("pd_gravity", "pd_other")), "pd_gravity")


def test_gains_that_a_version_no_longer_has_or_permits_are_left_out() -> None:
    take_law(Source("pd.py", EXAMPLE))
    document = experiment().patched({"lanes": {"A": {"kp": 9000.0, "kd": 30.0}}}).document()
    text = EXAMPLE.replace("high=10000.0", "high=1000.0")
    law = law_from(Source("pd.py", text), "pd_gravity")
    found, left_out = fitted(document, law)
    assert left_out == ["A.kp"]
    assert found["lanes"]["A"] == {"law": "pd_gravity", "kd": 30.0}
    register(law)
    assert Experiment.from_document(found).lanes["A"].kp == 400.0
