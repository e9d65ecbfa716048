"""Viser as the scene starts it: on loopback, silent, private, and gone when it is closed."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator

import pytest

from slidetune.server.scene.scene import Scene
from tests.server.scene.viser_client import ViserClient, until


@pytest.fixture
def scene() -> Iterator[Scene]:
    scene = Scene()
    yield scene
    scene.close()


@pytest.fixture
def browser(scene: Scene) -> Iterator[ViserClient]:
    with ViserClient(scene.port) as browser:
        yield browser


def test_the_scene_listens_on_loopback_alone(scene: Scene) -> None:
    with socket.create_connection(("127.0.0.1", scene.port), timeout=20.0) as visitor:
        visitor.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
        # Until it has hung up: a server that ends while a visitor comes in leaves a socket behind.
        while visitor.recv(65536):
            pass
    with pytest.raises(OSError, match=r".+"):
        # Another address of this machine, which a server on all of them would answer at.
        socket.create_connection(("127.0.0.2", scene.port), timeout=5.0)


def test_a_taken_port_leads_to_another(scene: Scene) -> None:
    other = Scene(scene.port)
    try:
        assert other.port != scene.port
    finally:
        other.close()


def test_the_scene_says_nothing(capfd: pytest.CaptureFixture[str]) -> None:
    scene = Scene()
    with ViserClient(scene.port):
        scene.close()
    assert capfd.readouterr() == ("", "")


def test_closing_leaves_no_thread() -> None:
    before = set(threading.enumerate())
    scene = Scene()
    with ViserClient(scene.port) as browser:
        browser.drag("start", "/pull")
        until(lambda: scene.pull() is not None)
        scene.close()
    until(lambda: set(threading.enumerate()) <= before)


def test_the_scene_cannot_be_published(scene: Scene, browser: ViserClient) -> None:
    assert not browser.others["ThemeConfigurationMessage"]["show_share_button"]
    browser.send("ShareUrlRequest")
    browser.drag("start", "/pull")
    until(lambda: scene.pull() is not None)  # so that Viser has heard the request too
    assert scene._viewer.request_share_url() is None
    assert scene._viewer._share_tunnel is None
