"""An experiment as YAML text and back."""

from __future__ import annotations

import json
import re
from contextlib import suppress
from typing import Any, get_args, get_origin

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from slidetune.robot.arm.known import SHIPPED
from slidetune.robot.arm.section import Robot
from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.errors import InvalidExperimentError, PresetSyntaxError, SlidetuneError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.migration import migrated
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from slidetune.robot.experiment.simulation import Simulation
from slidetune.robot.fields.quantity import JOINTS, Section
from slidetune.robot.laws import LAWS
from slidetune.robot.motion.trajectory import (
    CircleTrajectory,
    HoldTrajectory,
    QuinticTrajectory,
    SineTrajectory,
)

RATIOS = ((5.0, 3.0), (7.0, 5.0), (9.0, 7.0), (19.0, 11.0))
SHORT = {"horizon": 10.0}
TRAJECTORIES = (SineTrajectory, QuinticTrajectory, HoldTrajectory, CircleTrajectory)
YAML_SIGNS = "ab01.:-?[]{},&*!|>'\"%@`#~<= \n\t\r\\"
KEYS = ("law", "nu", "k1", "title", "trajectory", "kind", "payload", "torque_limit", "simulation")
LANE_NAMES = st.from_regex(r"[^\x00-\x1f\x7f/\\<>]{1,40}", fullmatch=True).filter(
    lambda name: name == name.strip()
)
SAMPLE = experiment_to_yaml(
    Experiment().patched(
        {
            "lanes": {"Second lane": {"law": "nftsm", "k1": [1, 2, 3, 4, 5, 6]}},
            "goals": {"quiet": {"kind": "figure", "figure": "chattering", "bound": 200.0}},
            "uncertainty": {"payload": [0.0, 3.0]},
        }
    )
)


@st.composite
def sections(draw: st.DrawFn, kind: type[Section]) -> dict[str, Any]:
    """Values of a section, anywhere within the bounds that its schema states."""
    values = {name: draw(_value(name, info)) for name, info in kind.model_fields.items()}
    if "p" in values:
        values["p"], values["k"] = draw(st.sampled_from(RATIOS))
    return values


def _value(name: str, info: Any) -> st.SearchStrategy[Any]:
    kind, extra = info.annotation, info.json_schema_extra or {}
    if isinstance(kind, type) and issubclass(kind, Section):
        return sections(kind)
    if name == "model":
        return st.just(SHIPPED)
    if "minimum" not in extra:
        return st.booleans() if kind is bool else st.sampled_from(get_args(kind))
    low, high = extra["minimum"], SHORT.get(name, extra["maximum"])
    if kind is int:
        return st.integers(low, high)
    number = st.floats(low, high)
    if kind is float:
        return number
    size = len(info.default) if isinstance(info.default, tuple) else JOINTS
    vector = st.lists(number, min_size=size, max_size=size)
    if get_origin(kind) is tuple:
        return vector
    choices = {float: number, type(None): st.none()}
    return st.one_of(vector, *[choices[part] for part in get_args(kind) if part in choices])


@st.composite
def experiments(draw: st.DrawFn) -> Experiment:
    """Any valid experiment."""
    laws = st.sampled_from(list(LAWS.values())).flatmap(lambda law: sections(law.lane))
    document = {
        "title": draw(st.text(max_size=120)),
        "description": draw(st.text(max_size=300) | st.text("ab #\n\t '\"|>-", max_size=60)),
        "robot": draw(sections(Robot)),
        "lanes": draw(st.dictionaries(LANE_NAMES, laws, min_size=1, max_size=3)),
        "trajectory": draw(st.sampled_from(TRAJECTORIES).flatmap(sections)),
        "disturbance": draw(sections(Disturbance)),
        "simulation": draw(sections(Simulation)),
    }
    for lane in document["lanes"].values():
        if (lane.get("switching"), lane.get("reaching")) == ("implicit", "power"):
            lane["switching"] = "sign"
    if any(lane.get("switching") == "sign" for lane in document["lanes"].values()):
        document["simulation"]["mode"] = "sampled"
    for lane in document["lanes"].values():
        if lane.get("reaching") == "power" and lane.get("switching") == "implicit":
            lane["switching"] = "sign"  # power refuses implicit
    return Experiment.from_document(document)


def refused(text: str | bytes) -> InvalidExperimentError:
    """Return the refusal of a text that must be refused."""
    with pytest.raises(InvalidExperimentError) as caught:
        experiment_from_yaml(text)
    return caught.value


def line_of(text: str) -> int:
    """Return the line of the sample that begins with ``text``."""
    return [line.strip().startswith(text) for line in SAMPLE.splitlines()].index(True) + 1


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(experiments())
def test_every_experiment_reads_back_equal(experiment: Experiment) -> None:
    text = experiment_to_yaml(experiment)
    assert experiment_from_yaml(text) == experiment
    assert experiment_to_yaml(experiment_from_yaml(text.encode())) == text


@pytest.mark.parametrize("end", ["", "\n", "\n\n", "\n\n\n", " \n\n", "\n \n"])
def test_empty_lines_at_the_end_of_a_description_stay_as_many(end: str) -> None:
    experiment = Experiment(description=f"First\n\nsecond{end}")
    assert experiment_from_yaml(experiment_to_yaml(experiment)) == experiment


def test_every_number_says_what_it_is() -> None:
    text = experiment_to_yaml(Experiment())
    assert re.search(r"^    nu: 0\.3 +# ν, 1/s, Eq\. 5: error gain$", text, re.MULTILINE)
    numbers = [line for line in text.splitlines() if re.match(r" +[a-z_0-9]+: [-\d\[]", line)]
    assert len(numbers) > 35
    assert [line for line in numbers if not re.search(r" # \S", line)] == []


def test_writer_keeps_the_order_of_the_schema_and_of_the_screen() -> None:
    keys = re.findall(r"^([a-z]+):", SAMPLE, re.MULTILINE)
    assert keys == list(Experiment.model_fields)
    places = [SAMPLE.index(f"# {name}") for name in ("Sliding surface", "Reaching", "RBF network")]
    assert places == sorted(places)


def test_writer_says_how_to_run_the_file_and_its_format() -> None:
    head = SAMPLE.split("\nslidetune:")[0]
    assert "python -m slidetune run FILE" in head
    assert "format 1" in head


def test_description_is_a_block_that_can_be_read() -> None:
    experiment = Experiment(description="First: line\n\n# not a comment\n")
    text = experiment_to_yaml(experiment)
    assert "description: |\n  First: line\n\n  # not a comment\n" in text
    assert experiment_from_yaml(text) == experiment


def test_a_text_may_leave_things_out() -> None:
    assert experiment_from_yaml("title: short\n") == Experiment(title="short")
    assert experiment_from_yaml(b"\xef\xbb\xbftitle: short\r\n") == Experiment(title="short")


@pytest.mark.parametrize(
    ("text", "line", "word"),
    [
        ("", None, "empty"),
        ("# only a comment\n", None, "empty"),
        ("- a\n- b\n", 1, "mapping"),
        ("just text", 1, "mapping"),
        ("title: a\nrobot: &arm {}\n", 2, "anchors"),
        ("title: a\nrobot: *arm\n", 2, "aliases"),
        ("*arm : 1\n", 1, "aliases"),
        ("title: a\nrobot: !!python/object:os.system {}\n", 2, "tags"),
        ("title: !!str a\n", 1, "tags"),
        ("title: a\nrobot:\n  <<: {}\n", 3, "merge"),
        ("title: a\nrobot: {}\ntitle: b\n", 3, "twice"),
        ("title: a\n---\ntitle: b\n", 2, "one"),
        ("title: a\n2: b\n", 2, "text"),
        ("title: a\nnull: b\n", 2, "text"),
        ("title: a\n[1, 2]: b\n", 2, "text"),
        ("title: a\n? {a: b}\n: b\n", 2, "text"),
        ("%YAML 1.1\n---\ntitle: yes\n", 1, "directives"),
        ("title: a\nrobot: {payload: {mass: .nan}}\n", 2, "finite"),
        ("title: a\nrobot:\n  payload:\n    mass: -.INF\n", 4, "finite"),
        ("robot: {payload: {mass: 1e999}}\n", 1, "finite"),
        ("title: a\ndisturbance:\n  seed: " + "9" * 5000, 3, "characters"),
        ("robot: {payload: {known: yes}}\n", 1, "ambiguous"),
        ("robot: {torque_limit: off}\n", 1, "ambiguous"),
        ("title: No\n", 1, "ambiguous"),
        ("disturbance: {seed: 010}\n", 1, "ambiguous"),
        ("disturbance: {seed: 0x10}\n", 1, "ambiguous"),
        ("disturbance: {seed: 1_000}\n", 1, "ambiguous"),
        ("simulation: {horizon: 1:30}\n", 1, "ambiguous"),
        ("title: a\n\ttab: 1\n", 2, "YAML"),
        ("title: 'open\n\n", 3, "YAML"),
        ("title: a\nb: \x07\n", 2, "character"),
        ("title: a\n" + "x" * 200 + ": 1\n", 2, "120"),
        ("title: " + "[" * 5000, 1, "deeper"),
        ("\n" + "{a: " * 500, 2, "deeper"),
        ("title: a\ntrue: b\n", 2, "put true in quotes"),
        ("title: a\n? \n: b\n", 2, "empty"),
        ("lanes: {A: {law: smc}\n", 2, "got '<stream end>'"),
        ('title: a\ndescription: "\\U00110000"\n', 2, "not a character"),
    ],
)
def test_what_is_not_plain_is_refused_with_its_line(text: str, line: int | None, word: str) -> None:
    error = refused(text)
    assert isinstance(error, PresetSyntaxError)
    assert word in str(error)
    assert error.fields[0].line == line


def test_many_small_anchors_are_refused_at_the_first_one() -> None:
    laughs = "a0: &a0 [x, x]\n" + "".join(
        f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 30)
    )
    assert refused(laughs).fields[0].line == 1


def test_large_and_foreign_text_is_refused_before_it_is_parsed() -> None:
    assert "64 KiB" in str(refused("#" * (64 * 1024 + 1)))
    assert "64 KiB" in str(refused("ä" * (40 * 1024)))
    assert "UTF-8" in str(refused("title: ä".encode("latin-1")))
    assert "UTF-8" in str(refused("title: a".encode("utf-16")))
    assert "UTF-8" in str(refused("title: \ud800"))


@pytest.mark.parametrize("piece", ["[[[[[[]]]]]],", "1,", "{},", "a,"])
def test_a_text_of_too_many_pieces_is_refused_before_it_is_read_to_its_end(piece: str) -> None:
    text = f"title: a\nrobot: [\n{piece * (60_000 // len(piece))}"
    # That the list has no end is not seen any more.
    error = refused(text)
    assert "more than 5000 keys, values and lists" in str(error)
    assert error.fields[0].line == 3


def test_the_largest_experiment_is_read() -> None:
    fields = ("nu", "c", "mu", "k1", "k2", "learning_rate")
    lane = {"law": "rbfnn_nftsm"} | {name: [1, 2, 3, 4, 5, 6] for name in fields}
    lanes = {f"{number} {'x' * 38}": lane for number in range(6)}
    patch = {"description": "y\n" * 2000, "lanes": {**lanes, "RBFNN-NFTSM": None}}
    largest = Experiment().patched(patch)
    assert experiment_from_yaml(experiment_to_yaml(largest)) == largest


@pytest.mark.parametrize(
    ("before", "after", "path", "line"),
    [
        ("nu: 0.3 ", "nu: 0 ", "lanes.RBFNN-NFTSM.nu", "nu:"),
        ("nu: 0.3 ", "nuu: 0.3 ", "lanes.RBFNN-NFTSM.nuu", "nu:"),
        ("k1: [1, 2,", "k1: [1, 2000,", "lanes.Second lane.k1", "k1: [1"),
        ("law: nftsm ", "law: nftms ", "lanes.Second lane.law", "law: nftsm"),
        ("kind: sine", "kind: sinus", "trajectory.kind", "kind:"),
        ("horizon: 10 ", "horizon: 100 ", "simulation.horizon", "horizon:"),
        ("seed: 1 ", "seed: 1.5 ", "disturbance.seed", "seed:"),
        ("robot:\n", "robot: 3\nrobots:\n", "robot", "robot:"),
        ("slidetune: 1", "slidetune: 7", "slidetune", "slidetune:"),
    ],
)
def test_a_refused_value_names_its_line(before: str, after: str, path: str, line: str) -> None:
    text = SAMPLE.replace("step: 0.001 ", "step: 0.0001 ").replace(before, after, 1)
    found = {field.path: field.line for field in refused(text).fields}
    assert found[path] == line_of(line)


def test_a_refusal_names_the_file_and_keeps_its_fields() -> None:
    with pytest.raises(InvalidExperimentError, match=r"^mine\.yaml: line 1: titel: ") as caught:
        experiment_from_yaml("titel: x", origin="mine.yaml")
    assert caught.value.fields[0].path == "titel"


def test_a_newer_format_is_refused_by_name() -> None:
    error = refused("slidetune: 7\nshiny: new\n")
    assert str(error) == (
        "line 1: slidetune: written by a newer Slidetune: format 7, this one reads up to 1: "
        "update Slidetune"
    )


@pytest.mark.parametrize("version", ["0", "-1", "one", "true", "1.0", "[1]", "null"])
def test_a_format_is_a_whole_number(version: str) -> None:
    assert refused(f"slidetune: {version}").fields[0].path == "slidetune"


def test_older_formats_are_brought_up_to_date_step_by_step() -> None:
    steps = {
        1: lambda document: {**document, "title": document["title"] + "b"},
        2: lambda document: {**document, "title": document["title"] + "c"},
    }
    old = {"slidetune": 1, "title": "a"}
    assert migrated(old, steps, 3) == {"slidetune": 3, "title": "abc"}
    assert migrated({"slidetune": 2, "title": "a"}, steps, 3) == {"slidetune": 3, "title": "ac"}
    assert old == {"slidetune": 1, "title": "a"}
    with pytest.raises(InvalidExperimentError, match="too old"):
        migrated({"slidetune": 1}, {2: steps[2]}, 3)


def read_or_refuse(text: str | bytes) -> None:
    """Fail on any error that isn't ours."""
    with suppress(SlidetuneError):
        experiment_from_yaml(text)


@settings(max_examples=300, deadline=None)
@given(st.binary(max_size=200) | st.text(max_size=200) | st.text(YAML_SIGNS, max_size=60))
def test_any_text_is_read_or_refused(text: str | bytes) -> None:
    read_or_refuse(text)


@settings(max_examples=100, deadline=None)
@given(
    st.integers(0, len(SAMPLE) - 1),
    st.integers(0, 30),
    st.text(max_size=6) | st.text(YAML_SIGNS, max_size=6),
)
def test_a_damaged_preset_is_read_or_refused(start: int, length: int, patch: str) -> None:
    read_or_refuse(SAMPLE[:start] + patch + SAMPLE[start + length :])


@settings(max_examples=100, deadline=None)
@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20),
        lambda inner: (
            st.lists(inner, max_size=7)
            | st.dictionaries(st.sampled_from(KEYS) | st.text(max_size=8), inner, max_size=4)
        ),
        max_leaves=20,
    )
)
def test_any_values_are_taken_or_refused(values: Any) -> None:
    read_or_refuse(json.dumps(values))
    read_or_refuse(json.dumps({"lanes": {"a": values}, "robot": values, "slidetune": 1}))
