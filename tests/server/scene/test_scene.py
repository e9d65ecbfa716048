"""The scene as a browser would see it, over a real connection to a real Viser."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.arm.arm import flange_positions, shipped_places
from slidetune.robot.arm.section import Robot
from slidetune.server.scene.arm import payload_radius
from slidetune.server.scene.exaggeration import exaggerated_angles
from slidetune.server.scene.scene import FROZEN, LaneStyle, Scene, SceneFrame
from slidetune.server.scene.trails import POINTS
from tests.server.scene.viser_client import ViserClient, until

Array = np.ndarray

LANES = (
    LaneStyle("first", "#0072b2"),
    LaneStyle("second", "#d55e00"),
    LaneStyle("third", "#009e73"),
)
LOOP = np.array([[0.5, 0.0, 0.2], [0.6, 0.3, 0.4], [0.2, 0.5, 0.6]])
Q_D = np.array([0.3, 1.1, -0.7, 0.5, -0.4, 0.2])
OFFSETS = {"first": 0.02, "second": -0.03, "third": 0.05}


def frame(step: int = 0, frozen: frozenset[str] = frozenset(), rows: int = 33) -> SceneFrame:
    """Return the picture number `step` of joints that turn evenly."""

    def angles(number: Array, offset: float = 0.0) -> Array:
        return Q_D + 0.001 * number[:, None] + offset

    numbers = rows * step + np.arange(rows + 1)
    names = OFFSETS
    return SceneFrame(
        q_d=angles(numbers[-1:])[0],
        q={name: angles(numbers[-1:], names[name])[0] for name in names},
        frozen=frozen,
        desired_path=flange_positions(angles(numbers[1:]), shipped_places()),
        paths={
            name: flange_positions(angles(numbers[1:], names[name]), shipped_places())
            for name in names
        },
        period=0.001,
    )


@pytest.fixture
def scene() -> Iterator[Scene]:
    scene = Scene()
    scene.configure(LANES, "first", Robot(), LOOP)
    yield scene
    scene.close()


@pytest.fixture
def browser(scene: Scene) -> Iterator[ViserClient]:
    with ViserClient(scene.port) as browser:
        yield browser


def chain(arm: str) -> list[str]:
    """Return the names of an arm's turning nodes."""
    return ["/".join([arm, *"123456"[:i]]) for i in range(1, 7)]


def ghosts(browser: ViserClient) -> list[str]:
    """Return the arms below which a ghost is seen."""
    return [f"/ghost_{i}" for i in range(3) if browser.visible[chain(f"/ghost_{i}")[0]]]


def flange_of(browser: ViserClient, arm: str) -> Array:
    """Return where a browser has an arm's flange: its nodes' poses, one in the other."""
    place = pin.SE3.Identity()
    for node in chain(arm):
        w, x, y, z = browser.poses[node]["wxyz"]
        turn = pin.Quaternion(w, x, y, z).toRotationMatrix()
        place = place * pin.SE3(turn, browser.poses[node]["position"])
    return np.asarray(place.translation)


def stands(browser: ViserClient, arm: str, angles: Array) -> bool:
    there = flange_of(browser, arm)
    return bool(np.linalg.norm(there - flange_positions(angles[None], shipped_places())[0]) < 2e-5)


def replay(scene: Scene) -> tuple[int, set[str]]:
    """Return how many messages a newcomer gets, and the nodes that they make."""
    with ViserClient(scene.port) as newcomer:
        return newcomer.replayed, set(newcomer.nodes)


@pytest.mark.parametrize("step", [0, 1, 7])
@pytest.mark.parametrize("exaggeration", [1.0, 12.0])
def test_every_arm_stands_where_its_angles_put_it(
    scene: Scene, browser: ViserClient, exaggeration: float, step: int
) -> None:
    scene.view(exaggeration, ghosts=True)
    now = frame(step)
    drawn = {name: exaggerated_angles(now.q_d, q, exaggeration) for name, q in now.q.items()}
    arms = {"/arm": "first", "/ghost_1": "second", "/ghost_2": "third"}
    until(
        lambda: all(stands(browser, arm, drawn[name]) for arm, name in arms.items()),
        lambda: scene.update(now),
    )
    handle = flange_positions(drawn["first"][None], shipped_places())[0]
    until(lambda: np.allclose(browser.poses["/pull"]["position"], handle, atol=1e-4))


def test_a_thousand_pictures_add_no_node_and_no_message(scene: Scene, browser: ViserClient) -> None:
    until(lambda: len(scene._viewer.get_clients()) == 1)
    scene.view(10.0, ghosts=True)
    for step in range(3):
        scene.update(frame(step))
    kept = replay(scene)
    before = browser.count
    for step in range(3, 1003):
        scene.update(frame(step))
    until(lambda: stands(browser, "/ghost_2", _drawn(1002)))
    assert browser.count > before + 20
    assert replay(scene) == kept
    assert set(browser.nodes) == kept[1]


def _drawn(step: int) -> Array:
    now = frame(step)
    return exaggerated_angles(now.q_d, now.q["third"], 10.0)


def test_changing_lanes_adds_no_node(scene: Scene, browser: ViserClient) -> None:
    scene.update(frame())
    kept = replay(scene)[1]
    for number in range(20):
        styles = [LaneStyle(f"{lane.name} {number}", lane.color) for lane in LANES]
        scene.configure(styles[number % 2 :], styles[-1].name, Robot(), LOOP + 0.01 * number)
        scene.update(frame())
    assert replay(scene)[1] == kept


def test_the_same_again_sends_nothing(scene: Scene, browser: ViserClient) -> None:
    until(lambda: len(scene._viewer.get_clients()) == 1)
    still = frame(rows=0)
    scene.update(still)
    until(lambda: stands(browser, "/arm", still.q["first"]))
    buffer = scene._viewer._websock_server.get_message_buffer()
    before = buffer.message_counter
    for _ in range(5):
        scene.configure(LANES, "first", Robot(), LOOP)
        scene.view(1.0, ghosts=True)
        scene.update(still)
    assert buffer.message_counter == before


def test_nothing_is_sent_while_nobody_looks(scene: Scene) -> None:
    buffer = scene._viewer._websock_server.get_message_buffer()
    before = buffer.message_counter
    for step in range(10):
        scene.update(frame(step))
    assert buffer.message_counter == before


def test_who_comes_late_sees_the_present_and_the_trail(scene: Scene) -> None:
    for step in range(200):
        scene.update(frame(step))
    now = frame(199, rows=33)
    with ViserClient(scene.port) as late:
        until(lambda: stands(late, "/arm", now.q["first"]), lambda: scene.update(now))
        points = late.nodes["/trail_0"]["points"].reshape(POINTS, 2, 3)
        assert (
            np.linalg.norm(
                points[-1, 1] - flange_positions(now.q["first"][None], shipped_places())[0]
            )
            < 1e-4
        )
        assert np.linalg.norm(np.diff(points, axis=1), axis=2).sum() > 0.5


def test_a_long_show_leaves_no_gaps_for_the_next_visitor(scene: Scene) -> None:
    with ViserClient(scene.port) as browser:
        until(lambda: len(scene._viewer.get_clients()) == 1)
        for step in range(100):
            scene.update(frame(step))
        until(lambda: stands(browser, "/arm", frame(99).q["first"]))
        seen = {name: browser.poses[name]["wxyz"] for name in chain("/arm") + chain("/ghost_1")}
        nodes, visible = set(browser.nodes), dict(browser.visible)
    buffer = scene._viewer._websock_server.get_message_buffer()
    until(lambda: buffer.message_counter == len(buffer.message_from_id))
    with ViserClient(scene.port) as next_one:
        assert next_one.replayed <= len(buffer.message_from_id)
        assert (set(next_one.nodes), next_one.visible) == (nodes, visible)
        for name, wxyz in seen.items():
            assert next_one.poses[name]["wxyz"] == pytest.approx(wxyz)
        now = frame(150)
        until(lambda: stands(next_one, "/arm", now.q["first"]), lambda: scene.update(now))
    assert replay(scene)[1] == nodes


def test_the_selected_arm_is_solid_and_the_others_are_ghosts(
    scene: Scene, browser: ViserClient
) -> None:
    for index, lane in enumerate(LANES):
        scene.configure(LANES, lane.name, Robot(), LOOP)
        others = [f"/ghost_{i}" for i in range(3) if i != index]
        until(lambda others=others: ghosts(browser) == others, lambda: scene.update(frame()))  # type: ignore[misc]
        until(lambda lane=lane: stands(browser, "/arm", frame().q[lane.name]))  # type: ignore[misc]
        widths = [browser.nodes[f"/trail_{i}"]["thickness"] for i in range(3)]
        assert widths.index(max(widths)) == index
        assert len(set(widths)) == 2


def test_ghosts_and_bands_and_trails_have_the_lanes_colours(
    scene: Scene, browser: ViserClient
) -> None:
    until(lambda: len(ghosts(browser)) == 2, lambda: scene.update(frame()))
    assert browser.nodes[f"{chain('/arm')[-1]}/flange/band"]["color"] == (0x00, 0x72, 0xB2)
    assert {browser.nodes[name]["color"] for name in chain("/ghost_1")} == {(0xD5, 0x5E, 0x00)}
    young = browser.nodes["/trail_2"]["colors"].reshape(POINTS, 2, 3)[-1, 1] / 255.0
    # What is sent is linear light.
    assert (255 * (1.055 * young ** (1 / 2.4) - 0.055) * (young > 0)).round() == pytest.approx(
        [0x00, 0x9E, 0x73], abs=2
    )


def test_ghosts_can_be_switched_off(scene: Scene, browser: ViserClient) -> None:
    scene.view(1.0, ghosts=False)
    until(lambda: stands(browser, "/arm", frame().q["first"]), lambda: scene.update(frame()))
    assert ghosts(browser) == []
    scene.view(1.0, ghosts=True)
    until(lambda: len(ghosts(browser)) == 2, lambda: scene.update(frame()))


def test_a_lane_that_has_stopped_turns_grey_and_stands_still(
    scene: Scene, browser: ViserClient
) -> None:
    for step in range(3):
        scene.update(frame(step))
    scene.view(10.0, ghosts=True)
    stopped = frozenset({"second"})
    skin = chain("/ghost_1")[0]
    until(lambda: browser.nodes[skin]["color"] == FROZEN, lambda: scene.update(frame(3, stopped)))
    last = frame(2)
    held = exaggerated_angles(last.q_d, last.q["second"], 10.0)
    for step in range(4, 40):
        scene.update(frame(step, stopped))
    now = frame(39)
    until(lambda: stands(browser, "/arm", exaggerated_angles(now.q_d, now.q["first"], 10.0)))
    assert stands(browser, "/ghost_1", held)


def test_the_trail_of_a_stopped_lane_is_exaggerated_with_the_others(
    scene: Scene, browser: ViserClient
) -> None:
    stopped = frozenset({"second"})
    for step in range(60):
        scene.update(frame(step, stopped if step > 40 else frozenset()))

    def oldest(factor: float) -> Array:
        q_d = frame().q_d[None]
        drawn = exaggerated_angles(q_d, q_d + OFFSETS["second"], factor)
        there: Array = flange_positions(drawn, shipped_places())[0]
        return there

    for factor in (1.0, 9.0):
        scene.view(factor, ghosts=True)
        until(
            lambda factor=factor: np.allclose(  # type: ignore[misc]
                browser.nodes["/trail_1"]["points"][:3], oldest(factor), atol=1e-4
            ),
            lambda: scene.update(frame(60, stopped)),
        )


def test_a_selected_lane_that_has_stopped_is_seen_as_one(
    scene: Scene, browser: ViserClient
) -> None:
    moving = chain("/arm")[0]
    until(
        lambda: browser.visible[moving] and len(ghosts(browser)) == 2, lambda: scene.update(frame())
    )
    stopped = frame(1, frozenset({"first"}))
    until(lambda: not browser.visible[moving], lambda: scene.update(stopped))
    assert "/ghost_0" in ghosts(browser)
    assert browser.visible["/arm"]  # its base
    scene.clear_trails()
    until(lambda: browser.visible[moving], lambda: scene.update(frame()))


def test_clearing_hides_the_trails_until_there_are_new_ones(
    scene: Scene, browser: ViserClient
) -> None:
    until(lambda: browser.visible["/trail_0"], lambda: scene.update(frame()))
    scene.clear_trails()
    until(lambda: not browser.visible["/trail_0"], lambda: scene.update(frame(rows=0)))


def test_the_payload_is_a_ball_of_its_mass_at_its_centre(
    scene: Scene, browser: ViserClient
) -> None:
    ball = f"{chain('/arm')[-1]}/flange/payload"
    assert not browser.visible[ball]
    assert browser.nodes[ball]["radius"] < 1e-3  # else a pointer would meet it all the same
    for mass in (1.0, 8.0):
        robot = Robot.model_validate({"payload": {"mass": mass, "center": (0.01, -0.02, 0.11)}})
        scene.configure(LANES, "first", robot, LOOP)
        radius = payload_radius(mass)
        until(lambda radius=radius: browser.nodes[ball]["radius"] == pytest.approx(radius))  # type: ignore[misc]
    until(lambda: browser.visible[ball])
    assert browser.poses[ball]["position"] == pytest.approx([0.01, -0.02, 0.11])
    assert payload_radius(8.0) == pytest.approx(2.0 * payload_radius(1.0))
    scene.configure(LANES, "first", Robot(), LOOP)
    until(lambda: not browser.visible[ball])
    until(lambda: browser.nodes[ball]["radius"] < 1e-3)


def test_the_scene_says_that_it_exaggerates(scene: Scene, browser: ViserClient) -> None:
    assert not browser.visible["/label"]
    scene.view(25.0, ghosts=True)
    until(lambda: browser.visible["/label"])
    assert "25" in browser.nodes["/label"]["text"]
    scene.view(1.0, ghosts=True)
    until(lambda: not browser.visible["/label"])


def test_the_desired_path_is_drawn_and_marked(scene: Scene, browser: ViserClient) -> None:
    until(lambda: browser.visible["/desired/path"])
    ends = browser.nodes["/desired/path"]["points"].reshape(-1, 2, 3)
    assert ends[0, 0] == pytest.approx(LOOP[0], abs=1e-6)
    now = frame(4)
    marked = flange_positions(now.q_d[None], shipped_places())[0]
    until(
        lambda: np.allclose(browser.poses["/desired/now"]["position"], marked, atol=1e-4),
        lambda: scene.update(now),
    )
    scene.configure(LANES, "first", Robot(), np.tile(LOOP[0], (5, 1)))
    until(lambda: not browser.visible["/desired/path"])


def test_a_pull_at_the_drawn_flange_is_felt(scene: Scene, browser: ViserClient) -> None:
    assert scene.pull() is None
    scene.update(frame())
    browser.drag("start", "/pull")
    flange = flange_positions(frame().q["first"][None], shipped_places())[0]
    browser.drag("update", "/pull", flange + np.array([0.0, 0.0, 0.1]))
    force = np.array([0.0, 0.0, 50.0])

    def felt() -> bool:
        scene.update(frame())
        now = scene.pull()
        return now is not None and np.allclose(now.force, force, atol=0.1)

    until(felt)
    browser.close()
    until(lambda: scene.pull() is None)
