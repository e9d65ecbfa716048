"""Write ``meshes/*.glb``, one a link: ``python -m slidetune.robot.arm.description.shapes``."""

from collections.abc import Callable, Mapping
from math import cos, pi, sin
from pathlib import Path
from typing import NamedTuple

import trimesh
from trimesh.exchange.gltf import export_glb
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from slidetune.robot.arm.description import LINK_NAMES, MESH_DIR, profiles
from slidetune.robot.arm.description.rings import (
    Profile,
    Surface,
    capped_lathe,
    join,
    lathe,
    placed,
)
from slidetune.robot.arm.description.solids import block, flare_arm, loft

SECTIONS = 64
"""Points around a barrel or tube (ours)."""

Vector = tuple[float, float, float]
ORIGIN: Vector = (0.0, 0.0, 0.0)
X: Vector = (1.0, 0.0, 0.0)
Y: Vector = (0.0, 1.0, 0.0)
Z: Vector = (0.0, 0.0, 1.0)


def _opposite(direction: Vector) -> Vector:
    x, y, z = direction
    return (-x, -y, -z)


class Finish(NamedTuple):
    """How a part looks: its sRGB colour, and how metallic and rough it is, all in 0..1."""

    colour: Vector
    metallic: float
    roughness: float


FINISHES: Mapping[str, Finish] = {
    "housing": Finish((0.86, 0.87, 0.88), 0.0, 0.45),
    "tube": Finish((0.9, 0.905, 0.91), 0.05, 0.4),
    "cap": Finish((0.27, 0.3, 0.34), 0.0, 0.5),
    "base": Finish((0.62, 0.64, 0.66), 0.1, 0.5),
    "metal": Finish((0.74, 0.75, 0.77), 0.2, 0.4),
    "dark": Finish((0.1, 0.1, 0.11), 0.0, 0.6),
    "blue": Finish((0.1, 0.42, 0.78), 0.0, 0.4),
}
"""Ours; the manufacturer's drawing has one grey."""

Part = tuple[str, Surface]


def _barrel(barrel: profiles.Barrel, origin: Vector, axis: Vector, stub: Vector) -> list[Part]:
    body, cap = capped_lathe(barrel.profile, barrel.seam, SECTIONS)
    return [("housing", placed(body, origin, axis, stub)), ("cap", placed(cap, origin, axis, stub))]


def _turned(
    finish: str, profile: Profile, origin: Vector, axis: Vector, sections: int = SECTIONS
) -> Part:
    towards = X if axis[0] == 0.0 else Z
    return (finish, placed(lathe(profile, sections), origin, axis, towards))


def _disc(radius: float, centre: Vector, axis: Vector = Z) -> Part:
    return _turned("dark", [(0.0, radius), (0.0, 0.0)], centre, axis, 24)


def _base() -> list[Part]:
    arm = flare_arm(profiles.FLARE, 30, 50, 13)
    arms = join([placed(arm, ORIGIN, Z, towards) for towards in (X, Y, (-1, 0, 0), (0, -1, 0))])
    connectors = block(82, 22, 4, [(3, 0), (35, 0), (36, 1)])
    return [
        _turned("base", profiles.FOOT, ORIGIN, Z),
        ("base", arms),
        _turned("base", profiles.NECK, ORIGIN, Z),
        ("cap", connectors),
        *(_disc(4.5, (x, y, 10.3)) for x in (-49.5, 49.5) for y in (-49.5, 49.5)),
    ]


def _shoulder() -> list[Part]:
    return [*_barrel(profiles.BIG, ORIGIN, Z, Y), _turned("housing", profiles.BIG_STUB, ORIGIN, Y)]


def _upper_arm() -> list[Part]:
    tube = (0.0, 0.0, -144.0)
    return [
        *_barrel(profiles.BIG, tube, _opposite(Z), X),
        *_barrel(profiles.BIG, (430.0, 0.0, -144.0), _opposite(Z), _opposite(X)),
        _turned("tube", profiles.UPPER_TUBE, tube, X),
    ]


def _forearm() -> list[Part]:
    return [
        _turned("housing", [(-64, 0), (-64, 58), (-63, 59)], ORIGIN, Z),
        ("housing", loft(profiles.ELBOW, 33, SECTIONS)),
        _turned("tube", profiles.FOREARM_TUBE, ORIGIN, X),
        *_barrel(profiles.SMALL, (368.5, 0.0, 0.0), Z, _opposite(X)),
    ]


def _wrist_1() -> list[Part]:
    return [
        *_barrel(profiles.SMALL, ORIGIN, Y, Z),
        _turned("housing", profiles.SMALL_STUB, ORIGIN, Z),
    ]


def _wrist_2() -> list[Part]:
    return [
        *_barrel(profiles.WRIST, ORIGIN, _opposite(Y), _opposite(Z)),
        _turned("housing", profiles.SMALL_STUB, ORIGIN, _opposite(Z)),
    ]


def _flange() -> list[Part]:
    button: Profile = [(38, 6), (41, 6), (42, 5), (42, 0)]
    socket: Profile = [(38, 6), (41, 6), (42, 5), (42, 0)]
    height = (0.0, 0.0, -26.0)
    sides = [(sin(angle), cos(angle), 0.0) for angle in (-pi / 6, pi / 6)]
    screws = [(25.0, 0.0, 0.3), (0.0, 25.0, 0.3), (-25.0, 0.0, 0.3), (0.0, -25.0, 0.3)]
    return [
        _turned("metal", profiles.FLANGE, ORIGIN, Z),
        *(("blue", placed(lathe(button, 24), height, side, Z)) for side in sides),
        ("metal", placed(lathe(socket, 24), (0.0, 0.0, -27.0), _opposite(Y), Z)),
        _disc(4.0, (0.0, -42.3, -27.0), _opposite(Y)),
        *(_disc(3.0, centre) for centre in screws),
        _disc(3.0, (-17.68, 17.68, 0.3)),
    ]


LINK_PARTS: Mapping[str, Callable[[], list[Part]]] = dict(
    zip(
        LINK_NAMES,
        (_base, _shoulder, _upper_arm, _forearm, _wrist_1, _wrist_2, _flange),
        strict=True,
    )
)


def link_scene(link: str) -> trimesh.Scene:
    """Build one link.

    Args:
        link: A name of ``LINK_NAMES``.

    Returns:
        A scene in [m] with one mesh a finish, named after it.
    """
    parts = LINK_PARTS[link]()
    scene = trimesh.Scene()
    for name in FINISHES:
        surfaces = [surface for finish, surface in parts if finish == name]
        if surfaces:
            scene.add_geometry(_mesh(join(surfaces), name), name, name)
    return scene


def _mesh(surface: Surface, name: str) -> trimesh.Trimesh:
    finish = FINISHES[name]
    material = PBRMaterial(  # type: ignore[no-untyped-call]
        name=name,
        baseColorFactor=[*_linear(finish.colour), 1.0],
        metallicFactor=finish.metallic,
        roughnessFactor=finish.roughness,
    )
    look = TextureVisuals(material=material)  # type: ignore[no-untyped-call]
    return trimesh.Trimesh(
        vertices=surface.points * 1e-3,
        faces=surface.faces,
        vertex_normals=surface.normals,
        visual=look,
        process=False,
    )


def _linear(colour: Vector) -> list[float]:
    """Linear light of an sRGB colour: what glTF stores."""
    return [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in colour]


def write_meshes(folder: Path = MESH_DIR) -> None:
    """Write every link's GLB into an existing folder."""
    for link in LINK_NAMES:
        scene = link_scene(link)
        data = export_glb(scene, include_normals=True)  # type: ignore[no-untyped-call]
        (folder / f"{link}.glb").write_bytes(data)


if __name__ == "__main__":
    write_meshes()
