"""The relay in front of a real Viser, and of plain WebSocket servers where Viser can't be led."""

from __future__ import annotations

import asyncio
import socket
import threading
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager

import httpx
import msgspec
import pytest
import uvicorn
import viser
import zstandard
from fastapi import FastAPI
from websockets.asyncio.client import ClientConnection, connect
from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.exceptions import ConnectionClosed

from slidetune.server.scene.relay import scene_router

DEADLINE = 20.0  # s, only reached by a test that fails
PROTOCOL = f"viser-v{viser.__version__}"


def quiet(app: FastAPI) -> uvicorn.Config:
    # A connection that outlives its test makes the test fail, not wait.
    return uvicorn.Config(app, log_level="warning", lifespan="off", timeout_graceful_shutdown=2)


@contextmanager
def relay_of(port: int) -> Iterator[str]:
    """Serve an application with nothing but the relay; yield its host:port."""
    app = FastAPI()
    app.include_router(scene_router(port))
    with socket.create_server(("127.0.0.1", 0)) as listener:
        server = uvicorn.Server(quiet(app))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        try:
            yield f"127.0.0.1:{listener.getsockname()[1]}"
        finally:
            server.should_exit = True
            thread.join()


@asynccontextmanager
async def relayed(
    handler: Callable[[ServerConnection], Awaitable[None]],
) -> AsyncIterator[tuple[Server, str]]:
    """Serve `handler` and a relay of it in this very event loop; yield both ends."""
    app = FastAPI()
    with socket.create_server(("127.0.0.1", 0)) as listener:
        async with serve(handler, "127.0.0.1", 0, compression=None, max_size=None) as upstream:
            app.include_router(scene_router(next(iter(upstream.sockets)).getsockname()[1]))
            server = uvicorn.Server(quiet(app))
            serving = asyncio.create_task(server.serve(sockets=[listener]))
            try:
                await until(lambda: server.started)
                yield upstream, f"ws://127.0.0.1:{listener.getsockname()[1]}/scene"
            finally:
                server.should_exit = True
                await serving


def unused_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return int(listener.getsockname()[1])


async def until(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + DEADLINE
    while not condition():
        assert time.monotonic() < end, "waited too long"
        await asyncio.sleep(0.01)


def browser(address: str, **options: object) -> connect:
    settings: dict[str, object] = {"proxy": None, "max_size": None, "compression": None}
    return connect(address, **(settings | options))  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def scene() -> Iterator[viser.ViserServer]:
    server = viser.ViserServer(host="127.0.0.1", port=unused_port(), verbose=False)
    server.scene.add_frame("/relayed_frame")
    yield server
    server.stop()


@pytest.fixture(scope="module")
def relay(scene: viser.ViserServer) -> Iterator[str]:
    with relay_of(scene.get_port()) as address:
        yield address


async def names_until(socket: ClientConnection, wanted: str) -> set[str]:
    names: set[str] = set()
    async with asyncio.timeout(DEADLINE):
        while wanted not in names:
            data = await socket.recv()
            assert isinstance(data, bytes)
            size = int.from_bytes(data[8:16], "little")
            window = msgspec.msgpack.decode(zstandard.decompress(data[16 : 16 + size]))
            names |= {m["name"] for m in window["messages"] if "name" in m}
    return names


@pytest.mark.parametrize("path", ["/scene", "/scene/"])
def test_viser_speaks_to_a_client_of_the_relay(relay: str, path: str) -> None:
    async def run() -> None:
        async with browser(f"ws://{relay}{path}", subprotocols=[PROTOCOL]) as socket:
            assert socket.subprotocol == PROTOCOL
            await names_until(socket, "/relayed_frame")

    asyncio.run(run())


def test_a_client_of_another_viser_version_learns_why_it_is_refused(relay: str) -> None:
    async def run() -> None:
        async with browser(f"ws://{relay}/scene", subprotocols=["viser-v0.0.0"]) as socket:
            with pytest.raises(ConnectionClosed) as closed:
                await socket.recv()
            assert closed.value.rcvd is not None
            assert closed.value.rcvd.code == 1002
            assert "Version mismatch" in closed.value.rcvd.reason

    asyncio.run(run())


def fetch(url: str, encoding: str) -> tuple[int, bytes, dict[str, str]]:
    headers = {"accept-encoding": encoding}
    with httpx.stream("GET", url, headers=headers, trust_env=False) as response:
        kept = ("content-type", "content-length", "content-encoding")
        body = b"".join(response.iter_raw())
        return response.status_code, body, {n: response.headers.get(n, "") for n in kept}


@pytest.mark.parametrize("encoding", ["gzip", "identity"])
@pytest.mark.parametrize("path", ["/", "/index.html", "/?dark", "/missing.js", "/a/../b", "//x.y/"])
def test_http_is_the_same_through_the_relay_as_without_it(
    scene: viser.ViserServer, relay: str, path: str, encoding: str
) -> None:
    direct = fetch(f"http://127.0.0.1:{scene.get_port()}{path}", encoding)
    assert fetch(f"http://{relay}/scene{path}", encoding) == direct


def test_head_tells_the_length_and_sends_no_body(relay: str) -> None:
    plain = {"accept-encoding": "identity"}
    head = httpx.head(f"http://{relay}/scene/", headers=plain, trust_env=False)
    page = httpx.get(f"http://{relay}/scene/", headers=plain, trust_env=False)
    assert head.status_code == 200
    assert head.content == b""
    assert int(head.headers["content-length"]) == len(page.content) > 0


def test_scene_without_a_slash_leads_to_the_page_and_keeps_the_query(relay: str) -> None:
    answer = httpx.get(f"http://{relay}/scene?a=1&b=x%20y", trust_env=False)
    assert answer.is_redirect
    followed = httpx.get(
        f"http://{relay}/scene?a=1&b=x%20y", trust_env=False, follow_redirects=True
    )
    assert str(followed.url) == f"http://{relay}/scene/?a=1&b=x%20y"
    assert "Viser" in followed.text


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS"])
def test_only_reading_is_relayed(relay: str, method: str) -> None:
    assert httpx.request(method, f"http://{relay}/scene/", trust_env=False).status_code == 405


def raw_answer(port: int, request: bytes) -> bytes:
    with socket.create_connection(("127.0.0.1", port)) as connection:
        connection.sendall(request)
        return b"".join(iter(lambda: connection.recv(65536), b""))


@pytest.mark.parametrize(
    "path",
    [
        "/scene/../../etc/passwd",
        "/scene/%2e%2e/%2e%2e/etc/passwd",
        "/scene/..%2f..%2f..%2fetc%2fpasswd",
        "/scene/..\\..\\etc\\passwd",
        "/scene//example.com/",
        "/scene/@example.com:80/",
        "/scene/%00",
        "/scene/%0d%0aHost:%20example.com",
        "/scene/missing?%ff&#x|\xff",
        "/scene/%ff%fe",
        "/scene/" + 40_000 * "%61",
        "/scene/" + 70_000 * "a",
    ],
)
def test_no_path_leads_out_of_the_scene(relay: str, path: str) -> None:
    port = int(relay.rpartition(":")[2])
    request = f"GET {path} HTTP/1.1\r\nHost: {relay}\r\nConnection: close\r\n\r\n".encode()
    status = raw_answer(port, request).split(b" ", 2)[1]
    assert status in (b"400", b"404", b"414")


def test_the_token_is_not_shown_to_viser() -> None:
    seen: list[bytes] = []

    async def upstream(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        seen.append(await reader.readuntil(b"\r\n\r\n"))
        writer.write(b'HTTP/1.1 304 Not Modified\r\nETag: "x"\r\nConnection: close\r\n\r\n')
        await writer.drain()
        writer.close()

    async def run() -> httpx.Response:
        async with await asyncio.start_server(upstream, "127.0.0.1", 0) as server:
            app = FastAPI()
            app.include_router(scene_router(server.sockets[0].getsockname()[1]))
            transport = httpx.ASGITransport(app)
            async with httpx.AsyncClient(transport=transport, base_url="http://t") as client:
                secret = {"cookie": "token=secret", "authorization": "Bearer secret"}
                return await client.get("/scene/a?b=c", headers={"if-none-match": '"x"'} | secret)

    answer = asyncio.run(run())
    assert b"secret" not in seen[0]
    assert seen[0].startswith(b"GET /a?b=c HTTP/1.1\r\n")
    assert b'if-none-match: "x"' in seen[0].lower()
    assert answer.status_code == 304
    assert answer.headers["etag"] == '"x"'
    assert "connection" not in answer.headers


def test_http_says_so_when_viser_is_down() -> None:
    with relay_of(unused_port()) as address:
        answer = httpx.get(f"http://{address}/scene/", trust_env=False)
    assert answer.status_code == 502
    error = answer.json()["error"]
    assert (error["code"], error["fields"]) == ("scene_unavailable", [])
    assert "restart" in error["message"]


@pytest.mark.parametrize("protocols", [[PROTOCOL], None])
def test_websockets_say_so_when_viser_is_down(protocols: list[str] | None) -> None:
    async def run(address: str) -> None:
        async with browser(f"ws://{address}/scene", subprotocols=protocols) as socket:
            assert socket.subprotocol == (protocols[0] if protocols else None)
            with pytest.raises(ConnectionClosed) as closed:
                await socket.recv()
            assert closed.value.rcvd is not None
            assert closed.value.rcvd.code == 1013

    with relay_of(unused_port()) as address:
        asyncio.run(run(address))


async def echo(connection: ServerConnection) -> None:
    async for message in connection:
        await connection.send(message)


def test_binary_and_text_pass_unchanged_both_ways() -> None:
    messages = [b"", b"\x00\xff" * 50, "", "héllo", b"x" * 5_000_000, "y" * 200_000]

    async def run() -> None:
        async with relayed(echo) as (_, address), browser(address) as socket:
            for message in messages:
                await socket.send(message)
                assert await socket.recv() == message

    asyncio.run(run())


def test_the_close_of_the_scene_reaches_the_browser() -> None:
    async def leave(connection: ServerConnection) -> None:
        await connection.close(4001, "enough")

    async def run() -> None:
        async with relayed(leave) as (_, address), browser(address) as socket:
            await socket.wait_closed()
            assert (socket.close_code, socket.close_reason) == (4001, "enough")

    asyncio.run(run())


def test_a_scene_that_breaks_off_asks_the_browser_to_try_again() -> None:
    async def drop(connection: ServerConnection) -> None:
        connection.transport.abort()

    async def run() -> None:
        async with relayed(drop) as (_, address), browser(address) as socket:
            await socket.wait_closed()
            assert socket.close_code == 1013

    asyncio.run(run())


def test_the_close_of_the_browser_reaches_the_scene() -> None:
    closes: list[tuple[int | None, str | None]] = []

    async def listen(connection: ServerConnection) -> None:
        await connection.wait_closed()
        closes.append((connection.close_code, connection.close_reason))

    async def run() -> None:
        async with relayed(listen) as (_, address):
            async with browser(address) as socket:
                await socket.close(4002, "bye")
            await until(lambda: len(closes) == 1)
            async with browser(address) as socket:
                socket.transport.abort()
            await until(lambda: len(closes) == 2)

    asyncio.run(run())
    assert closes == [(4002, "bye"), (1001, "The browser has left.")]


@pytest.mark.parametrize("ending", ["close", "abort", "upstream", "mid-stream"])
def test_nothing_is_left_after_a_client_has_gone(ending: str) -> None:
    async def stream(connection: ServerConnection) -> None:
        while ending == "mid-stream":
            await connection.send(b"z" * 1000)
        await connection.wait_closed()

    async def run() -> None:
        async with relayed(stream) as (upstream, address):
            before = len(asyncio.all_tasks())
            sockets = [await browser(address) for _ in range(5)]
            await until(lambda: len(upstream.connections) == 5)
            if ending == "upstream":
                for connection in upstream.connections:
                    await connection.close()
            for socket in sockets:
                if ending in ("abort", "mid-stream"):
                    socket.transport.abort()
                await socket.close()
            await until(lambda: not upstream.connections and len(asyncio.all_tasks()) == before)

    asyncio.run(run())


def test_a_slow_browser_holds_the_scene_back_and_loses_nothing() -> None:
    count, size = 2000, 64 * 1024  # 128 MB: more than every buffer on the way
    sent = 0

    async def flood(connection: ServerConnection) -> None:
        nonlocal sent
        for index in range(count):
            await connection.send(index.to_bytes(4, "little") * (size // 4))
            sent += 1

    async def settled() -> int:
        last, since = -1, time.monotonic()
        while time.monotonic() - since < 0.5:
            if sent != last:
                last, since = sent, time.monotonic()
            await asyncio.sleep(0.02)
        return last

    async def run() -> None:
        async with relayed(flood) as (_, address), browser(address, max_queue=1) as socket:
            assert await settled() < count // 2
            for index in range(count):
                data = await socket.recv()
                assert int.from_bytes(data[:4], "little") == index

    asyncio.run(run())
