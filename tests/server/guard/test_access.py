"""Access rules, asked of a real server by HTTP and WebSocket clients."""

from __future__ import annotations

import asyncio
import logging
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import httpx
import pytest
import uvicorn
from fastapi import FastAPI, WebSocket
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from slidetune.server.guard.access import Access
from slidetune.server.guard.access_policy import AccessPolicy, policy_for

HTML = {"accept": "text/html,*/*"}


def application() -> FastAPI:
    """Return a page, an API, a scene and a WebSocket that tell what query reached them."""
    app = FastAPI(openapi_url=None)

    @app.get("/")
    @app.get("/api/thing")
    @app.post("/api/thing")
    @app.get("/scene/{path:path}")
    @app.get("/a b/ü")
    def thing(x: str = "", token: str = "") -> dict[str, str]:
        return {"x": x, "token": token}

    @app.websocket("/live")
    async def live(websocket: WebSocket) -> None:
        await websocket.accept()
        await websocket.send_text(websocket.url.query)
        await websocket.close()

    return app


@dataclass(frozen=True)
class Guarded:
    """A running server and its policy; it listens on 127.0.0.1 whatever the policy says."""

    policy: AccessPolicy

    @property
    def here(self) -> str:
        return f"127.0.0.1:{self.policy.port}"

    @property
    def token(self) -> str:
        assert self.policy.token is not None
        return self.policy.token

    def ask(self, method: str, path: str, **headers: str) -> httpx.Response:
        sent = {name.replace("_", "-"): value for name, value in headers.items()}
        url = f"http://{self.here}{path}"
        return httpx.request(method, url, headers=sent, trust_env=False)

    def listen(self, path: str, host: str = "", origin: str | None = None, **headers: str) -> str:
        sent = {name.replace("_", "-"): value for name, value in headers.items()}
        url = f"ws://{host or self.here}{path}"
        connection = socket.create_connection(("127.0.0.1", self.policy.port))
        with connect(url, sock=connection, origin=origin, additional_headers=sent) as client:
            return str(client.recv())


@contextmanager
def guarded(host: str) -> Iterator[Guarded]:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        policy = policy_for(host, listener.getsockname()[1])
        config = uvicorn.Config(
            Access(application(), policy), log_config=None, timeout_graceful_shutdown=2
        )
        server = uvicorn.Server(config)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        try:
            yield Guarded(policy)
        finally:
            server.should_exit = True
            thread.join()


@pytest.fixture(scope="module")
def local() -> Iterator[Guarded]:
    with guarded("127.0.0.1") as server:
        yield server


@pytest.fixture(scope="module")
def remote() -> Iterator[Guarded]:
    with guarded("0.0.0.0") as server:
        yield server


@pytest.mark.parametrize("host", ["localhost", "LOCALHOST", "127.0.0.1", "127.8.8.8", "::1"])
def test_a_loopback_binding_needs_no_token(host: str) -> None:
    assert policy_for(host, 8000).token is None


@pytest.mark.parametrize(
    "host", ["", "0.0.0.0", "::", "192.168.1.5", "lab-pc", "localhost.example.com", "127.0.0.1.a"]
)
def test_every_other_binding_gets_a_token_of_its_own(host: str) -> None:
    tokens = {policy_for(host, 8000).token for _ in range(3)}
    assert len(tokens) == 3
    assert all(token is not None and len(token) >= 43 for token in tokens)


def test_only_the_printed_address_shows_the_token() -> None:
    policy = AccessPolicy("192.168.1.5", 8000, "s3cr3t+/")
    assert policy.address() == "http://192.168.1.5:8000/?token=s3cr3t%2B%2F"
    assert "s3cr3t" not in f"{policy!r} {policy}"
    assert AccessPolicy("::1", 8000).address() == "http://[::1]:8000/"
    assert "0.0.0.0" not in AccessPolicy("0.0.0.0", 8000).address()


@pytest.mark.parametrize(
    ("bound", "port", "scheme", "host", "allowed"),
    [
        ("127.0.0.1", 8000, "http", "localhost:8000", True),
        ("127.0.0.1", 8000, "http", "LocalHost:8000", True),
        ("127.0.0.1", 8000, "ws", "127.0.0.1:8000", True),
        ("127.0.0.1", 8000, "http", "[::1]:8000", True),
        ("127.0.0.2", 8000, "http", "127.0.0.2:8000", True),
        ("127.0.0.1", 8000, "http", "127.0.0.2:8000", False),
        ("127.0.0.1", 8000, "http", "localhost:8001", False),
        ("127.0.0.1", 8000, "http", "localhost", False),
        ("127.0.0.1", 80, "http", "localhost", True),
        ("127.0.0.1", 80, "https", "localhost", False),
        ("127.0.0.1", 443, "wss", "localhost", True),
        ("127.0.0.1", 8000, "http", "example.com:8000", False),
        ("127.0.0.1", 8000, "http", "localhost.example.com:8000", False),
        ("127.0.0.1", 8000, "http", "localhost:8000@example.com", False),
        ("127.0.0.1", 8000, "http", "user@localhost:8000", False),
        ("127.0.0.1", 8000, "http", "localhost:8000\n", False),
        ("127.0.0.1", 8000, "http", "", False),
        ("::1", 8000, "http", "[::1]:8000", True),
        ("0.0.0.0", 8000, "http", "lab-pc:9000", True),
        ("192.168.1.5", 8000, "http", "[fe80::1]:8000", True),
        ("0.0.0.0", 8000, "http", "lab pc", False),
        ("0.0.0.0", 8000, "http", "lab;script-src *", False),
        ("0.0.0.0", 8000, "http", "", False),
    ],
)
def test_which_host_headers_name_the_server(
    bound: str, port: int, scheme: str, host: str, allowed: bool
) -> None:
    assert AccessPolicy(bound, port).allows_host(host, scheme) is allowed


def assert_refused(answer: httpx.Response, status: int, code: str) -> None:
    assert answer.status_code == status
    error = answer.json()["error"]
    assert (error["code"], error["fields"]) == (code, [])
    assert answer.headers["x-content-type-options"] == "nosniff"


@pytest.mark.parametrize("path", ["/", "/api/thing", "/scene/", "/missing"])
def test_a_rebound_name_is_refused_everywhere(local: Guarded, path: str) -> None:
    host = f"rebound.example:{local.policy.port}"
    assert_refused(local.ask("GET", path, host=host), 403, "host_refused")


def test_a_rebound_name_gets_no_websocket(local: Guarded) -> None:
    with pytest.raises(InvalidStatus) as refused:
        local.listen("/live", host=f"rebound.example:{local.policy.port}")
    assert refused.value.response.status_code == 403


@pytest.mark.parametrize("hosts", [[], ["localhost:{port}", "rebound.example"]])
def test_exactly_one_host_must_be_named(local: Guarded, hosts: list[str]) -> None:
    lines = "".join(f"Host: {host.format(port=local.policy.port)}\r\n" for host in hosts)
    with socket.create_connection(("127.0.0.1", local.policy.port)) as connection:
        connection.sendall(f"GET / HTTP/1.1\r\n{lines}Connection: close\r\n\r\n".encode())
        answer = b"".join(iter(lambda: connection.recv(65536), b""))
    assert answer.split(b" ", 2)[1] in (b"400", b"403")


ORIGINS = [
    ("http://{here}", True),
    ("HTTP://{here}", False),
    ("https://{here}", True),
    ("http://127.0.0.1", False),
    ("http://127.0.0.1:1", False),
    ("http://localhost:{port}", False),
    ("http://example.com", False),
    ("http://{here}.example.com", False),
    ("http://{here}@example.com", False),
    ("file://", False),
    ("null", False),
    ("", False),
]


@pytest.mark.parametrize("method", ["POST", "GET"])
@pytest.mark.parametrize(("origin", "allowed"), ORIGINS)
def test_only_pages_of_the_server_itself_may_ask(
    local: Guarded, origin: str, allowed: bool, method: str
) -> None:
    named = origin.format(here=local.here, port=local.policy.port)
    answer = local.ask(method, "/api/thing", origin=named)
    if allowed:
        assert answer.status_code == 200
    else:
        assert_refused(answer, 403, "origin_refused")


@pytest.mark.parametrize(("origin", "allowed"), ORIGINS)
def test_only_pages_of_the_server_itself_get_a_websocket(
    local: Guarded, origin: str, allowed: bool
) -> None:
    named = origin.format(here=local.here, port=local.policy.port)
    if allowed:
        assert local.listen("/live?x=1", origin=named) == "x=1"
    else:
        with pytest.raises(InvalidStatus) as refused:
            local.listen("/live", Origin=named)
        assert refused.value.response.status_code == 403


def test_an_origin_may_leave_out_the_port_that_its_scheme_implies(remote: Guarded) -> None:
    sent = {"host": "lab.example", "authorization": f"Bearer {remote.token}"}
    for origin in ("http://lab.example", "https://lab.example", "https://lab.example:443"):
        assert remote.ask("POST", "/api/thing", origin=origin, **sent).status_code == 200
    wrong = remote.ask("POST", "/api/thing", origin="https://lab.example:80", **sent)
    assert_refused(wrong, 403, "origin_refused")


def test_scripts_without_an_origin_are_welcome(local: Guarded) -> None:
    assert local.ask("POST", "/api/thing").status_code == 200
    assert local.listen("/live?x=1") == "x=1"


@pytest.mark.parametrize("path", ["/", "/api/thing", "/scene/", "/scene", "/missing", "/docs"])
def test_everything_asks_for_the_token(remote: Guarded, path: str) -> None:
    answer = remote.ask("GET", path)
    assert_refused(answer, 401, "token_required")
    assert answer.headers["www-authenticate"] == "Bearer"
    assert remote.ask("GET", path, authorization=f"Bearer {remote.token}").status_code != 401


def credentials(remote: Guarded, secret: str) -> dict[str, tuple[str, dict[str, str]]]:
    return {
        "query": (f"?x=1&token={secret}&y", {}),
        "bearer": ("?x=1&y", {"authorization": f"bearer {secret}"}),
        "cookie": ("?x=1&y", {"cookie": f"a=b; {remote.policy.cookie}={secret}; c=d"}),
    }


@pytest.mark.parametrize("way", ["query", "bearer", "cookie"])
def test_the_token_opens_http_and_websockets(remote: Guarded, way: str) -> None:
    query, headers = credentials(remote, remote.token)[way]
    assert remote.ask("POST", f"/api/thing{query}", **headers).json() == {"x": "1", "token": ""}
    assert remote.listen(f"/live{query}", **headers) == "x=1&y"


@pytest.mark.parametrize("change", ["", "{}x", "x{}", "ÿ", "%00", '"{}"x'])
@pytest.mark.parametrize("way", ["query", "bearer", "cookie"])
def test_no_other_token_opens_anything(remote: Guarded, way: str, change: str) -> None:
    query, headers = credentials(remote, change.format(remote.token))[way]
    raw = {name: value.strip().encode() for name, value in headers.items()}
    answer = httpx.get(f"http://{remote.here}/api/thing{query}", headers=raw, trust_env=False)
    assert_refused(answer, 401, "token_required")
    if change.isascii():  # the WebSocket client can't send anything else
        with pytest.raises(InvalidStatus) as refused:
            remote.listen(f"/live{query}", **headers)
        assert refused.value.response.status_code == 403


def test_the_cookie_of_another_port_opens_nothing(remote: Guarded) -> None:
    cookie = f"{AccessPolicy('0.0.0.0', 1).cookie}={remote.token}"
    assert_refused(remote.ask("GET", "/", cookie=cookie), 401, "token_required")


def test_a_browser_trades_the_token_in_the_address_for_a_cookie(remote: Guarded) -> None:
    base = f"http://{remote.here}"
    with httpx.Client(headers=HTML, trust_env=False, base_url=base) as browser:
        first = browser.get(f"/?x=1&token={remote.token}&y=%2F")
        assert first.status_code == 303
        assert first.headers["location"] == "/?x=1&y=%2F"
        attributes = first.headers["set-cookie"].lower()
        assert "httponly" in attributes
        assert "samesite=strict" in attributes
        assert "path=/" in attributes
        assert first.headers["cache-control"] == "no-store"
        assert browser.get(first.headers["location"]).json() == {"x": "1", "token": ""}


def test_the_cookie_is_only_for_tls_where_there_is_tls() -> None:
    async def unreached(*_: object) -> None:
        raise AssertionError

    policy = policy_for("0.0.0.0", 443)
    transport = httpx.ASGITransport(Access(unreached, policy))

    async def run() -> httpx.Response:
        async with httpx.AsyncClient(transport=transport, base_url="https://lab") as client:
            return await client.get("/", params={"token": policy.token or ""}, headers=HTML)

    assert "secure" in asyncio.run(run()).headers["set-cookie"].lower()


@pytest.mark.parametrize("path", ["//example.com/", "/\\example.com/", "///example.com", "/%5Ca"])
def test_the_redirect_stays_on_the_server(remote: Guarded, path: str) -> None:
    request = (
        f"GET {path}?token={remote.token} HTTP/1.1\r\nHost: {remote.here}\r\n"
        "Accept: text/html\r\nConnection: close\r\n\r\n"
    )
    with socket.create_connection(("127.0.0.1", remote.policy.port)) as connection:
        connection.sendall(request.encode())
        answer = b"".join(iter(lambda: connection.recv(65536), b"")).decode()
    location = next(x for x in answer.splitlines() if x.lower().startswith("location:"))
    target = location.partition(":")[2].strip()
    assert target.startswith("/")
    assert not target.startswith(("//", "/\\"))


def test_the_redirect_keeps_a_path_with_spaces_and_umlauts(remote: Guarded) -> None:
    answer = remote.ask("GET", f"/a%20b/%C3%BC?token={remote.token}", **HTML)
    assert answer.headers["location"] == "/a%20b/%C3%BC"


def test_a_program_with_the_token_in_the_address_is_not_redirected(remote: Guarded) -> None:
    for headers in ({"accept": "*/*"}, HTML | {"sec_fetch_mode": "cors"}):
        answer = remote.ask("GET", f"/api/thing?token={remote.token}", **headers)
        assert answer.json() == {"x": "", "token": ""}
        assert "set-cookie" not in answer.headers


def test_a_navigation_begun_by_another_site_is_begun_anew_once(remote: Guarded) -> None:
    linked = HTML | {"sec_fetch_mode": "navigate", "sec_fetch_site": "cross-site"}
    answer = remote.ask("GET", "/?x=%22%3E", **linked)
    assert answer.status_code == 401
    assert 'content="0;url=/?x=%22%3E"' in answer.text
    anew = linked | {"sec_fetch_site": "same-origin"}
    assert "refresh" not in remote.ask("GET", "/?x=%22%3E", **anew).text


def test_a_refused_browser_reads_the_way_out(local: Guarded, remote: Guarded) -> None:
    answer = remote.ask("GET", "/", **HTML)
    assert answer.status_code == 401
    assert answer.headers["content-type"].startswith("text/html")
    assert "open the address that it printed" in answer.text
    assert "refresh" not in answer.text
    wrong = local.ask("GET", "/", host="<b>", **HTML)
    assert wrong.status_code == 403
    assert "<b>" not in wrong.text
    assert f"http://localhost:{local.policy.port}/" in wrong.text


def test_no_log_shows_a_token(remote: Guarded, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "uvicorn.access")
    caplog.set_level(logging.INFO, "uvicorn.error")
    for token in (remote.token, "wr0ng"):
        remote.ask("GET", f"/api/thing?x=1&token={token}")
        remote.ask("GET", f"/?token={token}", **HTML)
        remote.ask("GET", f"/?%74oken={token}")
    remote.listen(f"/live?token={remote.token}")
    with pytest.raises(InvalidStatus):
        remote.listen("/live?token=wr0ng")
    logged = [record.getMessage() for record in caplog.records if record.name.startswith("uvicorn")]
    assert any("/api/thing?x=1" in line for line in logged)
    assert any("/live" in line for line in logged)
    assert not any(remote.token in line or "wr0ng" in line for line in logged)
