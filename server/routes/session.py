"""The live session over HTTP: where it stands, and commands to it."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Body, Request

from slidetune.server.contract.live_messages import MetricsMessage
from slidetune.server.contract.messages import (
    Accepted,
    ErrorAnswer,
    Health,
    Kick,
    Reset,
    SessionState,
    Speed,
    Steps,
)
from slidetune.server.guard.access import role_in
from slidetune.server.guard.limits import limits_document
from slidetune.server.state.app_state import AppState

REFUSED: dict[int | str, dict[str, Any]] = {422: {"model": ErrorAnswer}}


def session_router(app_state: AppState) -> APIRouter:
    """Return the routes of the live session."""
    router = APIRouter(prefix="/api", tags=["session"])
    session = app_state.session

    @router.get("/health", response_model=Health)
    async def health(request: Request) -> dict[str, Any]:
        """Health of the server, your role and the limits."""
        role = role_in(request.scope)
        return {**app_state.health(), "role": role, "limits": limits_document()}

    @router.get("/session", response_model=SessionState)
    async def state() -> dict[str, Any]:
        """State of the live session."""
        return app_state.state()

    @router.patch("/session", response_model=SessionState, responses=REFUSED)
    async def change(speed: Speed) -> dict[str, Any]:
        """Change the speed; it takes effect with the next step."""
        session.set_speed(speed.speed)
        return {**app_state.state(), "speed": speed.speed}

    @router.post("/session/play", status_code=202)
    async def play() -> Accepted:
        """Start time; queued steps are discarded."""
        session.play()
        return Accepted(waiting_steps=0)

    @router.post("/session/pause", status_code=202)
    async def pause() -> Accepted:
        """Stop time; queued steps are discarded."""
        session.pause()
        return Accepted(waiting_steps=0)

    @router.post("/session/step", status_code=202, responses=REFUSED)
    async def step(steps: Annotated[Steps | None, Body()] = None) -> Accepted:
        """Pause and make some steps; at most 4000 are queued, further ones are not."""
        session.step((steps or Steps()).count)
        return Accepted(waiting_steps=session.waiting_steps)

    @router.post("/session/reset", status_code=202, responses=REFUSED)
    async def reset(what: Annotated[Reset | None, Body()] = None) -> Accepted:
        """Go back to time 0 and discard queued steps, or restart one lane only."""
        app_state.reset(what.lane if what else None)
        return Accepted(waiting_steps=session.waiting_steps)

    @router.post("/session/kick", status_code=202, responses=REFUSED)
    async def kick(push: Annotated[Kick | None, Body()] = None) -> Accepted:
        """Push the joints of all lanes."""
        push = push or Kick()
        session.kick(push.torque, push.duration)
        return Accepted(waiting_steps=session.waiting_steps)

    @router.get("/metrics", response_model=MetricsMessage)
    def metrics() -> dict[str, Any]:
        """Figures of every lane since its last change and over the last ten seconds; remarks."""
        return app_state.metrics()

    return router
