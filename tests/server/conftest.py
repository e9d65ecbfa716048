"""A real server on loopback, in this process, so that tests can look inside."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest
import uvicorn

from slidetune.robot.experiment.document import Experiment
from slidetune.server.app import create_app
from slidetune.server.guard.access_policy import AccessPolicy, policy_for
from slidetune.server.serve import free_socket, server_config
from slidetune.server.state.app_state import AppState

LANES = {
    "RBFNN-NFTSM": {"law": "rbfnn_nftsm"},
    "RBFNN-SMC": {"law": "rbfnn_smc"},
    "NFTSM": {"law": "nftsm"},
}


@dataclass
class Served:
    """A running server."""

    url: str
    live: str
    app_state: AppState
    http: httpx.Client
    policy: AccessPolicy


@contextmanager
def serving(presets: Path, token: bool = False) -> Iterator[Served]:
    """Start a server with a folder of own presets; ``http`` speaks as its owner."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SLIDETUNE_PRESETS", str(presets))
        patch.setenv("SLIDETUNE_STUDIES", str(presets / "studies"))
        patch.setenv("SLIDETUNE_ARMS", str(presets / "arms"))
        app_state = AppState(Experiment.from_document({"title": "Three lanes", "lanes": LANES}))
        bound = free_socket("127.0.0.1", 0)
        port = bound.getsockname()[1]
        policy = policy_for("127.0.0.1", port, token)
        server = uvicorn.Server(server_config(create_app(app_state, policy)))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [bound]}, daemon=True)
        thread.start()
        end = time.monotonic() + 60.0
        while not server.started:
            assert time.monotonic() < end, "the server did not start"
            time.sleep(0.01)
        url = f"http://127.0.0.1:{port}"
        owner = {"authorization": f"Bearer {policy.token}"} if token else {}
        with httpx.Client(base_url=url, headers=owner, timeout=60.0, trust_env=False) as http:
            yield Served(url, f"ws://127.0.0.1:{port}/api/live", app_state, http, policy)
        server.should_exit = True
        thread.join(30.0)
        assert not thread.is_alive()


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """Start one server for all tests, with an empty folder of own presets."""
    with serving(tmp_path_factory.mktemp("presets")) as server:
        yield server


@pytest.fixture
def served(server: Served) -> Served:
    """Return the server as if it had just been started with the paper's three lanes."""
    experiment = Experiment.from_document({"title": "Three lanes", "lanes": LANES})
    session = server.app_state.session
    server.app_state.document.replace(experiment)
    session.set_speed(1.0)
    session.play()
    done = threading.Event()
    session.ask(done.set)
    assert done.wait(300.0)  # the first step of a session compiles its kernels
    return server
