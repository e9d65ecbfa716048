"""A Viser server of our own, and the room in which the arm stands.

It listens on loopback only, prints nothing and never opens a tunnel; others reach it through the
relay. A browser shows it dark when its address ends with ``?darkMode``.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress

import numpy as np
import rich
import viser

from slidetune.robot.arm.known import SHIPPED
from slidetune.server.scene.shape import Shape

CAMERA = (2.25, -1.85, 1.05)
"""Where the camera stands at first in [m] (*ours*)."""
LOOK_AT = (0.1, 0.0, 0.08)
"""What it looks at in [m] (*ours*): the middle of what the arm reaches."""
REACH = 1.1
"""Reach in [m] of the arm for which that holds (*ours*): a larger one is seen from farther away."""
FIELD_OF_VIEW = 0.72
"""Vertical field of view in [rad] (*ours*)."""

PEDESTAL = 0.75
"""Height of the arm's base above the floor in [m] (*ours*): the paper's sine dips 0.53 m below
the base."""
LEAST = 0.6
"""Share of that distance from which a small arm is seen at least (*ours*): with its room."""
FLOOR = 2.6
"""Radius at which the floor has faded away in [m] (*ours*)."""
PEDESTAL_COLOR = (126, 131, 139)
"""*Ours*."""
GREY = (128, 134, 144)
"""Seen on white and on black alike (*ours*)."""


class Viewer(viser.ViserServer):
    """Viser without the tunnel that it offers to the outside."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Refuse: any page could ask for it, and it would publish the scene."""
        return None


@contextmanager
def _hushed() -> Iterator[None]:
    # Viser prints a banner and a farewell through rich, whatever it is told.
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before


def open_viewer(port: int | None) -> Viewer:
    """Start a viewer on 127.0.0.1 with an empty room.

    Args:
        port: wanted TCP port, the next free one if it is taken; ``None`` for any.
    """
    with _hushed():
        viewer = Viewer(host="127.0.0.1", port=port or 0, verbose=False)

    @viewer.on_client_disconnect
    async def forget(_: viser.ClientHandle) -> None:
        with suppress(AttributeError):  # another version of Viser may keep its messages otherwise
            _renumber(viewer)

    _dress(viewer)
    _light(viewer.scene)
    _furnish(viewer.scene)
    return viewer


def close_viewer(viewer: Viewer) -> None:
    """Stop a viewer and its threads."""
    with _hushed():
        viewer.stop()


def look_at_arm(viewer: Viewer, shape: Shape) -> None:
    """Let a browser that comes see the whole of an arm."""
    if shape.name == SHIPPED:
        viewer.initial_camera.position, viewer.initial_camera.look_at = CAMERA, LOOK_AT
        return
    middle = shape.shoulder
    away = max(shape.reach / REACH, LEAST) * (np.array(CAMERA) - np.array(LOOK_AT))
    viewer.initial_camera.position = middle + away
    viewer.initial_camera.look_at = middle


def _renumber(viewer: Viewer) -> None:
    """Number the messages that Viser keeps from 0 on, if nobody is connected.

    Viser numbers all messages that it ever sent and walks through all numbers, kept or not, for
    a new client: 0.4 s for every hour that somebody has watched.
    """
    buffer = viewer._websock_server._broadcast_buffer
    with buffer.buffer_lock:
        if buffer.generator_cursors:
            return
        kept = [buffer.message_from_id[number] for number in sorted(buffer.message_from_id)]
        buffer.message_from_id = dict(enumerate(kept))
        buffer.message_counter = len(kept)
        buffer.id_from_redundancy_key = {m.redundancy_key(): i for i, m in enumerate(kept)}
        buffer.ids_from_entity_state_key = {}
        for number, message in enumerate(kept):
            key = message.entity_state_key()
            if key is not None:
                buffer.ids_from_entity_state_key.setdefault(key, set()).add(number)


def _dress(viewer: Viewer) -> None:
    # The page hides Viser's panel, but its button for the camera has to be there.
    viewer.gui.configure_theme(show_logo=False, show_share_button=False, control_width="small")
    viewer.initial_camera.position = CAMERA
    viewer.initial_camera.look_at = LOOK_AT
    viewer.initial_camera.fov = FIELD_OF_VIEW
    viewer.initial_camera.near = 0.02
    viewer.initial_camera.far = 60.0


def _light(scene: viser.SceneApi) -> None:
    # No environment map and one shadow instead of Viser's three: where the browser has to draw
    # without a graphics card, those two take three quarters of the time.
    scene.configure_environment_map(None)
    scene.configure_default_lights(False)
    scene.add_light_hemisphere(
        "/light/sky",
        sky_color=(255, 255, 255),
        ground_color=(150, 155, 165),
        intensity=2.6,
        position=(0.0, 0.0, 1.0),
    )
    scene.add_light_spot(
        "/light/key",
        position=(0.9, -1.3, 3.4),
        direction=(-0.22, 0.34, -1.0),
        angle=0.5,
        penumbra=0.7,
        decay=0.0,
        intensity=2.6,
        cast_shadow=True,
    )
    scene.add_light_directional("/light/fill", position=(1.0, 1.6, 0.6), intensity=0.9)


def _furnish(scene: viser.SceneApi) -> None:
    scene.add_grid(
        "/floor",
        position=(0.0, 0.0, -PEDESTAL),
        width=2 * FLOOR,
        height=2 * FLOOR,
        cell_size=0.1,
        cell_color=GREY,
        cell_thickness=0.5,
        section_size=0.5,
        section_color=GREY,
        section_thickness=1.0,
        fade_from="origin",
        fade_distance=FLOOR,
        fade_strength=1.5,
        plane_color=GREY,
        plane_opacity=0.16,
        shadow_opacity=0.35,
    )
    column, foot = PEDESTAL - 0.02, 0.02
    scene.add_cylinder(
        "/pedestal",
        0.068,
        column,
        PEDESTAL_COLOR,
        position=(0.0, 0.0, -0.5 * column),
        receive_shadow=False,
    )
    scene.add_cylinder(
        "/pedestal/foot",
        0.17,
        foot,
        PEDESTAL_COLOR,
        position=(0.0, 0.0, -0.5 * column),
        receive_shadow=False,
    )
    scene.add_frame("/base", axes_length=0.25, axes_radius=0.004, origin_radius=0.0)
