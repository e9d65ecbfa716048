"""The compiled recursion: the same M and h as Pinocchio for any chain, and no other arm taken."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib.metadata import files
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.arm.arm import build_model
from slidetune.robot.arm.chain import AGREEMENT, checked_chain, deviation, pack_chain
from slidetune.robot.arm.dynamics import chain_of
from slidetune.robot.arm.recursion import (
    ARMATURE,
    CENTRE,
    CHAIN_COLUMNS,
    MASS,
    PLACE,
    ROTATION,
    SLIDES,
    TENSOR,
    chain_dynamics,
)
from slidetune.robot.arm.section import Robot

Array = np.ndarray
STATES = 300
DESCRIPTIONS = {
    "UR5": "ur5_robot.urdf",
    "Panda": "panda.urdf",
    "xArm7": "xarm7.urdf",
    "Z1": "z1.urdf",
    "two links": "double_pendulum.urdf",
}


def described(name: str) -> pin.Model:
    """Return an arm of the package of descriptions, without its fingers."""
    known = files("example-robot-data") or []
    path = next(str(file.locate()) for file in known if file.name == DESCRIPTIONS[name])
    model = pin.buildModelFromUrdf(path)
    fingers = [model.getJointId(joint) for joint in model.names if "finger" in joint]
    return pin.buildReducedModel(model, fingers, pin.neutral(model)) if fingers else model


def joined(*joints: Any, seed: int = 0) -> pin.Model:
    """Return a chain of these joints, with bodies and placements drawn."""
    random = np.random.default_rng(seed)
    model, before = pin.Model(), 0
    for number, joint in enumerate(joints):
        turn = pin.exp3(random.uniform(-2.0, 2.0, 3))
        place = pin.SE3(turn, random.uniform(-0.5, 0.5, 3))
        before = model.addJoint(before, joint, place, f"joint {number}")
        root = random.uniform(-0.2, 0.2, (3, 3))
        tensor = root @ root.T + 0.01 * np.eye(3)
        body = pin.Inertia(random.uniform(0.1, 9.0), random.uniform(-0.3, 0.3, 3), tensor)
        model.appendBodyToJoint(before, body, pin.SE3.Identity())
    return model


def oblique(kind: Callable[[Array], Any], *axis: float) -> Any:
    return kind(np.array(axis) / np.linalg.norm(axis))


def turning(*axis: float) -> Any:
    return oblique(pin.JointModelRevoluteUnaligned, *axis)


def sliding(*axis: float) -> Any:
    return oblique(pin.JointModelPrismaticUnaligned, *axis)


def mixed() -> pin.Model:
    """Return a chain of both kinds, along and about axes of the frame and others."""
    return joined(
        turning(1, 2, 3), pin.JointModelPX(), sliding(-1, 1, 2), pin.JointModelRY(),
        pin.JointModelPZ(), turning(0.1, -3, 0.2), seed=5,
    )  # fmt: skip


def loaded(model: pin.Model) -> pin.Model:
    """Return a model with a payload at its last joint."""
    at = pin.SE3(pin.exp3(np.array([0.3, -0.2, 1.0])), np.array([0.05, 0.0, 0.1]))
    load = pin.Inertia(2.5, np.array([0.02, -0.03, 0.1]), np.diag([0.01, 0.02, 0.015]))
    model.appendBodyToJoint(model.njoints - 1, load, at)
    return model


def geared(model: pin.Model) -> pin.Model:
    model.armature = np.linspace(0.1, 0.9, model.nv)
    return model


def falling(model: pin.Model, *gravity: float) -> pin.Model:
    model.gravity = pin.Motion(np.array(gravity), np.zeros(3))
    return model


def point_masses() -> pin.Model:
    model = joined(*[pin.JointModelRZ() for _ in range(3)])
    for joint in range(1, model.njoints):
        model.inertias[joint] = pin.Inertia(1.5, np.array([0.4, 0.1, 0.0]), np.zeros((3, 3)))
    return model


CHAINS: dict[str, Callable[[], pin.Model]] = {
    **{name: lambda name=name: described(name) for name in DESCRIPTIONS},  # type: ignore[misc]
    "this arm": lambda: build_model(Robot()),
    "this arm, all of it": lambda: build_model(
        Robot.model_validate(
            {"inertials": "datasheet", "armature": 0.4, "payload": {"mass": 2.0}}
        ),
        mismatch=0.7,
    ),
    "gantry": lambda: joined(pin.JointModelPX(), pin.JointModelPY(), pin.JointModelPZ()),
    "both kinds": mixed,
    "along oblique axes": lambda: joined(sliding(1, 2, 3), sliding(-1, 0.5, 0.1), sliding(0, 1, 1)),
    "about oblique axes": lambda: joined(turning(1, 2, 3), turning(-1, 0.5, 0.1), turning(0, 1, 1)),
    "against the axes": lambda: joined(turning(-1, 0, 0), sliding(0, 0, -1), turning(0, -1, 0)),
    "one that turns": lambda: joined(pin.JointModelRX()),
    "one that slides": lambda: joined(sliding(2, -1, 1)),
    "twelve": lambda: joined(*[turning(1, n, -n) for n in range(12)]),
    "payload": lambda: loaded(described("UR5")),
    "payload on both kinds": lambda: loaded(mixed()),
    "armature": lambda: geared(described("UR5")),
    "armature on both kinds": lambda: geared(mixed()),
    "on its side": lambda: falling(described("UR5"), 9.81, 0.0, 0.0),
    "on a slope": lambda: falling(mixed(), 1.0, -2.0, 3.0),
    "weightless": lambda: falling(described("UR5"), 0.0, 0.0, 0.0),
    "point masses": point_masses,
}  # fmt: skip


@cache
def chain_named(name: str) -> tuple[pin.Model, Array]:
    model = CHAINS[name]()
    chain = checked_chain(model)
    assert chain is not None
    return model, chain


def relative(found: Array, expected: Array) -> float:
    scale = float(np.abs(expected).max())
    difference = float(np.abs(found - expected).max())
    return difference / scale if scale else difference


@pytest.mark.parametrize("name", CHAINS)
def test_inertia_and_bias_are_pinocchio_s(name: str) -> None:
    model, chain = chain_named(name)
    data, arm, count = model.createData(), chain_of(chain), model.nv
    assert chain.shape == (count + 1, CHAIN_COLUMNS)
    random = np.random.default_rng(1)
    for q, v in random.uniform(-12.0, 12.0, (STATES, 2, count)):
        chain_dynamics(chain, q, v, arm.inertia, arm.bias, arm.scratch)
        np.testing.assert_array_equal(arm.inertia, arm.inertia.T)
        upper = np.triu(pin.crba(model, data, q))
        assert relative(np.triu(arm.inertia), upper) < AGREEMENT
        assert relative(arm.bias, pin.nonLinearEffects(model, data, q, v)) < AGREEMENT


@pytest.mark.parametrize("name", CHAINS)
def test_weight_alone_is_what_is_felt_at_rest(name: str) -> None:
    model, chain = chain_named(name)
    data, arm = model.createData(), chain_of(chain)
    random, scale = np.random.default_rng(2), 0.0
    for q in random.uniform(-3.0, 3.0, (20, model.nv)):
        chain_dynamics(chain, q, np.zeros(model.nv), arm.inertia, arm.bias, arm.scratch)
        weight = pin.computeGeneralizedGravity(model, data, q)
        scale = max(scale, float(np.abs(weight).max()))
        np.testing.assert_allclose(arm.bias, weight, atol=1e-10 * max(1.0, scale))


def test_a_state_leaves_nothing_for_the_next() -> None:
    _, chain = chain_named("both kinds")
    used, fresh = chain_of(chain), chain_of(chain)
    q, v = np.random.default_rng(3).uniform(-3.0, 3.0, (2, len(chain) - 1))
    wild = np.full(len(chain) - 1, np.nan)
    for state in ((wild, wild), (q, v)):
        chain_dynamics(chain, *state, used.inertia, used.bias, used.scratch)
    chain_dynamics(chain, q, v, fresh.inertia, fresh.bias, fresh.scratch)
    for one, other in zip(used, fresh, strict=True):
        np.testing.assert_array_equal(one, other)


def branched() -> pin.Model:
    model = joined(pin.JointModelRZ(), pin.JointModelRX())
    joint = model.addJoint(1, pin.JointModelRY(), pin.SE3.Identity(), "branch")
    model.appendBodyToJoint(joint, pin.Inertia.FromSphere(1.0, 0.1), pin.SE3.Identity())
    return model


def two_on_the_base() -> pin.Model:
    model = joined(pin.JointModelRZ())
    joint = model.addJoint(0, pin.JointModelRY(), pin.SE3.Identity(), "other arm")
    model.appendBodyToJoint(joint, pin.Inertia.FromSphere(1.0, 0.1), pin.SE3.Identity())
    return model


@pytest.mark.parametrize(
    "model",
    [
        pin.Model,
        lambda: joined(pin.JointModelFreeFlyer(), pin.JointModelRX()),
        lambda: joined(*[pin.JointModelRZ() for _ in range(13)]),
        lambda: joined(pin.JointModelRX(), pin.JointModelRUBZ()),
        lambda: joined(pin.JointModelSpherical()),
        lambda: joined(pin.JointModelSphericalZYX()),
        lambda: joined(pin.JointModelTranslation(), pin.JointModelRX()),
        lambda: joined(pin.JointModelPlanar()),
        lambda: joined(pin.JointModelRX(), pin.JointModelUniversal(*np.eye(3)[:2])),
        branched,
        two_on_the_base,
    ],
    ids=[
        "nothing", "free-flyer", "thirteen joints", "continuous", "ball", "ball of three angles",
        "translation", "planar", "universal", "tree", "two arms",
    ],
)  # fmt: skip
def test_what_is_no_chain_is_not_packed(model: Callable[[], pin.Model]) -> None:
    assert pack_chain(model()) is None
    assert checked_chain(model()) is None


def composite() -> Any:
    """Return a joint that turns about an axis beside its own place."""
    joint = pin.JointModelComposite()
    joint.addJoint(pin.JointModelRX(), pin.SE3(np.eye(3), np.array([0.1, 0.2, 0.3])))
    return joint


@pytest.mark.parametrize(
    "joint",
    [
        lambda: pin.JointModelHZ(0.3),
        lambda: oblique(lambda axis: pin.JointModelHelicalUnaligned(axis, 0.3), 1, 2, 3),
        composite,
    ],
    ids=["screw along z", "oblique screw", "composite"],
)
def test_what_has_one_number_a_joint_and_is_neither_kind_is_refused(
    joint: Callable[[], Any],
) -> None:
    model = joined(pin.JointModelRX(), joint(), pin.JointModelRY())
    assert model.nq == model.nv == 3
    assert checked_chain(model) is None


@pytest.mark.parametrize(
    "column",
    [
        ROTATION, ROTATION + 4, ROTATION + 8, PLACE, PLACE + 1, PLACE + 2, MASS, CENTRE,
        CENTRE + 1, CENTRE + 2, *range(TENSOR, ARMATURE), ARMATURE,
    ],
)  # fmt: skip
def test_a_changed_number_of_a_chain_is_noticed(column: int) -> None:
    model, chain = chain_named("both kinds")
    # Where the first ones lie along their axes makes no difference.
    for row in range(3, model.nv):
        wrong = chain.copy()
        wrong[row, column] += 1e-6
        assert deviation(model, wrong) > AGREEMENT, row


@pytest.mark.parametrize("name", ["both kinds", "UR5"])
def test_a_wrong_kind_of_joint_or_another_gravity_is_noticed(name: str) -> None:
    model, chain = chain_named(name)
    assert deviation(model, chain) <= AGREEMENT
    for row in range(model.nv):
        wrong = chain.copy()
        wrong[row, SLIDES] = 1.0 - wrong[row, SLIDES]
        assert deviation(model, wrong) > AGREEMENT
    wrong = chain.copy()
    wrong[-1, 2] += 1e-6
    assert deviation(model, wrong) > AGREEMENT


@pytest.mark.parametrize("broken", [np.nan, np.inf])
def test_what_is_no_number_never_agrees(broken: float) -> None:
    model, chain = chain_named("UR5")
    for place in ((2, MASS), (2, ARMATURE), (-1, 2)):
        wrong = chain.copy()
        wrong[place] = broken
        assert not deviation(model, wrong) <= AGREEMENT
    model = described("UR5")
    model.armature = np.full(model.nv, broken)
    assert checked_chain(model) is None
