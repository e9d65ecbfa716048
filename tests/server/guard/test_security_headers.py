"""What the security headers let a browser do, on pages, on the scene and on refusals."""

from __future__ import annotations

import asyncio

import httpx
import pytest
from starlette.responses import PlainTextResponse
from starlette.types import Receive, Scope, Send

from slidetune.server.guard.access import Access
from slidetune.server.guard.access_policy import AccessPolicy

OWN = "default-src 'none'"
CONNECT = "connect-src 'self' ws://localhost:8000 wss://localhost:8000"


async def application(scope: Scope, receive: Receive, send: Send) -> None:
    headers = {"content-security-policy": OWN} if scope["path"] == "/own" else {}
    await PlainTextResponse("here", headers=headers)(scope, receive, send)


def headers_of(path: str, host: str = "localhost:8000", bound: str = "127.0.0.1") -> httpx.Headers:
    async def run() -> httpx.Headers:
        transport = httpx.ASGITransport(Access(application, AccessPolicy(bound, 8000)))
        async with httpx.AsyncClient(transport=transport) as client:
            return (await client.get(f"http://x{path}", headers={"host": host})).headers

    return asyncio.run(run())


@pytest.mark.parametrize("path", ["/", "/api/thing", "/scene", "/scene/", "/own"])
@pytest.mark.parametrize("host", ["localhost:8000", "refused.example"])
def test_every_answer_carries_the_security_headers(path: str, host: str) -> None:
    headers = headers_of(path, host)
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert "content-security-policy" in headers


@pytest.mark.parametrize("path", ["/", "/docs", "/scenes", "/api/scene/"])
def test_pages_may_load_from_and_connect_to_the_server_alone(path: str) -> None:
    directives = headers_of(path)["content-security-policy"].split("; ")
    assert {"default-src 'self'", "frame-ancestors 'self'", CONNECT} <= set(directives)
    assert "unsafe-eval" not in str(directives)
    assert not any("unsafe-inline" in d for d in directives if not d.startswith("style-src"))


@pytest.mark.parametrize("path", ["/scene", "/scene/", "/scene/assets/x.js"])
def test_the_scene_may_run_its_inline_script_but_connect_nowhere_else(path: str) -> None:
    policy = headers_of(path)["content-security-policy"]
    assert {f"{CONNECT} data: blob:", "frame-ancestors 'self'"} <= set(policy.split("; "))
    assert "script-src" not in policy
    assert "default-src" not in policy


def test_a_page_can_bring_its_own_content_policy() -> None:
    assert headers_of("/own").get_list("content-security-policy") == [OWN]


@pytest.mark.parametrize("host", ["[::1]:8000", "lab;script-src *", "lab *", "x, y"])
def test_a_host_that_a_content_policy_cannot_spell_stays_out_of_it(host: str) -> None:
    directives = headers_of("/", host, bound="0.0.0.0")["content-security-policy"].split("; ")
    assert "connect-src 'self'" in directives
    assert not any(d.startswith("script-src") for d in directives)
