"""Arms of the user's own, kept in the data folder: each in a folder, with its URDF and meshes."""

from __future__ import annotations

import errno
import json
import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import platformdirs

from slidetune.robot.arm.arm_document import DamagedArmError, arm_from, document_of
from slidetune.robot.arm.known_arm import KnownArm, is_own_name
from slidetune.robot.errors import ArmStorageError
from slidetune.robot.fields.written_value import written

FOLDER_VARIABLE = "SLIDETUNE_ARMS"
"""Environment variable that names another folder for the user's arms."""
MOST_ARMS = 200
"""Most arms that are kept (*ours*)."""
MOST_MESHES = 500
"""Most files of meshes of one arm (*ours*)."""
MOST_BYTES = 500_000_000
"""Most bytes of all meshes of one arm (*ours*)."""
_LARGEST_DOCUMENT = 10_000_000
"""Bytes of a document above which it isn't read (*ours*): an arm's has a few thousand."""
_DOCUMENT, _URDF, _MESHES = "arm.json", "arm.urdf", "meshes"
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


@dataclass(frozen=True)
class KeptArm:
    """What a list shows of a kept arm.

    Attributes:
        name: value of ``model`` in the section ``robot``.
        title: name on the screen.
        meaning: the arm in one line.
        joints: how many joints it has, 0 where it is damaged.
        problem: why it can't be used, or an empty text.
    """

    name: str
    title: str
    meaning: str
    joints: int
    problem: str = ""


def arm_folder() -> Path:
    """Return the folder of the user's arms: ``SLIDETUNE_ARMS``, or one of the data folder."""
    folder = os.environ.get(FOLDER_VARIABLE)
    return Path(folder) if folder else Path(platformdirs.user_data_dir("slidetune")) / "arms"


def kept_names() -> list[str]:
    """Return the names of all kept arms, in order; reads none of them."""
    try:
        with os.scandir(arm_folder()) as entries:
            return sorted(entry.name for entry in entries if is_own_name(entry.name))
    except OSError:
        return []


def kept_arm(name: str) -> KnownArm | None:
    """Return a kept arm, ``None`` where there is none of that name.

    Raises:
        DamagedArmError: if what is kept is no arm; says how to keep it anew.
    """
    if not is_own_name(name):
        return None
    folder = arm_folder() / name
    try:
        document = _read(folder)
        if document is None:
            return None
        arm = arm_from(document, folder / _MESHES)
        if arm.name != name:
            raise DamagedArmError(f"it is {arm.name}")
        return arm
    except DamagedArmError as error:
        text = f"the kept arm {name} is damaged: {error}; keep it anew: slidetune arm add FILE"
        raise DamagedArmError(text) from error


def kept_arms() -> list[KeptArm]:
    """Return what a list shows of all kept arms; makes no model of them."""
    return [_shown(name) for name in kept_names()]


def _shown(name: str) -> KeptArm:
    try:
        document = _read(arm_folder() / name)
        if not isinstance(document, dict):
            raise DamagedArmError("it has no document")
        title, meaning, joints = document["title"], document["meaning"], document["joints"]
        if not (isinstance(title, str) and isinstance(meaning, str) and isinstance(joints, list)):
            raise DamagedArmError("its document is none of an arm")
    except (DamagedArmError, KeyError) as error:
        problem = f"damaged: {error}; keep it anew, or slidetune arm remove {name}"
        return KeptArm(name, name, "", 0, problem)
    return KeptArm(name, written(title), written(meaning), len(joints))


def _read(folder: Path) -> object:
    """Return the document in a folder, ``None`` where there is no such folder."""
    try:
        if not folder.is_dir():
            return None
        with (folder / _DOCUMENT).open("rb") as file:
            content = file.read(_LARGEST_DOCUMENT + 1)
    except OSError as error:
        raise DamagedArmError(f"{_DOCUMENT} can't be read: {error.strerror or error}") from error
    if len(content) > _LARGEST_DOCUMENT:
        raise DamagedArmError(f"{_DOCUMENT} has more than {_LARGEST_DOCUMENT:,} bytes")
    try:
        document: object = json.loads(content)
    except (ValueError, RecursionError) as error:
        raise DamagedArmError(f"{_DOCUMENT} is no JSON: {error}") from error
    return document


def keep(arm: KnownArm, urdf: Path) -> KnownArm:
    """Keep one of the user's arms: its document, its URDF and the meshes that its visuals show.

    One that is kept under that name already has the same numbers, and gives way.

    Args:
        arm: what ``own_arm`` returned.
        urdf: the file that it was read from.

    Returns:
        The arm with its meshes where they are kept.

    Raises:
        ArmStorageError: if it has too many or too large meshes, or the folder can't be written.
    """
    folder = arm_folder()
    meshes = _mesh_names(arm)
    if arm.name not in (known := kept_names()) and len(known) >= MOST_ARMS:
        text = f"{MOST_ARMS} arms are kept already: remove one by slidetune arm remove NAME"
        raise ArmStorageError(text)
    with _writing(f"keep the arm {arm.name} in {folder}"):
        folder.mkdir(parents=True, exist_ok=True)
        made = Path(tempfile.mkdtemp(dir=folder, prefix=".", suffix=".tmp"))
        try:
            (made / _MESHES).mkdir()
            for path, name in meshes.items():
                shutil.copyfile(path, made / _MESHES / name)
            shutil.copyfile(urdf, made / _URDF)
            text = json.dumps(document_of(arm, meshes), allow_nan=False, ensure_ascii=False)
            (made / _DOCUMENT).write_text(text, encoding="utf-8")
            made.chmod(0o755)
            _take_the_place(made, folder / arm.name)
        finally:
            shutil.rmtree(made, ignore_errors=True)
    found = kept_arm(arm.name)
    if found is None:
        raise ArmStorageError(f"the arm {arm.name} was removed at once by another program")
    return found


def _take_the_place(made: Path, place: Path) -> None:
    """Give a new folder its name; one that has it gives way."""
    for _ in range(3):
        try:
            os.rename(made, place)
            return
        except OSError as error:
            if error.errno not in (errno.ENOTEMPTY, errno.EEXIST, errno.ENOTDIR):
                raise
        _put_away(place)
    os.rename(made, place)


def _put_away(place: Path) -> None:
    """Remove a folder: under its name there is all of it or nothing."""
    away = Path(tempfile.mkdtemp(dir=place.parent, prefix=".", suffix=".old"))
    try:
        os.rename(place, away / "arm")
    finally:
        shutil.rmtree(away, ignore_errors=True)


def remove(name: str) -> bool:
    """Remove a kept arm; tell whether there was one.

    Raises:
        ArmStorageError: if the folder can't be written.
    """
    if name not in kept_names():
        return False
    with _writing(f"remove the arm {name} from {arm_folder()}"):
        _put_away(arm_folder() / name)
    return True


def _mesh_names(arm: KnownArm) -> dict[Path, str]:
    """Return the files of an arm's meshes with the names that they are kept by.

    Raises:
        ArmStorageError: if there are too many, or they are too large.
    """
    paths = dict.fromkeys(visual.mesh for visual in arm.visuals if visual.mesh is not None)
    if len(paths) > MOST_MESHES:
        raise ArmStorageError(f"{arm.title} has {len(paths)} meshes, at most {MOST_MESHES} can be")
    with _writing(f"read the meshes of {arm.title}"):
        size = sum(path.stat().st_size for path in paths)
    if size > MOST_BYTES:
        text = f"the meshes of {arm.title} have {size:,} bytes, at most {MOST_BYTES:,} can be"
        raise ArmStorageError(f"{text}: simplify the largest")
    return {
        path: f"{number:03d}-{re.sub(r'[^a-z0-9]+', '-', path.stem.lower())[:40]}"
        f"{re.sub(r'[^a-z0-9.]', '', path.suffix.lower())}"
        for number, path in enumerate(paths)
    }


@contextmanager
def _writing(action: str) -> Iterator[None]:
    try:
        yield
    except ArmStorageError:
        raise
    except OSError as error:
        text = f"can't {action}: {error.strerror or error}"
        way_out = ": free some space" if error.errno in _FULL else ""
        raise ArmStorageError(f"{text}{way_out}") from error
