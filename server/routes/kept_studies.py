"""Studies that are kept, over HTTP: begin, follow, read, stop, go on, delete, download."""

from __future__ import annotations

import asyncio
import json
import re
from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import APIRouter, Body, Depends, Header, Path, Query, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.responses import StreamingResponse
from pydantic import ValidationError

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.plain_yaml import read_plain_yaml
from slidetune.robot.study.results import bands_of, result_of
from slidetune.robot.study.study import KINDS, Study
from slidetune.server.compute.run_cost import refuse_if_costly
from slidetune.server.contract.messages import ErrorAnswer
from slidetune.server.contract.openapi import YAML
from slidetune.server.contract.study_messages import (
    Acceptance,
    Accepting,
    NewStudy,
    Replayed,
    StudyAnswer,
    StudyBands,
    StudyEntries,
    StudyList,
    StudySummary,
)
from slidetune.server.guard.concurrency_limit import ConcurrencyLimit
from slidetune.server.guard.limited_stream import LimitedStream
from slidetune.server.guard.limits import (
    MAX_FOLLOWED,
    MAX_KEPT_STUDIES,
    TooManyKeptStudiesError,
    TooManyStudiesError,
)
from slidetune.server.guard.plain_json import NotJsonError, read_json
from slidetune.server.live.goal_watch import SECONDS
from slidetune.server.scene.replay import replay_of
from slidetune.server.state.app_state import AppState
from slidetune.server.studies.download import MEDIA, SUFFIXES, Format, download
from slidetune.server.studies.runner import UNDER_WAY, curves_from
from slidetune.server.studies.store import Record, UnknownStudyError

EVENTS = "text/event-stream"
PACE = 0.2
"""Time between two events of a study in [s] (*ours*)."""
MOST_ENTRIES = 1000
"""Most entries in one answer or event (*ours*)."""
Number = Annotated[int, Path(ge=1, le=2**53, description="The study's number.")]
Place = Annotated[int, Path(ge=0, le=2**53, description="Number of the entry, from 0.")]
TrialNumber = Annotated[
    int | None,
    Query(ge=0, le=2**53, description="Whose gains a preset has; the best trial's if left out."),
]
UNKNOWN: dict[int | str, dict[str, Any]] = {404: {"model": ErrorAnswer}}
VARIANT: dict[int | str, dict[str, Any]] = {**UNKNOWN, 422: {"model": ErrorAnswer}}
DOWNLOADS: dict[int | str, dict[str, Any]] = {
    **UNKNOWN,
    200: {"content": {media: {} for media in MEDIA.values()}},
    422: {"model": ErrorAnswer},
}
BODY = {"schema": NewStudy.model_json_schema()}
FOLLOWED: dict[int | str, dict[str, Any]] = {
    **UNKNOWN,
    200: {
        "content": {EVENTS: {}},
        "description": "Server-sent events: `progress` with a `StudySummary`, and the `entries` "
        "since the last one with the number of the `first`; the last of them says how it ended.",
    },
    429: {"model": ErrorAnswer},
}


async def new_study(request: Request) -> NewStudy:
    """Read what is wanted from JSON, or from YAML where the content type says so.

    Raises:
        InvalidExperimentError: if the body can't be read.
        RequestValidationError: naming every refused field.
    """
    body = await request.body()
    if "yaml" in request.headers.get("content-type", ""):
        values: Any = read_plain_yaml(body).values
        values.pop("result", None)  # of a study that was downloaded
    else:
        try:
            values = read_json(body)
        except NotJsonError as error:
            raise InvalidExperimentError([FieldError("", f"the body {error}")]) from error
    try:
        return NewStudy.model_validate(values)
    except ValidationError as error:
        raise RequestValidationError(error.errors(include_url=False)) from error


def _summary(app_state: AppState, record: Record) -> dict[str, Any]:
    names = ("id", "kind", "title", "created", "version", "state", "message", "total", "made")
    left = app_state.studies.seconds_left(record.id, record.made, record.total)
    told = {name: getattr(record, name) for name in names}
    tasks = app_state.studies.tasks_done(record.id)
    return {**told, "lane": record.wanted["lane"], "seconds_left": left, "tasks_done": tasks}


def _study(record: Record) -> Study:
    return Study.from_document(
        record.kind, Experiment.from_document(record.experiment), record.wanted
    )


def kept_studies_router(app_state: AppState) -> APIRouter:
    """Return the routes of the studies that are kept."""
    router = APIRouter(prefix="/api/studies", tags=["studies"])
    runner, store = app_state.studies, app_state.studies.store
    full = f"{MAX_FOLLOWED} clients follow studies already: try again later"
    followed = ConcurrencyLimit(MAX_FOLLOWED, lambda: TooManyStudiesError(full))

    @router.get("", response_model=StudyList)
    def all_studies() -> dict[str, Any]:
        """All studies that are kept, the newest first."""
        return {"studies": [_summary(app_state, record) for record in store.all()]}

    @router.get("/kinds")
    def kinds() -> dict[str, Any]:
        """JSON Schemas of what studies of each kind are told."""
        return {kind: model.model_json_schema() for kind, model in KINDS.items()}

    @router.post(
        "",
        status_code=201,
        response_model=StudySummary,
        responses={422: {"model": ErrorAnswer}, 507: {"model": ErrorAnswer}},
        openapi_extra={"requestBody": {"content": dict.fromkeys(("application/json", YAML), BODY)}},
    )
    def begin(wanted: Annotated[NewStudy, Depends(new_study)]) -> dict[str, Any]:
        """Begin a study; one runs at a time, others wait. A downloaded one can be begun again."""
        if len(store.all()) >= MAX_KEPT_STUDIES:
            text = f"{MAX_KEPT_STUDIES} studies are kept, which are as many as may be: delete one"
            raise TooManyKeptStudiesError(text)
        experiment = app_state.experiment_of(wanted.experiment, {})
        refuse_if_costly(experiment)
        study = Study.from_document(wanted.kind, experiment, wanted.wanted)
        return _summary(app_state, store.one(runner.begin(study, wanted.title)))

    @router.post("/accept", response_model=Accepting, responses={422: {"model": ErrorAnswer}})
    def accept(wanted: Annotated[Acceptance, Body()]) -> dict[str, Any]:
        """Use gains in the live session; if the lane leaves a hard goal, they go back."""
        author = wanted.client or "http"
        made = app_state.probation.accept(wanted.lane, wanted.patch, author)
        change, watched, unwatched = made
        told = {"watched": watched, "unwatched": unwatched}
        return {"revision": change.revision, "seconds": SECONDS, **told}

    @router.get("/{number:int}", response_model=StudyAnswer, responses=UNKNOWN)
    def one_study(number: Number) -> dict[str, Any]:
        """One study and what it shows so far."""
        record = store.one(number)
        study = _study(record)
        entries = study.read(store.texts(number))
        return {
            **_summary(app_state, record),
            "wanted": record.wanted,
            "experiment": record.experiment,
            "result": result_of(study, entries),
        }

    @router.get("/{number:int}/entries", response_model=StudyEntries, responses=UNKNOWN)
    def entries(number: Number, first: Annotated[int, Query(ge=0, le=2**53)] = 0) -> dict[str, Any]:
        """Entries of a study in their order, 1000 at most: trials, draws or points."""
        store.one(number)
        return {"first": first, "entries": store.entries(number, first, MOST_ENTRIES)}

    def variant_of(number: int, place: int) -> tuple[Study, Experiment]:
        study = _study(store.one(number))
        found = study.read(store.texts(number, place, 1))
        if not found:
            raise UnknownStudyError(f"study {number} has no entry {place}")
        return study, study.variant(found[0])

    @router.get("/{number:int}/entries/{place:int}/experiment", responses=VARIANT)
    def variant(number: Number, place: Place) -> dict[str, Any]:
        """The whole experiment that an entry is of: with its gains, its draw or its point."""
        _, other = variant_of(number, place)
        return other.document()

    @router.post(
        "/{number:int}/entries/{place:int}/replay", response_model=Replayed, responses=VARIANT
    )
    def replay(number: Number, place: Place) -> dict[str, Any]:
        """Show an entry's run in 3D beside the nominal one, in real time, to the horizon."""
        study, other = variant_of(number, place)
        color = app_state.colors.of(study.lane)
        app_state.view.show_replay(replay_of(study.experiment, other, study.lane, color))
        return {"seconds": study.experiment.simulation.horizon}

    @router.get("/{number:int}/bands", response_model=StudyBands, responses=UNKNOWN)
    def bands(number: Number) -> dict[str, Any]:
        """Within what the responses of the draws lie; empty of a study without draws."""
        study = _study(store.one(number))
        return bands_of(
            study, [curves_from(kept, study.experiment.joints) for kept in store.curves(number)]
        )

    @router.get("/{number:int}/events", response_class=StreamingResponse, responses=FOLLOWED)
    async def follow(
        number: Number,
        first: Annotated[int, Query(ge=0, le=2**53, description="Entries that are known.")] = 0,
        last_event_id: Annotated[str, Header(include_in_schema=False)] = "",
    ) -> StreamingResponse:
        """Follow a study: its entries as they come, until it ends."""
        await asyncio.to_thread(store.one, number)
        begin = int(last_event_id) if re.fullmatch(r"\d{1,9}", last_event_id) else first

        async def events() -> AsyncIterator[str]:
            known, ended, told = begin, False, ""
            while not ended:
                try:
                    record = await asyncio.to_thread(store.one, number)
                except UnknownStudyError:
                    return  # deleted meanwhile
                new = await asyncio.to_thread(store.entries, number, known, MOST_ENTRIES)
                data = {**_summary(app_state, record), "first": known, "entries": new}
                known += len(new)
                ended = record.state not in UNDER_WAY and len(new) < MOST_ENTRIES
                text = json.dumps(data, allow_nan=False, ensure_ascii=False)
                if text != told:
                    told = text
                    yield f"id: {known}\nevent: progress\ndata: {text}\n\n"
                if not ended and len(new) < MOST_ENTRIES:
                    await asyncio.sleep(PACE)

        return LimitedStream(followed, events(), EVENTS)

    @router.get("/{number:int}/download", responses=DOWNLOADS)
    def file(
        number: Number, format: Annotated[Format, Query()], trial: TrialNumber = None
    ) -> Response:
        """A study as a file: itself, its entries as a table, or a preset with found gains."""
        record = store.one(number)
        study = _study(record)
        entries = study.read(store.texts(number))
        content, media_type = download(study, record.title, entries, format, trial)
        disposition = f'attachment; filename="study-{number}.{SUFFIXES[format]}"'
        return Response(
            content, media_type=media_type, headers={"content-disposition": disposition}
        )

    @router.post("/{number:int}/stop", response_model=StudySummary, responses=UNKNOWN)
    def stop(number: Number) -> dict[str, Any]:
        """End a study early; what is done is kept."""
        runner.stop(number)
        return _summary(app_state, store.one(number))

    @router.post("/{number:int}/resume", response_model=StudySummary, responses=UNKNOWN)
    def resume(number: Number) -> dict[str, Any]:
        """Go on with a study that was stopped or has failed; of any other nothing is changed."""
        runner.resume(number)
        return _summary(app_state, store.one(number))

    @router.delete("/{number:int}", status_code=204, responses=UNKNOWN)
    def delete(number: Number) -> Response:
        """Forget a study, whatever it does."""
        runner.delete(number)
        return Response(status_code=204)

    return router
