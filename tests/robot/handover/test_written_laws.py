"""Every law, in C and in Python, does in each control period what it does in the simulation."""

from __future__ import annotations

import copy
import dataclasses
import random
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from slidetune.robot.arm.known import arm_named
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.handover.law_text import law_texts
from slidetune.robot.handover.sampled_run import Vectors, sampled_experiment, vectors_of
from slidetune.robot.handover.self_check import TOLERANCE, checked_vectors, loaded, torques_of
from slidetune.robot.laws import LAWS, SHIPPED
from tests.robot.handover.built import check_everywhere, compilers, run_c, run_python, written
from tests.trust.random_experiment import Draw

ARMS = ("jaka_zu5", "two_links", "pendulum")
PERIODS = 200
GAINS: dict[str, tuple[float, float]] = {
    "nu": (2.0, 15.0),
    "c": (0.5, 2.0),
    "mu": (0.05, 0.5),
    "lambda_": (2.0, 15.0),
    "k1": (2.0, 10.0),
    "k2": (2.0, 10.0),
    "epsilon": (0.05, 0.5),
    "alpha": (0.3, 0.9),
    "width": (0.1, 10.0),
    "learning_rate": (10.0, 300.0),
    "leakage": (0.0, 5.0),
    "center_span": (0.1, 2.0),
    "observer_rate": (5.0, 200.0),
    "kp": (50.0, 500.0),
    "kd": (10.0, 50.0),
    "z_max": (0.05, 5.0),
    "k2_min": (0.1, 1.0),
    "adaptation_rate": (50.0, 500.0),
}
ALONE = ("alpha", "center_span")
CHOICES = {
    "switching": ("tanh", "saturation", "sign", "implicit"),
    "reaching": ("exponential", "constant", "power"),
    "inertia_shaped": (False, True),
    "network_input": ("error", "angle", "desired"),
    "observer": ("none", "momentum", "time_delay"),
}


def combinations() -> Iterator[dict[str, Any]]:
    """Every combination of what can be chosen of each law."""
    for name in sorted(SHIPPED):
        fields = LAWS[name].lane.model_fields
        chosen = {key: options for key, options in CHOICES.items() if key in fields}
        for values in product(*chosen.values()):
            one = {"law": name, **dict(zip(chosen, values, strict=True))}
            network = LAWS[name].network
            if one.get("switching") == "implicit" and (network or one["reaching"] == "power"):
                continue
            yield one


def drawn_gains(law: str, joints: int, dice: random.Random) -> dict[str, Any]:
    """Gains of a law, other ones at each joint."""
    fields = LAWS[law].lane.model_fields
    gains: dict[str, Any] = {
        name: dice.uniform(low, high)
        if name in ALONE
        else [dice.uniform(low, high) for _ in range(joints)]
        for name, (low, high) in GAINS.items()
        if name in fields
    }
    if "p" in fields:
        gains["k"] = [2 * dice.randint(2, 8) + 1 for _ in range(joints)]
        gains["p"] = [k + 2 * dice.randint(1, (k - 1) // 2) for k in gains["k"]]
    return gains


def experiment_of(choice: dict[str, Any], arm: str, dice: random.Random) -> Experiment:
    """A sampled loop with noise, friction, a late torque, a limit, and a wrong model."""
    joints = arm_named(arm).joints
    return Experiment.from_document(
        {
            "robot": {
                "model": arm,
                "torque_limit": [dice.uniform(5.0, 60.0) for _ in range(joints)],
                "viscous_friction": 0.5,
                "payload": {"mass": 0.3, "known": False},
            },
            "lanes": {"A": {**choice, **drawn_gains(choice["law"], joints, dice)}},
            "disturbance": {
                "nominal_mismatch": 0.9,
                "sine": {"amplitude": 2.0, "frequency": 3.0},
                "sensor_noise": {"position": 1e-5, "velocity": 1e-3},
            },
            "simulation": {
                "mode": "sampled",
                "control_rate": 500.0,
                "plant_substeps": 2,
                "input_delay": 0.001,
                "initial_error": [dice.uniform(-0.05, 0.05) for _ in range(joints)],
            },
        }
    )


def texts_and_vectors(
    experiment: Experiment, periods: int = PERIODS
) -> tuple[dict[str, str], Vectors]:
    packed = pack(experiment)
    return law_texts(packed, "A"), vectors_of(packed, "A", periods)


def named(choice: dict[str, Any]) -> str:
    return "-".join(str(value) for value in choice.values())


@pytest.mark.parametrize("choice", list(combinations()), ids=named)
def test_the_python_of_every_choice_does_as_the_run(choice: dict[str, Any]) -> None:
    dice = random.Random(named(choice))
    texts, vectors = texts_and_vectors(experiment_of(choice, dice.choice(ARMS), dice))
    assert len(vectors.time) == PERIODS
    difference = np.abs(torques_of(loaded(texts["law.py"]), vectors) - vectors.tau).max()
    assert difference <= TOLERANCE * np.abs(vectors.tau).max()


def pairs_of(choice: dict[str, Any]) -> set[tuple[str, str, str]]:
    words = [f"{key}={value}" for key, value in choice.items()]
    return {(words[0], one, other) for one in words for other in words if one <= other}


def few() -> list[dict[str, Any]]:
    """As few combinations as hold every two choices of each law together."""
    known, kept = [(choice, pairs_of(choice)) for choice in combinations()], []
    left = set().union(*(pairs for _, pairs in known))
    while left:
        choice, pairs = max(known, key=lambda one: len(one[1] & left))
        kept.append(choice)
        left -= pairs
    return kept


@pytest.mark.parametrize("choice", few(), ids=named)
def test_the_c_of_every_choice_compiles_and_does_as_the_run(
    choice: dict[str, Any], tmp_path: Path
) -> None:
    dice = random.Random(named(choice))
    texts, vectors = texts_and_vectors(experiment_of(choice, dice.choice(ARMS), dice))
    files = {**texts, "vectors.csv": "".join(vectors.csv_lines())}
    check_everywhere(written(files, tmp_path))


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize("law", sorted(SHIPPED))
def test_the_python_needs_nothing_of_ours(law: str, arm: str, tmp_path: Path) -> None:
    experiment = experiment_of({"law": law}, arm, random.Random(law + arm))
    texts, vectors = texts_and_vectors(experiment, 50)
    done = run_python(written({**texts, "vectors.csv": "".join(vectors.csv_lines())}, tmp_path))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "they agree" in done.stdout


def with_nan(vectors: Vectors) -> Vectors:
    """Vectors in whose last period nobody knows where the last joint is."""
    q = vectors.q.copy()
    q[-1, -1] = np.nan
    return dataclasses.replace(vectors, q=q)


@pytest.mark.parametrize("law", sorted(SHIPPED))
def test_what_is_no_number_leaves_state_and_torque_as_they_were(law: str, tmp_path: Path) -> None:
    experiment = experiment_of({"law": law}, "two_links", random.Random(law))
    texts, vectors = texts_and_vectors(experiment, 20)
    python = loaded(texts["law.py"])
    state = python.State()
    seen = [vectors.q, vectors.v, vectors.q_d, vectors.v_d]
    seen += [vectors.a_d, vectors.M, vectors.h] if vectors.model_based else []
    for number in range(20):
        python.step(state, python.Inputs(*(column[number] for column in seen)))
    before = copy.deepcopy(vars(state))
    seen[0] = with_nan(vectors).q
    with pytest.raises(ValueError, match="of joint 2 is not finite"):
        python.step(state, python.Inputs(*(column[-1] for column in seen)))
    for name, value in vars(state).items():
        assert np.array_equal(value, before[name]), name

    files = {**texts, "vectors.csv": "".join(with_nan(vectors).csv_lines())}
    files["check.c"] = files["check.c"].replace(BAD, UNTOUCHED).replace(CALL, BEFORE + CALL)
    files["check.c"] = files["check.c"].replace(
        "#include <stdio.h>", "#include <stdio.h>\n#include <string.h>"
    )
    folder = written(files, tmp_path)
    for compiler in compilers():
        done = run_c(folder, compiler)
        assert (done.returncode, done.stderr) == (7, "joint 2 is bad\n"), done.stdout


CALL = "        const int bad = law_step("
BEFORE = """\
        const law_state before = state;
        for (int j = 0; j < N; j++) {
            torque[j] = 77.0;
        }
"""
BAD = "        if (bad) {\n"
UNTOUCHED = f"""\
{BAD}\
            int same = !memcmp(&before, &state, sizeof state);
            for (int j = 0; j < N; j++) {{
                same = same && torque[j] > 76.0;
            }}
            fprintf(stderr, "joint %d is %s\\n", bad, same ? "bad" : "changed");
            return 7;
        }}
{BAD}"""
"""What check.c would do if it were about what a failed step leaves."""


@pytest.mark.parametrize("seed", range(40))
def test_whatever_can_be_set_is_written_as_it_is(seed: int, tmp_path: Path) -> None:
    try:
        experiment = Experiment.from_document(Draw(seed, arms=ARMS).document())
    except InvalidExperimentError:
        return  # a combination that nobody can set
    name = next(iter(experiment.lanes))
    try:
        packed = pack(sampled_experiment(experiment, name))
    except InvalidExperimentError:
        return  # a circle out of reach
    texts = law_texts(packed, name)
    vectors = checked_vectors(loaded(texts["law.py"]), vectors_of(packed, name, 100))
    if seed % 4 == 0:
        files = {**texts, "vectors.csv": "".join(vectors.csv_lines())}
        check_everywhere(written(files, tmp_path))
