"""Bodies to every HTTP route that takes one, made after the server's own OpenAPI document."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from random import Random
from typing import Any

import httpx

from slidetune.robot.experiment.document import Experiment
from tests.trust.fuzz.patch import patch_input
from tests.trust.fuzz.values import BAD_JSON, TEXTS, Instances, json_text
from tests.trust.fuzz.verdict import Fault, Tally, shown, unclear_answer
from tests.trust.fuzz.yaml import yaml_input

START = {
    "title": "short",
    "robot": {"lag": 0.004},
    "lanes": {
        "A": {"law": "nftsm", "switching": "sign", "observer": "momentum"},
        "a.b": {"law": "super_twisting"},
    },
    "simulation": {"horizon": 0.2, "step": 0.002},
}
"""What is live: short, so that whole responses cost little."""
_EVERY = 60
_JSON, _YAML = "application/json", "application/yaml"
_HEADERS = ("", _JSON, _YAML, "text/plain", "application/json; charset=utf-16", "x" * 300, "*/*")
_NAMES = ("mine", "paper", "nobody", "A B", "con", "..", "%00", "x" * 300, "%F0%9F%A4%96", "a.yaml")


@dataclass(frozen=True)
class Operation:
    """One route that takes a body."""

    method: str
    path: str
    content: tuple[str, ...]
    instances: Instances


@dataclass(frozen=True)
class Request:
    """One request as it is sent."""

    method: str
    path: str
    kind: str
    body: bytes

    @property
    def words(self) -> str:
        """What it holds, in UTF-8 or in UTF-16, so that an echo of it is known as one."""
        bodies = (self.body, self.body.replace(b"\0", b""))
        return " ".join((self.path, *(body.decode("utf-8", "replace") for body in bodies)))

    def __str__(self) -> str:
        """Return it as one line."""
        return f"{self.method} {self.path} ({self.kind}) {shown(self.body)}"


def operations(document: dict[str, Any]) -> list[Operation]:
    """Return every route of an OpenAPI document that takes a body."""
    found = []
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            content = operation.get("requestBody", {}).get("content")
            if content:
                schema = content.get(_JSON, {}).get("schema", {})
                names = ("A", "a.b", "nu", "mine", "paper")
                made = Instances(schema, document, names)
                found.append(Operation(method.upper(), path, tuple(content), made))
    return found


def http_input(random: Random, known: list[Operation]) -> Request:
    """Return one request that a client might send."""
    operation = random.choice(known)
    kind = random.choice(operation.content)
    try:
        body = _body(random, operation, kind)
    except RecursionError:
        body = b'{"patch": ' * 900 + b"1" + b"}" * 900
    if random.random() < 0.15:
        kind = random.choice(_HEADERS)
    path = operation.path
    if "{" in path:
        head, _, tail = path.partition("{")
        path = head + random.choice(_NAMES) + tail.partition("}")[2]
    if random.random() < 0.05:
        path += "?" + random.choice(
            ("overwrite=maybe", "format=xml", "overwrite=1", "a" * 3000, "%ff=%ff")
        )
    return Request(operation.method, path, kind, body)


def _body(random: Random, operation: Operation, kind: str) -> bytes:
    if kind == _YAML and random.random() < 0.7:
        return yaml_input(random)
    made = operation.instances.make(random, random.choice((0.0, 0.05, 0.3)))
    if isinstance(made, dict):
        for key in {"patch", "experiment", "gains"} & set(made):
            made[key] = patch_input(random)
        if not made and random.random() < 0.8:
            made = patch_input(random)
    text = json_text(made)
    damage: tuple[Callable[[], bytes], ...] = (
        lambda: text.encode("utf-8", "replace"),
        lambda: text.encode("utf-8", "replace")[: random.randrange(len(text) + 1)],
        lambda: text.encode(random.choice(("utf-16", "utf-32", "utf-8-sig", "utf-8")), "replace"),
        lambda: text.replace(":", random.choice(BAD_JSON), 1).encode("utf-8", "replace"),
        lambda: text.encode("utf-8", "replace").replace(b"a", b"\xff", 1),
        lambda: random.choice((*BAD_JSON, *TEXTS)).encode("utf-8", "replace"),
        lambda: b" " * random.choice((0, 1, 262_143, 262_145, 2_000_000)) + text.encode()[:100],
    )
    return random.choices(damage, (60, 10, 6, 6, 6, 10, 2))[0]()


class HttpFuzz:
    """Sends wrong requests one after another, and looks at the document behind them.

    Attributes:
        tally: what became of the requests.
        operations: the routes that take a body.
    """

    def __init__(self, port: int) -> None:
        """Talk to the server at ``port`` of this machine."""
        self._http = httpx.Client(
            base_url=f"http://127.0.0.1:{port}", timeout=60.0, trust_env=False
        )
        self.operations = operations(self._http.get("/openapi.json").json())
        self._count = 0
        self.tally = Tally()
        self._afresh()

    def close(self) -> None:
        """Hang up."""
        self._http.close()

    def judge(self, request: Request) -> None:
        """Send a request and judge its answer."""
        self._count += 1
        if self._count % _EVERY == 0:
            self._afresh()
        begin = time.monotonic()
        complaint, accepted = None, False
        try:
            with self._sent(request) as answer:
                accepted = answer.status_code < 400
                body = b"".join(_beginning(answer)) if accepted else answer.read()
                complaint = self._complaint(request, answer, body)
        except httpx.HTTPError as error:
            complaint = (f"no answer: {type(error).__name__}", str(error)[:200])
        self.tally.time(time.monotonic() - begin, str(request))
        self.tally.note(accepted, complaint, str(request))

    @contextmanager
    def _sent(self, request: Request) -> Iterator[httpx.Response]:
        headers = {"content-type": request.kind} if request.kind else {}
        raw = self._http.build_request(
            request.method, request.path, content=request.body, headers=headers
        )
        answer = self._http.send(raw, stream=True)
        try:
            yield answer
        finally:
            answer.close()

    def _complaint(
        self, request: Request, answer: httpx.Response, body: bytes
    ) -> tuple[str, str] | None:
        if answer.status_code >= 500 and answer.status_code not in (503, 507):
            return f"{answer.status_code} from {request.method} {request.path}"[:80], shown(body)
        now = self._http.get("/api/experiment").json()
        before, self._live = self._live, now
        if answer.status_code < 400:
            return _reads_back(now)
        if now != before:
            return "refused and yet changed", str(answer.status_code)
        try:
            told = answer.json()
        except ValueError:
            return f"{answer.status_code} without JSON", shown(body)
        cause = unclear_answer(told, request.words)
        return None if cause is None else (cause, f"{answer.status_code} {shown(body)}")

    def _afresh(self) -> None:
        """Put the short experiment back, and speak to the arm as nobody did before."""
        answer = self._http.put("/api/experiment", json=START)
        if answer.status_code != 200:
            self.tally.add(Fault("a good experiment is refused", answer.text[:300], str(START)))
        self._live = self._http.get("/api/experiment").json()


def _beginning(answer: httpx.Response) -> Iterator[bytes]:
    """Yield the beginning of an answer: a study goes on for as long as anybody listens."""
    for chunk in answer.iter_bytes():
        yield chunk
        if "ndjson" in answer.headers.get("content-type", ""):
            return


def _reads_back(answer: dict[str, Any]) -> tuple[str, str] | None:
    document = answer["experiment"]
    if Experiment.from_document(document).document() != document:
        return "the document reads back changed", shown(document)
    return None
