"""The application: routes, errors, static files, and what starts and stops with it."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress

from fastapi import FastAPI
from starlette.types import ASGIApp

from slidetune.robot import __version__
from slidetune.server.contract.openapi import REFUSALS
from slidetune.server.contract.refusals import install_refusals
from slidetune.server.guard.access import Access
from slidetune.server.guard.access_policy import AccessPolicy
from slidetune.server.guard.body_limit import BodyLimit
from slidetune.server.hosting.page_files import serve_page
from slidetune.server.routes.arms import arms_router
from slidetune.server.routes.docs import docs_router
from slidetune.server.routes.downloads.exports import exports_router
from slidetune.server.routes.downloads.handover import handover_router
from slidetune.server.routes.downloads.report import report_router
from slidetune.server.routes.experiment import experiment_router
from slidetune.server.routes.history import history_router
from slidetune.server.routes.kept_studies import kept_studies_router
from slidetune.server.routes.lens import lens_router
from slidetune.server.routes.lessons import lessons_router
from slidetune.server.routes.live import live_router
from slidetune.server.routes.logs import logs_router
from slidetune.server.routes.presets import presets_router
from slidetune.server.routes.preview import preview_router
from slidetune.server.routes.results import results_router
from slidetune.server.routes.session import session_router
from slidetune.server.routes.studies import studies_router
from slidetune.server.scene.relay import scene_router
from slidetune.server.state.app_state import AppState
from slidetune.server.state.hub import Hub

_DESCRIPTION = """
The live session of a JAKA Zu 5 under sliding-mode control: one document (the experiment), changed
by JSON Merge Patches; commands to the session; presets. Live data arrive over the WebSocket at
`/api/live`, which [a page of its own](/docs/live) describes.
"""


def create_app(app_state: AppState, policy: AccessPolicy) -> ASGIApp:
    """Return the whole application.

    Args:
        app_state: session, document and scene; started and stopped with the application.
        policy: who may talk to it.

    Returns:
        An ASGI application, guarded.
    """
    hub = Hub(app_state)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        task = hub.start()
        app_state.start()
        try:
            yield
        finally:
            task.cancel()
            with suppress(asyncio.CancelledError):
                await task
            await asyncio.to_thread(app_state.stop)

    app = FastAPI(
        title="Slidetune",
        version=__version__,
        description=_DESCRIPTION,
        lifespan=lifespan,
        docs_url=None,
        redoc_url=None,
        responses=REFUSALS,
    )
    install_refusals(app)
    app.include_router(session_router(app_state))
    app.include_router(experiment_router(app_state))
    app.include_router(presets_router(app_state))
    app.include_router(arms_router(app_state))
    app.include_router(logs_router(app_state))
    app.include_router(handover_router(app_state))
    app.include_router(exports_router(app_state))
    app.include_router(report_router(app_state))
    app.include_router(history_router(app_state))
    app.include_router(lessons_router())
    app.include_router(preview_router(app_state))
    app.include_router(studies_router(app_state))
    app.include_router(kept_studies_router(app_state))
    app.include_router(lens_router(app_state))
    app.include_router(results_router(app_state))
    app.include_router(live_router(app_state, hub))
    app.include_router(docs_router())
    scene = app_state.view.scene
    app.include_router(scene_router(scene.port, scene.lock()))
    serve_page(app)
    return Access(BodyLimit(app), policy)
