"""Messages to the live WebSocket of a real server: every one is acted on or refused in words."""

from __future__ import annotations

import json
import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from random import Random
from typing import Any

from pydantic import TypeAdapter
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from slidetune.robot.errors import SlidetuneError
from slidetune.robot.experiment.document import Experiment
from slidetune.server.contract.messages import ClientMessage
from slidetune.server.guard.limits import CLIENT_RATE, MAX_MESSAGE
from slidetune.server.guard.message_size import message_cost
from tests.trust.fuzz.patch import patch_input
from tests.trust.fuzz.values import BAD_JSON, TEXTS, Instances, json_text, wrong
from tests.trust.fuzz.verdict import Fault, Tally, shown, unclear_answer

BATCH = 24
CLEAR_CLOSES = (1007, 1008, 1009, 1013)
"""Not UTF-8, refused, too large, later: closing is the WebSocket's own word for these."""
_PATIENCE = 15.0
_LONG_PATIENCE = 120.0
_SILENT = logging.getLogger("slidetune.fuzz")
_SILENT.setLevel(logging.CRITICAL + 1)
_SCHEMA = TypeAdapter(ClientMessage).json_schema()
_MESSAGES = Instances(_SCHEMA, _SCHEMA, ("A", "B", "NFTSM", "a.b", "play"))


@dataclass(frozen=True)
class Frame:
    """One WebSocket message as it is sent."""

    payload: bytes
    text: bool

    @property
    def alone(self) -> bool:
        """Whether the WebSocket itself ends over it: then nothing else may be on its way."""
        if len(self.payload) > MAX_MESSAGE:
            return True
        try:
            return not self.text or not self.payload.decode()
        except UnicodeDecodeError:
            return True


def _message(random: Random) -> str:
    wildness = random.choice((0.0, 0.05, 0.3))
    made = _MESSAGES.make(random, wildness)
    if isinstance(made, dict) and made.get("type") == "step":
        made["count"] = random.choice((1, 3, 0, -1, 4001, "1", 1e400))
    return json_text(made)


def _patch(random: Random) -> str:
    message = {"type": "patch", "patch": patch_input(random), "id": wrong(random)}
    if random.random() < 0.8:
        message["id"] = random.choice((1, "a", None))
    return json_text(message)


def _twice(random: Random) -> str:
    keys = ('"type": "patch"', '"type": "play"', '"patch": {"title": "a"}', '"id": 1', '"patch": 3')
    return "{" + ", ".join(random.choices(keys, k=4)) + "}"


def _broken(random: Random) -> str:
    text = random.choice((_message, _patch))(random)[:20_000]
    start = random.randrange(len(text) + 1)
    token = random.choice(("", *BAD_JSON, *TEXTS))
    return text[:start] + token + text[start + random.choice((0, 1, 5, len(text))) :]


def _large(random: Random) -> str:
    size = random.choice((200_000, 250_000, 262_144, 300_000))
    key = random.choice(("id", "title", "lane"))
    return f'{{"type": "select", "{key}": "{"x" * size}"}}'


def live_input(random: Random) -> Frame:
    """Return one message that a client might send."""
    kinds: tuple[Callable[[Random], str], ...] = (_message, _patch, _twice, _broken, _large)
    try:
        text = random.choices(kinds, (35, 35, 5, 24, 1))[0](random)
    except RecursionError:
        text = '{"type": "patch", "patch": ' + '{"a": ' * 900 + "1" + "}" * 901
    payload = text.encode("utf-8", random.choice(("surrogatepass", "replace")))
    if random.random() < 0.03:
        place = random.randrange(len(payload) + 1)
        payload = payload[:place] + random.choice((b"\xff", b"\xc0\xaf", b"\x00")) + payload[place:]
    return Frame(payload, random.random() > 0.02)


class LiveFuzz:
    """One client that sends wrong messages, and watches what is told.

    Attributes:
        tally: what became of the messages.
    """

    def __init__(self, port: int) -> None:
        """Talk to the server at ``port`` of this machine."""
        self._url = f"ws://127.0.0.1:{port}/api/live"
        self._socket: ClientConnection | None = None
        self._fence = 0
        self._client = ""
        self._revision = 0
        self._document: Any = None
        self._due = time.monotonic()
        self.tally = Tally()

    def close(self) -> None:
        """Hang up."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def judge(self, frames: list[Frame]) -> None:
        """Send some messages and judge the answer to each."""
        waiting = list(frames)
        while waiting:
            begin, alone = time.monotonic(), [frame.alone for frame in waiting[:BATCH]]
            if alone[0]:
                done = self._one(waiting[0])
            else:
                done = self._batch(waiting[: alone.index(True) if True in alone else BATCH])
            self.tally.time((time.monotonic() - begin) / max(1, done))
            waiting = waiting[done:]

    def alive(self) -> str:
        """Return what a fresh client misses, or an empty text."""
        self.close()
        socket, missing, end = (
            self._connected(),
            {"state", "metrics", "frame"},
            time.monotonic() + _LONG_PATIENCE,
        )
        socket.send('{"type": "play"}')
        while missing and time.monotonic() < end:
            told = socket.recv(timeout=_LONG_PATIENCE)
            missing -= {"frame"} if isinstance(told, bytes) else {json.loads(told)["type"]}
        return ", ".join(sorted(missing))

    def _connected(self) -> ClientConnection:
        if self._socket is None:
            self._socket = connect(
                self._url, max_size=None, compression=None, proxy=None, logger=_SILENT
            )
            hello = json.loads(self._socket.recv(timeout=_PATIENCE))
            if self._document not in (None, hello["experiment"]):
                self.tally.add(Fault("the document changed unasked", "after a connection", ""))
            self._take(hello)
            self._client = hello["client"]
        return self._socket

    def _take(self, message: dict[str, Any]) -> None:
        self._revision, self._document = message["revision"], message["experiment"]

    def _batch(self, batch: list[Frame]) -> int:
        """Send messages with a fence behind each; return how many were answered."""
        first, done = self._fence + 1, 0
        try:
            socket = self._connected()
            for frame in batch:
                self._fence += 1
                self._pace(frame)
                socket.send(frame.payload, text=frame.text)
                socket.send(json.dumps({"type": "fence", "id": f"fence-{self._fence}"}))
            for number, frame in enumerate(batch):
                self._note(frame, self._until(socket, first + number))
                done += 1
        except TimeoutError:
            self._silent(batch[done])
            done += 1
        except ConnectionClosed as closed:
            self._socket = self._document = None  # what came before may have been acted on
            self._closed(batch[done], closed)
            done += 1
        return done

    def _one(self, frame: Frame) -> int:
        """Send a message that may end the connection, and nothing behind it."""
        try:
            socket = self._connected()
            socket.send(frame.payload, text=frame.text)
            self._note(frame, [self._refusal(socket)])
        except TimeoutError:
            self._silent(frame)
        except ConnectionClosed as closed:
            self._socket = None
            self._closed(frame, closed)
        return 1

    def _refusal(self, socket: ClientConnection) -> dict[str, Any]:
        while True:
            received = socket.recv(timeout=_PATIENCE)
            if isinstance(received, str) and (told := json.loads(received))["type"] == "error":
                return dict(told)

    def _silent(self, frame: Frame) -> None:
        self.close()
        self._document = None
        self.tally.note(False, ("falls silent", f"for {_PATIENCE:g} s"), shown(frame.payload))

    def _pace(self, frame: Frame) -> None:
        # Within the limit, the fence counted too: a message that comes too fast is refused unread.
        count = 1 + message_cost(frame.payload.decode("utf-8", "replace"))
        self._due = max(self._due + 1.05 * count / CLIENT_RATE, time.monotonic() - 1.0)
        time.sleep(max(0.0, self._due - time.monotonic()))

    def _until(self, socket: ClientConnection, fence: int) -> list[dict[str, Any]]:
        """Return what was told before the refusal of a fence."""
        told: list[dict[str, Any]] = []
        while True:
            received = socket.recv(timeout=_PATIENCE)
            if isinstance(received, bytes):
                continue
            message = json.loads(received)
            if message["type"] == "error" and message["id"] == f"fence-{fence}":
                return told
            if message["type"] in ("error", "patch", "hello"):
                told.append(message)

    def _note(self, frame: Frame, told: list[dict[str, Any]]) -> None:
        errors = [message for message in told if message["type"] == "error"]
        complaint = _complaint(frame, errors, [one for one in told if one["type"] == "patch"])
        for message in told:
            if message["type"] != "error":
                if message["type"] == "patch" and message["revision"] > self._revision + 1:
                    complaint = ("revisions are missing", str(message["revision"]))
                self._take(message)
        self.tally.note(not errors, complaint, shown(frame.payload))

    def _closed(self, frame: Frame, closed: ConnectionClosed) -> None:
        code = closed.rcvd.code if closed.rcvd else None
        clear = code in CLEAR_CLOSES
        complaint = None if clear else (f"the connection ended with {code}", str(closed))
        self.tally.note(False, complaint, shown(frame.payload))


def _complaint(
    frame: Frame, errors: list[dict[str, Any]], patches: list[dict[str, Any]]
) -> tuple[str, str] | None:
    """Return cause and detail of a fault in what one message brought about."""
    if errors and patches:
        return "refused and yet changed", str(errors[0])[:300]
    if len(errors) > 1:
        return "refused more than once", str(errors)[:300]
    for error in errors:
        body = {"error": error["error"]} if "error" in error else error
        cause = unclear_answer(body, frame.payload.decode("utf-8", "replace"))
        if cause is not None:
            return cause, str(body)[:400]
        if len(json.dumps(error["id"])) > 300:
            return "the sender's number comes back whole", str(error["id"])[:60]
    for patch in patches:
        try:
            if Experiment.from_document(patch["experiment"]).document() != patch["experiment"]:
                return "told an experiment that reads back changed", ""
        except SlidetuneError as refused:
            return "told an experiment that is refused", str(refused)[:300]
    return None
