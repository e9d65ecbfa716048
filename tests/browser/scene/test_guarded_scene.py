"""Viser's page behind the relay and the access rules, in a real Chromium."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import pytest
import uvicorn
import viser
from fastapi import FastAPI
from fastapi.responses import HTMLResponse
from playwright.sync_api import ConsoleMessage, Page
from starlette.types import ASGIApp

from slidetune.server.guard.access import Access
from slidetune.server.guard.access_policy import AccessPolicy, policy_for
from slidetune.server.scene.relay import scene_router
from tests.browser.kept_chromium import KeptChromium


def quiet(app: ASGIApp) -> uvicorn.Config:
    # A connection that outlives its test makes the test fail, not wait.
    return uvicorn.Config(app, log_level="warning", lifespan="off", timeout_graceful_shutdown=2)


@contextmanager
def serving(app: ASGIApp, listener: socket.socket) -> Iterator[None]:
    server = uvicorn.Server(quiet(app))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
    thread.start()
    try:
        yield
    finally:
        server.should_exit = True
        thread.join()


@contextmanager
def guarded_scene(bound: str, scene: viser.ViserServer) -> Iterator[AccessPolicy]:
    app = FastAPI()
    app.include_router(scene_router(scene.get_port()))
    with socket.create_server(("127.0.0.1", 0)) as listener:
        policy = policy_for(bound, listener.getsockname()[1])
        with serving(Access(app, policy), listener):
            yield policy


@pytest.fixture(scope="module")
def scene() -> Iterator[viser.ViserServer]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    server.scene.add_box("/box", dimensions=(1, 1, 1))
    yield server
    server.stop()


@pytest.fixture
def tab(kept_chromium: KeptChromium) -> Iterator[Page]:
    with kept_chromium.webgl().new_context() as context:
        yield context.new_page()


def is_connected(message: ConsoleMessage) -> bool:
    return message.text.startswith("Connected!")


def path_of(tab: Page) -> str:
    # Once connected, Viser notes its WebSocket's address in the query by itself.
    return tab.url.partition("?")[0]


def test_the_scene_is_shown_without_a_complaint(scene: viser.ViserServer, tab: Page) -> None:
    complaints: list[str] = []
    tab.on("pageerror", lambda error: complaints.append(str(error)))
    tab.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
    with guarded_scene("127.0.0.1", scene) as policy:
        with tab.expect_console_message(is_connected):
            tab.goto(f"{policy.address()}scene")
        tab.wait_for_selector("canvas")
        assert path_of(tab) == f"{policy.address()}scene/"
        assert complaints == []
        tab.close()


def test_a_link_on_another_site_leads_into_the_scene(scene: viser.ViserServer, tab: Page) -> None:
    elsewhere = FastAPI()
    with (
        guarded_scene("0.0.0.0", scene) as policy,
        socket.create_server(("127.0.0.1", 0)) as listener,
        serving(elsewhere, listener),
    ):
        target = f"http://127.0.0.1:{policy.port}/scene/"
        assert httpx.get(target, trust_env=False).status_code == 401

        @elsewhere.get("/", response_class=HTMLResponse)
        def link() -> str:
            return f'<a href="{target}?token={policy.token}">scene</a>'

        # Another name for the same machine is another site to a browser.
        tab.goto(f"http://localhost:{listener.getsockname()[1]}/")
        with tab.expect_console_message(is_connected):
            tab.click("a")
        assert path_of(tab) == target
        assert "token" not in tab.url
        tab.close()


def test_a_link_cannot_put_a_foreign_scene_into_our_origin(
    scene: viser.ViserServer, tab: Page
) -> None:
    with (
        guarded_scene("127.0.0.1", scene) as policy,
        socket.create_server(("127.0.0.1", 0)) as foreign,
    ):
        address = f"ws://127.0.0.1:{foreign.getsockname()[1]}"
        with tab.expect_console_message(lambda m: m.text.startswith(f"Connecting to: {address}")):
            tab.goto(f"{policy.address()}scene/?websocket={address}")
        with tab.expect_console_message(is_connected):
            tab.goto(f"{policy.address()}scene/")
        foreign.setblocking(False)
        with pytest.raises(BlockingIOError):
            foreign.accept()
        tab.close()
