"""Arms of the user's own: what is kept of them, and what becomes of damage."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.arm import kept, known
from slidetune.robot.arm.arm_document import DamagedArmError, arm_from, document_of
from slidetune.robot.arm.kept import arm_folder, keep, kept_arm, kept_arms, kept_names, remove
from slidetune.robot.arm.known import arm_named, find_arm, forget_arm, known_arms, shipped_arms
from slidetune.robot.arm.known_arm import KnownArm, is_own_name, own_arm
from slidetune.robot.doctor.examine import examine
from slidetune.robot.errors import ArmStorageError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from tests.robot.doctor.descriptions import described

ROOT = Path(__file__).parents[3]


@pytest.fixture(autouse=True)
def none_added(monkeypatch: pytest.MonkeyPatch) -> None:
    """Begin with no arm but those that ship."""
    monkeypatch.setattr(known, "_added", {})


def own(name: str, **options: Any) -> KnownArm:
    found = examine(described(name), **options)
    assert found.arm is not None
    return own_arm(found.arm, found.name, file=name)


def kept_folder(name: str) -> Path:
    return arm_folder() / name


def terms(arm: KnownArm) -> list[np.ndarray]:
    model, random = arm.model, np.random.default_rng(1)
    found = []
    for q, v in random.uniform(-1.0, 1.0, (3, 2, arm.joints)):
        data = model.createData()
        pin.framesForwardKinematics(model, data, q)
        found += [np.triu(pin.crba(model, data, q)), pin.nonLinearEffects(model, data, q, v)]
        found.append(np.asarray(data.oMf[model.getFrameId(arm.tip)].homogeneous))
    return found


@pytest.mark.parametrize("name", ["ur5_robot.urdf", "panda.urdf", "tiago.urdf", "xarm7.urdf"])
def test_a_kept_arm_is_the_same_arm_and_looks_the_same(name: str) -> None:
    arm = own(name)
    keep(arm, described(name))
    found = kept_arm(arm.name)
    assert found is not None
    for ours, theirs in zip(terms(found), terms(arm), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-13)
    for key in ("name", "title", "meaning", "tip", "home", "lower", "upper", "velocity", "effort"):
        assert getattr(found, key) == getattr(arm, key)
    assert (found.slides, found.joint_names) == (arm.slides, arm.joint_names)
    assert len(found.visuals) == len(arm.visuals)
    for ours, theirs in zip(found.visuals, arm.visuals, strict=True):
        assert ours.joint == theirs.joint
        assert ours.placement.isApprox(theirs.placement, 1e-12)
        assert (ours.scale, ours.box, ours.cylinder, ours.sphere, ours.color) == (
            theirs.scale,
            theirs.box,
            theirs.cylinder,
            theirs.sphere,
            theirs.color,
        )
        if theirs.mesh is not None:
            assert ours.mesh is not None
            assert ours.mesh.parent == kept_folder(arm.name) / "meshes"
            assert ours.mesh.read_bytes() == theirs.mesh.read_bytes()


def test_a_kept_arm_is_known_and_listed_until_it_is_removed() -> None:
    arm = own("ur5_robot.urdf")
    assert find_arm(arm.name) is None
    keep(arm, described("ur5_robot.urdf"))
    assert kept_names() == [arm.name]
    (listed,) = kept_arms()
    assert (listed.name, listed.title, listed.joints, listed.problem) == (arm.name, "ur5", 6, "")
    experiment = Experiment.from_document(
        {"robot": {"model": arm.name}, "lanes": {"A": {"law": "smc"}}}
    )
    assert experiment_from_yaml(experiment_to_yaml(experiment)) == experiment
    assert arm.name in known_arms()
    forget_arm(arm.name)
    assert remove(arm.name)
    assert not remove(arm.name)
    assert list(arm_folder().iterdir()) == []
    with pytest.raises(
        InvalidExperimentError, match=rf"no arm named {arm.name}.*slidetune arm add"
    ):
        Experiment.from_document(experiment.document())


def test_a_name_is_of_the_numbers_and_not_of_the_looks() -> None:
    plain = own("ur5_robot.urdf")
    assert plain.name == own("ur5_robot.urdf").name
    assert plain.name.startswith("ur5-")
    assert own("ur5_robot.urdf", tip="wrist_3_link").name != plain.name
    assert own("ur10_robot.urdf").name != plain.name


def test_small_differences_of_machines_do_not_rename(tmp_path: Path) -> None:
    arm = own("ur5_robot.urdf")
    document = document_of(arm)
    for joint in document["joints"]:
        joint["mass"] *= 1.0 + 2e-16
        joint["place"]["translation"] = [x * (1.0 + 2e-16) for x in joint["place"]["translation"]]
    assert arm_from(document).name == arm.name
    document["joints"][2]["mass"] *= 1.001
    with pytest.raises(DamagedArmError, match="not those of the arm of its name"):
        arm_from(document)


def test_keeping_an_arm_again_takes_its_place() -> None:
    arm = own("ur5_robot.urdf")
    keep(arm, described("ur5_robot.urdf"))
    (kept_folder(arm.name) / "left").write_text("")
    keep(arm, described("ur5_robot.urdf"))
    names = sorted(path.name for path in kept_folder(arm.name).iterdir())
    assert names == ["arm.json", "arm.urdf", "meshes"]
    assert [path.name for path in arm_folder().iterdir()] == [arm.name]


DAMAGE: dict[str, Any] = {
    "no JSON": b"{",
    "another thing": b"[1, 2]",
    "another format": lambda document: document.update(format=2),
    "nothing": b"",
    "deep": b"[" * 100_000,
    "a joint too few": lambda document: document["joints"].pop(),
    "no joints": lambda document: document.update(joints=[]),
    "many joints": lambda document: document.update(joints=document["joints"] * 3),
    "infinite": lambda document: document["joints"][0].update(mass=1e999),
    "a text for a number": lambda document: document["joints"][0].update(mass="x"),
    "a list for a number": lambda document: document["joints"][0].update(mass=[1]),
    "a mesh elsewhere": lambda document: document["visuals"][0].update(mesh="../../passwd"),
    "a hidden mesh": lambda document: document["visuals"][0].update(mesh=".."),
    "a joint that is not there": lambda document: document["visuals"][0].update(joint=7),
    "no rotation": lambda document: document["flange"].update(rotation=[[1, 2, 3]] * 3),
    "another name": lambda document: document.update(name="ur5-00000000"),
    "no axis": lambda document: document["joints"][0].update(axis=[0, 0, 0]),
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_a_damaged_kept_arm_is_told_and_takes_nothing_down(kind: str) -> None:
    arm, damage = own("ur5_robot.urdf"), DAMAGE[kind]
    keep(arm, described("ur5_robot.urdf"))
    path = kept_folder(arm.name) / "arm.json"
    if callable(damage):
        document = json.loads(path.read_bytes())
        damage(document)
        damage = json.dumps(document).encode()
    path.write_bytes(damage)
    with pytest.raises(DamagedArmError, match=r"is damaged.*slidetune arm add"):
        kept_arm(arm.name)
    with pytest.raises(InvalidExperimentError, match="is damaged"):
        Experiment.from_document({"robot": {"model": arm.name}})
    assert arm.name not in known_arms()
    assert [one.name for one in kept_arms()] == [arm.name]
    keep(arm, described("ur5_robot.urdf"))
    assert kept_arm(arm.name) is not None


def test_no_name_leads_out_of_the_folder(tmp_path: Path) -> None:
    for name in ("..", "../x-00000000", "/etc/x-00000000", "", ".x-00000000", "a/b-00000000"):
        assert not is_own_name(name)
        assert kept_arm(name) is None
        assert not remove(name)


def test_too_many_and_too_large_meshes_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    arm = own("ur5_robot.urdf")
    monkeypatch.setattr(kept, "MOST_MESHES", 3)
    with pytest.raises(ArmStorageError, match="at most 3"):
        keep(arm, described("ur5_robot.urdf"))
    monkeypatch.setattr(kept, "MOST_MESHES", 100)
    monkeypatch.setattr(kept, "MOST_BYTES", 1000)
    with pytest.raises(ArmStorageError, match="at most 1,000"):
        keep(arm, described("ur5_robot.urdf"))
    assert kept_names() == []


def test_a_folder_that_can_not_be_written_is_told(tmp_path: Path) -> None:
    arm_folder().write_text("a file")
    assert (kept_names(), kept_arms()) == ([], [])
    with pytest.raises(ArmStorageError, match="can't keep the arm"):
        keep(own("ur5_robot.urdf"), described("ur5_robot.urdf"))


def test_the_arms_that_ship_are_drawn_and_have_their_limits() -> None:
    for arm in shipped_arms().values():
        assert {visual.joint for visual in arm.visuals} == set(range(arm.joints + 1))
        assert all(visual.mesh is None or visual.mesh.is_file() for visual in arm.visuals)
        assert np.all(np.array(arm.lower) < np.array(arm.home))
        assert np.all(np.array(arm.home) < np.array(arm.upper))
        assert min(arm.effort) > 1.0
        assert min(arm.velocity) > 1.0
    rod = arm_named("pendulum").visuals[1]
    assert rod.cylinder is not None


def test_a_worker_without_the_arm_takes_it_from_the_task(tmp_path: Path) -> None:
    arm = own("ur5_robot.urdf")
    document = json.dumps(document_of(arm))
    program = (
        "import json, sys\n"
        "from slidetune.robot.arm.arm_document import arm_from\n"
        "from slidetune.robot.arm.known import add_arm\n"
        "add_arm(arm_from(json.load(sys.stdin)))\n"
        "from slidetune.robot.experiment.document import Experiment\n"
        f"print(Experiment.from_document({{'robot': {{'model': '{arm.name}'}}}}).joints)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        input=document,
        capture_output=True,
        encoding="utf-8",
        cwd=ROOT,
        timeout=300,
    )
    assert (done.returncode, done.stdout) == (0, "6\n"), done.stderr


def test_homes_are_within_the_limits_and_not_singular() -> None:
    for name in ("ur5_robot.urdf", "panda.urdf", "xarm7.urdf", "tiago.urdf", "kinova.urdf"):
        arm = own(name)
        home = np.array(arm.home)
        assert np.all((np.array(arm.lower) < home) & (home < np.array(arm.upper)))
        model, data = arm.model, arm.model.createData()
        J = pin.computeFrameJacobian(model, data, home, model.getFrameId(arm.tip))
        assert np.linalg.svd(J, compute_uv=False).min() > 0.05
        torque = np.abs(pin.computeGeneralizedGravity(model, data, home))
        assert np.all(torque < np.array(arm.effort))


def test_an_experiment_of_an_own_arm_travels_as_bytes() -> None:
    arm = own("ur5_robot.urdf")
    keep(arm, described("ur5_robot.urdf"))
    experiment = Experiment.from_document({"robot": {"model": arm.name}})
    assert pickle.loads(pickle.dumps(experiment)) == experiment
