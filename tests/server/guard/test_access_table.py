"""Tables of ways in that must stay shut, tried on the whole application through raw sockets."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from tests.server.conftest import Served, serving

SECRET = "nobody may read this"
HEADERS = (
    "content-security-policy",
    "cross-origin-resource-policy",
    "referrer-policy",
    "x-content-type-options",
)

# Every place where a name becomes part of an address: method and address.
NAMED = [
    ("GET", "/api/presets/{}"),
    ("PUT", "/api/presets/{}?overwrite=true"),
    ("DELETE", "/api/presets/{}"),
    ("POST", "/api/presets/{}/load"),
    ("GET", "/api/lessons/{}"),
    ("GET", "/static/{}"),
    ("GET", "/docs/{}"),
    ("GET", "/scene/{}"),
    ("POST", "/api/history/{}/restore"),
    ("POST", "/api/studies/{}"),
    ("GET", "/api/logs/{}/curves"),
    ("DELETE", "/api/logs/{}"),
    ("GET", "/api/studies/{}"),
    ("GET", "/api/studies/{}/download?format=yaml"),
    ("DELETE", "/api/studies/{}"),
]
# Ways to say "the folder above, and there the file secret".
CLIMBING = [
    "../secret.yaml",
    "../secret",
    "..%2fsecret.yaml",
    "..%2Fsecret",
    "%2e%2e/secret.yaml",
    "%2e%2e%2fsecret.yaml",
    "%2e%2e%2f%2e%2e%2fsecret",
    "%252e%252e%252fsecret",
    "..%5csecret.yaml",
    "..\\secret.yaml",
    "....//secret.yaml",
    "..;/secret.yaml",
    "%2e%2e%00%2fsecret.yaml",
    "secret%00.yaml",
    "%00",
    "paper%00",
    "%c0%ae%c0%ae%c0%afsecret.yaml",
    "%ff%fe",
    "{folder}/secret.yaml",
    "%2f{folder}/secret.yaml",
    "file:%2f%2f{folder}/secret.yaml",
    "..%2f..%2f..%2f..%2f..%2f..%2fetc%2fpasswd",
    "con",
    "nul.yaml",
    "a%0d%0aset-cookie:x=1",
    "%7e/secret",
    "x" * 5000,
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a file that a climb out of the presets would reach."""
    return tmp_path_factory.mktemp("outside")


@pytest.fixture(scope="module")
def here(folder: Path) -> Iterator[Served]:
    """A server on loopback, whose presets lie in a folder below the secret one."""
    presets = folder / "presets"
    presets.mkdir()
    with serving(presets) as server:
        text = experiment_to_yaml(server.app_state.document.experiment)
        for name in ("secret", "secret.yaml"):
            (folder / name).write_text(f"# {SECRET}\n{text}", encoding="utf-8")
        yield server


@pytest.fixture(autouse=True)
def presets_below(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SLIDETUNE_PRESETS", str(folder / "presets"))


def raw(server: Served, method: str, path: str, **headers: str) -> tuple[int, dict[str, str], str]:
    """Send a request as it is, with no client that would tidy the address."""
    sent = {"host": server.url[7:], "connection": "close", "content-length": "0", **headers}
    lines = "".join(f"{name.replace('_', '-')}: {value}\r\n" for name, value in sent.items())
    with socket.create_connection(("127.0.0.1", server.policy.port), timeout=30.0) as line:
        line.sendall(f"{method} {path} HTTP/1.1\r\n{lines}\r\n".encode())
        answer = b"".join(iter(lambda: line.recv(65536), b"")).decode("utf-8", "replace")
    head, _, body = answer.partition("\r\n\r\n")
    status, *fields = head.splitlines()
    pairs = (field.partition(":") for field in fields)
    return int(status.split()[1]), {name.lower(): value.strip() for name, _, value in pairs}, body


@pytest.mark.parametrize("climb", CLIMBING)
@pytest.mark.parametrize(("method", "place"), NAMED)
def test_no_name_leads_out_of_its_folder(
    here: Served, folder: Path, method: str, place: str, climb: str
) -> None:
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    revision = here.app_state.document.revision
    path = place.format(climb.replace("{folder}", str(folder)))
    status, headers, body = raw(here, method, path)
    assert status in (307, 400, 404, 405, 409, 422)
    assert SECRET not in body
    assert "root:" not in body
    assert "set-cookie" not in headers
    if status != 400 and status != 307 and not path.startswith("/scene/"):
        assert set(json.loads(body)) == {"error"}
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before
    assert here.app_state.document.revision == revision


def test_the_table_would_notice_a_file_that_is_served(here: Served, folder: Path) -> None:
    (folder / "presets" / "mine.yaml").write_bytes((folder / "secret.yaml").read_bytes())
    status, _, body = raw(here, "GET", "/api/presets/mine?format=yaml")
    assert (status, "Three lanes" in body) == (200, True)
    status, _, _ = raw(here, "POST", "/api/presets/mine/load")
    assert status == 200
    (folder / "presets" / "mine.yaml").unlink()


CROSS = "cross-site"
# What a browser says of a request, and whether it may pass: Origin, Sec-Fetch-Site, -Mode, -Dest.
SITES: list[tuple[str, dict[str, str], bool]] = [
    ("a script or a program", {}, True),
    ("our own page", {"sec_fetch_site": "same-origin", "sec_fetch_mode": "cors"}, True),
    ("our own page, saying so", {"origin": "http://{here}"}, True),
    ("typed by hand", {"sec_fetch_site": "none", "sec_fetch_mode": "navigate"}, True),
    (
        "a link of another site",
        {"sec_fetch_site": CROSS, "sec_fetch_mode": "navigate", "sec_fetch_dest": "document"},
        True,
    ),
    ("a picture of another site", {"sec_fetch_site": CROSS, "sec_fetch_mode": "no-cors"}, False),
    ("a script of another site", {"sec_fetch_site": CROSS, "sec_fetch_dest": "script"}, False),
    (
        "a frame of another site",
        {"sec_fetch_site": CROSS, "sec_fetch_mode": "navigate", "sec_fetch_dest": "iframe"},
        False,
    ),
    (
        "another port of this machine",
        {"sec_fetch_site": "same-site", "sec_fetch_mode": "no-cors"},
        False,
    ),
    ("a request of another origin", {"origin": "https://elsewhere.example"}, False),
    ("another port, saying so", {"origin": "http://localhost:1"}, False),
    ("a page without an origin", {"origin": "null"}, False),
    ("a name that begins like ours", {"origin": "http://{here}.example"}, False),
    ("a rebound name", {"host": "rebound.example:{port}"}, False),
    ("a rebound name without a port", {"host": "rebound.example"}, False),
    ("another port's name", {"host": "localhost:1"}, False),
    (
        "a rebound name that agrees with itself",
        {"host": "rebound.example:{port}", "origin": "http://rebound.example:{port}"},
        False,
    ),
]


@pytest.mark.parametrize(("who", "said", "passes"), SITES, ids=[who for who, _, _ in SITES])
@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("GET", "/"),
        ("GET", "/api/experiment"),
        ("GET", "/static/main.js"),
        ("GET", "/scene/"),
        ("POST", "/api/session/pause"),
        ("PATCH", "/api/session"),
        ("DELETE", "/api/presets/nothing"),
    ],
)
def test_who_may_ask(
    here: Served, who: str, said: dict[str, str], passes: bool, method: str, path: str
) -> None:
    names = {"here": here.url[7:], "port": str(here.policy.port)}
    headers = {name: value.format(**names) for name, value in said.items()}
    status, answered, body = raw(here, method, path, **headers)
    assert (status != 403) is passes
    assert all(name in answered for name in HEADERS)
    assert "access-control-allow-origin" not in answered
    if not passes:
        code = json.loads(body)["error"]["code"]
        assert code in ("origin_refused", "site_refused", "host_refused")


@pytest.mark.parametrize("path", ["/api/live", "/scene", "/scene/"])
@pytest.mark.parametrize(
    ("who", "said", "passes"),
    [row for row in SITES if {"origin", "host"} & set(row[1]) or not row[1]],
)
def test_who_may_open_a_websocket(
    here: Served, who: str, said: dict[str, str], passes: bool, path: str
) -> None:
    names = {"here": here.url[7:], "port": str(here.policy.port)}
    headers = {name: value.format(**names) for name, value in said.items()}
    host = headers.pop("host", here.url[7:])
    line = socket.create_connection(("127.0.0.1", here.policy.port), timeout=30.0)
    options: dict[str, Any] = {"sock": line, "proxy": None, "additional_headers": headers}
    if passes:
        with connect(f"ws://{host}{path}", **options):
            return
    with pytest.raises(InvalidStatus) as refused:
        connect(f"ws://{host}{path}", **options)
    assert refused.value.response.status_code == 403


def test_every_kind_of_answer_carries_the_security_headers(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    ask = served.http.request

    def fail() -> None:
        raise RuntimeError

    answers = {
        "page": ask("GET", "/"),
        "head": ask("HEAD", "/static/main.js"),
        "file": ask("GET", "/static/screen/style.css"),
        "JSON": ask("GET", "/api/session"),
        "YAML": ask("GET", "/api/experiment?format=yaml"),
        "numbers": ask("POST", "/api/preview", json={"estimate": False}),
        "lines": ask(
            "POST", "/api/studies/strip", json={"lane": "NFTSM", "field": "nu", "count": 2}
        ),
        "scene": ask("GET", "/scene/"),
        "documentation": ask("GET", "/docs"),
        "redirect": ask("GET", "/scene"),
        "nothing": ask("DELETE", "/api/presets/nothing"),
        "not found": ask("GET", "/nowhere"),
        "method": ask("PUT", "/"),
        "too large": ask("PUT", "/api/experiment", content=b" " * 300_000),
        "wrong": ask("PATCH", "/api/experiment", json={"lanes": 3}),
        "refused": ask("GET", "/", headers={"host": "elsewhere.example"}),
    }
    seen = ask("GET", "/static/main.js").headers["etag"]
    answers["not modified"] = ask("GET", "/static/main.js", headers={"if-none-match": seen})
    monkeypatch.setattr(served.app_state, "health", fail)
    answers["mistake"] = ask("GET", "/api/health")
    kinds = {answer.status_code for answer in answers.values()}
    assert kinds >= {200, 304, 307, 403, 404, 405, 413, 422, 500}
    for kind, answer in answers.items():
        assert all(name in answer.headers for name in HEADERS), kind


def test_no_page_of_ours_needs_more_than_the_policy_allows() -> None:
    web = Path(__file__).resolve().parents[3] / "web"
    for page in web.rglob("*.html"):
        text = page.read_text(encoding="utf-8").lower()
        assert "<style" not in text
        assert "javascript:" not in text
        assert "http://" not in text
        assert "https://" not in text
        assert " on" not in "".join(part.split(">")[0] for part in text.split("<")[1:]), page
        for script in text.split("<script")[1:]:
            assert "src=" in script.split(">")[0]
