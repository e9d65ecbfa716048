"""The live WebSocket: patches and commands in, telemetry and news out."""

from __future__ import annotations

import asyncio
from typing import Any

from fastapi import APIRouter
from pydantic import TypeAdapter, ValidationError
from starlette.websockets import WebSocket, WebSocketDisconnect

from slidetune.robot.errors import SlidetuneError
from slidetune.server.contract.messages import (
    ClientMessage,
    KickMessage,
    LaneMessage,
    PatchMessage,
    PlainCommand,
    ResetMessage,
    SelectMessage,
    SpeedMessage,
    StepMessage,
    ViewMessage,
    is_request_id,
)
from slidetune.server.contract.refusals import message_body, refusal_body
from slidetune.server.guard.access import role_in
from slidetune.server.guard.access_policy import WATCH_ONLY
from slidetune.server.guard.errors import error_body
from slidetune.server.guard.limits import (
    CLIENT_BURST,
    CLIENT_RATE,
    MAX_CLIENTS,
    TOTAL_RATE,
    TooManyPatchesError,
)
from slidetune.server.guard.message_size import (
    message_cost,
    refuse_if_long,
    refuse_if_many,
    short_id,
)
from slidetune.server.guard.plain_json import NotJsonError, read_json
from slidetune.server.guard.token_bucket import TokenBucket
from slidetune.server.state.app_state import AppState
from slidetune.server.state.hub import Client, Hub, encode

_MESSAGE: TypeAdapter[Any] = TypeAdapter(ClientMessage)
_AGAIN = ": this one had no effect, send it again in a moment"


def _too_fast() -> TooManyPatchesError:
    return TooManyPatchesError(
        f"more than {CLIENT_RATE:g} messages per second from one client{_AGAIN}"
    )


class Conversation:
    """What one client asks for."""

    def __init__(self, client: Client, app_state: AppState, hub: Hub) -> None:
        """Act for ``client``."""
        self._client = client
        self._app_state = app_state
        self._hub = hub
        self._bucket = TokenBucket(CLIENT_RATE, CLIENT_BURST)

    async def hear(self, text: str) -> None:
        """Act on one message; a bad one is answered to this client alone and changes nothing."""
        if not await self._pace(message_cost(text)):
            self._refuse(refusal_body(_too_fast()), short_id(text))
            return
        request: Any = None
        try:
            refuse_if_long(text)
            data = read_json(text)
            request = data.get("id") if isinstance(data, dict) else None
            refuse_if_many(data)
            if self._client.role == "viewer":
                self._refuse(error_body("watch_only", WATCH_ONLY), request)
                return
            message = _MESSAGE.validate_python(data)
            self._share(message)
            await self._act(message)
        except ValidationError as error:
            self._refuse(message_body(error), request)
        except SlidetuneError as error:
            self._refuse(refusal_body(error), request)
        except NotJsonError as error:
            self._refuse(error_body("bad_message", f"The message {error}."), request)

    async def hear_binary(self) -> None:
        """Answer a message that isn't text."""
        if await self._pace(1):
            body = error_body("bad_message", "This server accepts text messages only.")
        else:
            body = refusal_body(_too_fast())
        self._refuse(body, None)

    async def _pace(self, cost: int) -> bool:
        """Let others have their turn, and say whether a message of ``cost`` may be acted on.

        A slow drip of refusals is all that a flood gets, whatever is in it.
        """
        if self._bucket.take(cost):
            await asyncio.sleep(0)  # many messages may be there already: they take turns too
            return True
        # This client's next message waits meanwhile; nobody else's does.
        await asyncio.sleep(1.0 / CLIENT_RATE)
        return False

    def _share(self, message: Any) -> None:
        """Refuse a patch where all clients together send too many.

        Raises:
            TooManyPatchesError: naming the limit; the message wasn't acted on.
        """
        if isinstance(message, PatchMessage | LaneMessage) and not self._hub.patches.take():
            text = f"more than {TOTAL_RATE:g} patches per second from all clients together"
            raise TooManyPatchesError(f"{text}{_AGAIN}")

    def _refuse(self, body: dict[str, Any], request: Any) -> None:
        known = request if is_request_id(request) else None
        self._client.tell(encode({"type": "error", "id": known, **body}))

    async def _act(self, message: Any) -> None:
        session = self._app_state.session
        if not isinstance(message, PlainCommand | ResetMessage):
            session.refuse_if_busy()
        match message:
            case PatchMessage():
                await self._patch(message)
            case PlainCommand():
                getattr(session, message.type)()
            case ResetMessage():
                self._app_state.reset(message.lane)
            case StepMessage():
                session.step(message.count)
            case KickMessage():
                session.kick(message.torque, message.duration)
            case SpeedMessage():
                session.set_speed(message.speed)
                session.ask(session.on_change)
            case SelectMessage():
                self._select(message.lane)
            case ViewMessage():
                self._view(message)
            case LaneMessage():
                await self._duplicate(message)

    async def _patch(self, message: PatchMessage) -> None:
        document, author = self._app_state.document, self._client.name
        await asyncio.to_thread(document.patch, message.patch, author, message.id)

    async def _duplicate(self, message: LaneMessage) -> None:
        document, author = self._app_state.document, self._client.name
        await asyncio.to_thread(
            document.duplicate, message.origin, message.name, author, message.id
        )

    def _select(self, lane: str) -> None:
        self._app_state.document.experiment.lane(lane)
        self._app_state.view.selected = lane
        self._app_state.session.ask(self._app_state.session.on_change)

    def _view(self, message: ViewMessage) -> None:
        view = self._app_state.view
        if message.exaggeration is not None:
            view.exaggeration = message.exaggeration
        if message.ghosts is not None:
            view.ghosts = message.ghosts
        self._app_state.session.ask(self._app_state.session.on_change)


async def _hear(socket: WebSocket, conversation: Conversation) -> None:
    """Hear until the client leaves."""
    while True:
        message = await socket.receive()
        if message["type"] == "websocket.disconnect":
            return
        if message.get("text") is not None:
            await conversation.hear(message["text"])
        else:
            await conversation.hear_binary()


async def _talk(socket: WebSocket, client: Client, conversation: Conversation) -> None:
    """Send and hear until either ends."""
    tasks = [asyncio.create_task(client.send()), asyncio.create_task(_hear(socket, conversation))]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        # Not awaited themselves: a traceback would keep this frame, and with it the client's ring.
        await asyncio.wait(tasks)
        for task in tasks:
            error = None if task.cancelled() else task.exception()
            if error is not None and not isinstance(error, WebSocketDisconnect | RuntimeError):
                raise error


def live_router(app_state: AppState, hub: Hub) -> APIRouter:
    """Return the live WebSocket."""
    router = APIRouter()

    @router.websocket("/api/live")
    async def live(socket: WebSocket) -> None:
        await socket.accept()
        if len(hub.clients) >= MAX_CLIENTS:
            await socket.close(1013, f"{MAX_CLIENTS} clients are connected already.")
            return
        client = Client(hub.new_name(), socket, app_state, role_in(socket.scope))
        hub.clients.add(client)
        try:
            await _talk(socket, client, Conversation(client, app_state, hub))
        except WebSocketDisconnect:
            pass
        finally:
            hub.clients.discard(client)

    return router
