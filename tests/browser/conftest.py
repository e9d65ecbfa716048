"""A dashboard in its own process, and a page in a real Chromium that tolerates no complaint.

One dashboard for all modules, put back to its beginning for each test; one Chromium and one page
for all tests of this folder that follow each other, emptied for each (Playwright's event loop may
not outlive them: other tests run their own). Its list of edits is what a dashboard doesn't forget:
a test that wants none starts one of its own with `start_dashboard`.
"""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import BrowserContext, ConsoleMessage, Page, Request, WebError, expect
from websockets.sync.client import connect

from tests.browser.kept_chromium import KeptChromium
from tests.browser.reused_context import ReusedContext

ROOT = Path(__file__).resolve().parents[2]
START_TIME = 240
"""Longest that a dashboard may take to start in seconds: the first one compiles every kernel."""
ADDRESS = re.compile(r"http://\S+")
SELECT = {"type": "select", "lane": "RBFNN-NFTSM"}
VIEW = {"type": "view", "exaggeration": 1, "ghosts": True}
"""What a new dashboard shows."""
LOGS = pytest.StashKey[list[Path]]()
FAILED = pytest.StashKey[bool]()
KEPT = pytest.StashKey[KeptChromium]()

PATIENCE = 60_000
"""Longest wait of a page for what must come, in ms: no test that passes takes it."""

expect.set_options(timeout=PATIENCE)


@dataclass(frozen=True)
class Dashboard:
    """A dashboard that answers.

    Attributes:
        url: the address that it printed; it ends in a slash.
        client: an HTTP client whose base is that address.
        process: the server.
        log: everything that the server printed.
    """

    url: str
    client: httpx.Client
    process: subprocess.Popen[bytes]
    log: Path


StartDashboard = Callable[..., Dashboard]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if item.path.is_relative_to(Path(__file__).parent):
            item.add_marker(pytest.mark.browser)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(
    item: pytest.Item, nextitem: pytest.Item | None
) -> Generator[None, None, None]:
    try:
        return (yield)
    finally:
        here = Path(__file__).parent
        if KEPT in item.config.stash and not (nextitem and nextitem.path.is_relative_to(here)):
            item.config.stash[KEPT].close()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    if report.failed:
        item.stash[FAILED] = True
        for log in item.stash.get(LOGS, []):
            report.sections.append((f"{log.stem} log", log.read_text(errors="replace")))
    return report


def printed_address(process: subprocess.Popen[bytes], log: Path) -> str:
    """Wait until a dashboard has printed its address, and return that."""
    deadline = time.monotonic() + START_TIME
    while time.monotonic() < deadline:
        found = ADDRESS.search(log.read_text(errors="replace"))
        if found:
            return found[0]
        if process.poll() is not None:
            pytest.fail(f"the dashboard ended with code {process.returncode} before it answered")
        time.sleep(0.05)
    pytest.fail(f"the dashboard printed no address within {START_TIME} s")


def end(process: subprocess.Popen[bytes]) -> None:
    """Ask a dashboard to end, then end whatever is left of it."""
    process.terminate()
    with suppress(subprocess.TimeoutExpired):
        process.wait(timeout=10)
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def stop(dashboard: Dashboard) -> str:
    """End a dashboard as its user would; return its port, at which another one may follow."""
    dashboard.process.send_signal(signal.SIGTERM)
    dashboard.process.wait(timeout=30)
    return str(httpx.URL(dashboard.url).port)


@contextmanager
def running(
    arguments: tuple[str, ...], log: Path, environment: Mapping[str, str] | None = None
) -> Iterator[Dashboard]:
    """Run a dashboard on a free port; ends it at the end, however it stands."""
    command = [
        sys.executable,
        "-m",
        "slidetune",
        "serve",
        "--no-browser",
        "--port",
        "0",
        *arguments,
    ]
    with log.open("wb") as output:
        process = subprocess.Popen(
            command,
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            env={**os.environ, "NO_COLOR": "1", "PYTHONUNBUFFERED": "1", **(environment or {})},
            # Its own process group, so that whatever it starts ends with it in any case.
            start_new_session=True,
        )
    try:
        url = printed_address(process, log)
        # A kept connection may be closed by the server in the moment in which it is used again.
        once = httpx.Limits(max_keepalive_connections=0)
        with httpx.Client(base_url=url, trust_env=False, timeout=60, limits=once) as client:
            yield Dashboard(url, client, process, log)
    finally:
        end(process)


@pytest.fixture
def start_dashboard(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[StartDashboard]:
    """Start a dashboard with these options of ``serve``; as many as a test needs."""
    logs = request.node.stash.setdefault(LOGS, [])
    with ExitStack() as stack:

        def start(*arguments: str) -> Dashboard:
            log = tmp_path / f"dashboard-{len(logs) + 1}.txt"
            log.touch()
            logs.append(log)
            return stack.enter_context(running(arguments, log))

        yield start


@pytest.fixture(scope="session")
def shared_dashboard(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Dashboard]:
    """A dashboard for all tests; `dashboard` puts it back to its beginning."""
    folder = tmp_path_factory.mktemp("dashboard")
    environment = {
        "SLIDETUNE_PRESETS": str(folder / "presets"),
        "SLIDETUNE_STUDIES": str(folder / "studies"),
        "SLIDETUNE_ARMS": str(folder / "arms"),
    }
    with running((), folder / "dashboard.txt", environment) as dashboard:
        yield dashboard


@pytest.fixture
def dashboard(shared_dashboard: Dashboard, request: pytest.FixtureRequest) -> Iterator[Dashboard]:
    """A dashboard as it begins: with the paper's experiment, which plays, no presets or studies."""
    request.node.stash.setdefault(LOGS, []).append(shared_dashboard.log)
    client = shared_dashboard.client
    for preset in client.get("/api/presets").json()["presets"]:
        if not preset["shipped"]:
            client.delete(f"/api/presets/{preset['name']}").raise_for_status()
    for study in client.get("/api/studies").json()["studies"]:
        client.delete(f"/api/studies/{study['id']}").raise_for_status()
    for log in client.get("/api/logs").json()["logs"]:
        client.delete(f"/api/logs/{log['number']}").raise_for_status()
    client.post("/api/presets/paper/load").raise_for_status()
    for arm in client.get("/api/arms").json()["arms"]:
        if not arm["shipped"]:
            client.delete(f"/api/arms/{arm['name']}").raise_for_status()
    client.patch("/api/session", json={"speed": 1.0}).raise_for_status()
    client.post("/api/session/play").raise_for_status()
    address = f"{shared_dashboard.url.replace('http', 'ws', 1)}api/live"
    with connect(address, proxy=None, max_size=None) as socket:
        for message in (SELECT, VIEW):
            socket.send(json.dumps(message))
    yield shared_dashboard
    # The tests between two of a browser needn't share the machine with it.
    client.post("/api/session/pause")


@pytest.fixture(scope="module")
def window() -> dict[str, Any]:
    """The size of the pages of a module, and whether they are touched."""
    return {"viewport": {"width": 1440, "height": 900}}


@pytest.fixture(scope="session")
def kept_chromium(pytestconfig: pytest.Config) -> Iterator[KeptChromium]:
    kept = pytestconfig.stash.setdefault(KEPT, KeptChromium())
    yield kept
    kept.close()


@pytest.fixture(scope="module")
def reused(kept_chromium: KeptChromium, window: dict[str, Any]) -> ReusedContext:
    return kept_chromium.reused(window)


class Complaints:
    """Errors in the console, uncaught errors and failed requests of every page of a context."""

    def __init__(self, context: BrowserContext) -> None:
        self._texts: list[str] = []
        self._allowed: list[str] = []
        self._context = context
        context.on("console", self._said)
        context.on("weberror", self._error)
        context.on("requestfailed", self._request_failed)

    def stop(self) -> None:
        """Listen no longer."""
        self._context.remove_listener("console", self._said)
        self._context.remove_listener("weberror", self._error)
        self._context.remove_listener("requestfailed", self._request_failed)

    def allow(self, pattern: str) -> None:
        """Tolerate what this regular expression is found in: the test provokes it."""
        self._allowed.append(pattern)

    def unexpected(self) -> list[str]:
        """Return every complaint that no pattern allows."""
        return [
            text for text in self._texts if not any(re.search(rule, text) for rule in self._allowed)
        ]

    def _said(self, message: ConsoleMessage) -> None:
        if message.type == "error":
            self._texts.append(message.text)

    def _error(self, error: WebError) -> None:
        self._texts.append(str(error.error))

    def _request_failed(self, request: Request) -> None:
        # Aborted: the page itself gave it up, as it does for a download or when it is left.
        if request.failure != "net::ERR_ABORTED":
            self._texts.append(f"{request.method} {request.url}: {request.failure}")


@pytest.fixture
def context(
    request: pytest.FixtureRequest, window: dict[str, Any], start_dashboard: StartDashboard
) -> Iterator[BrowserContext]:
    """An empty profile, left before the dashboards end that its pages talk to.

    Tests marked `scene` have one that draws WebGL, in software; others do without the 3D scene,
    which takes a whole core, and use one after another unless they are marked `fresh`.
    """
    marks = {mark.name for mark in request.node.iter_markers()}
    if "scene" in marks:
        kept: KeptChromium = request.getfixturevalue("kept_chromium")
        with kept.webgl().new_context(**window) as context:
            yield context
        return
    reused: ReusedContext = request.getfixturevalue("reused")
    if "fresh" in marks:
        reused.close()
    yield reused.open()
    if "fresh" in marks or request.node.stash.get(FAILED, False):
        reused.close()
    else:
        reused.clean()


@pytest.fixture
def complaints(context: BrowserContext) -> Iterator[Complaints]:
    """What the pages complain of; `allow` what the test provokes."""
    complaints = Complaints(context)
    yield complaints
    complaints.stop()


@pytest.fixture
def page(
    context: BrowserContext, complaints: Complaints, request: pytest.FixtureRequest
) -> Iterator[Page]:
    """An empty page: open ``dashboard.url`` in it. A complaint of any page fails the test."""
    page = context.pages[0] if context.pages else context.new_page()
    page.set_default_timeout(PATIENCE)
    yield page
    unexpected = complaints.unexpected()
    if unexpected or request.node.stash.get(FAILED, False):
        name = re.sub(r"[^\w.-]+", "-", request.node.nodeid.removeprefix("tests/"))
        page.screenshot(path=ROOT / "test-results" / f"{name}.png")
    assert unexpected == []
