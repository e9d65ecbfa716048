"""Arms over HTTP: list, bring one's own, begin with one, forget one."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import UploadFile

from slidetune.robot.arm.kept import kept_arms, remove
from slidetune.robot.arm.known import SHIPPED, arm_named, forget_arm, shipped_arms
from slidetune.robot.errors import UnknownArmError
from slidetune.robot.first_experiment.first_experiment import RATES, first_experiment, first_lane
from slidetune.robot.laws import LAWS
from slidetune.server.arms.unpacked import MOST_FILES, refused
from slidetune.server.arms.uploads import take_arm
from slidetune.server.compute.arm_kernels import load_kernels
from slidetune.server.contract.arms import ArmList, ArmReport, FirstLane
from slidetune.server.contract.messages import ErrorAnswer, ExperimentAnswer
from slidetune.server.contract.openapi import multipart
from slidetune.server.routes.experiment import answer
from slidetune.server.state.app_state import AppState

_REFUSED: dict[int | str, dict[str, Any]] = {422: {"model": ErrorAnswer}}
_UNKNOWN: dict[int | str, dict[str, Any]] = {404: {"model": ErrorAnswer}}
_FILES = multipart(
    {
        "files": {
            "type": "array",
            "items": {"type": "string", "format": "binary"},
            "description": "The URDF and its meshes, each with its path as the name of the file, "
            "or a ZIP of them.",
        }
    },
    ["files"],
)


def arms_router(app_state: AppState) -> APIRouter:
    """Return the routes of the arms."""
    router = APIRouter(prefix="/api/arms", tags=["arms"])

    @router.get("", response_model=ArmList)
    def all_arms() -> dict[str, Any]:
        """All arms that are known here: those that ship first."""
        shipped = [
            {
                "name": arm.name,
                "title": arm.title,
                "meaning": arm.meaning,
                "joints": arm.joints,
                "shipped": True,
            }
            for arm in shipped_arms().values()
        ]
        kept = [{**asdict(arm), "shipped": False} for arm in kept_arms()]
        return {"arms": shipped + kept, "live": app_state.arm}

    @router.get("/lane", response_model=FirstLane, responses=_REFUSED)
    def lane(law: Annotated[str, Query(examples=["smc"])]) -> dict[str, Any]:
        """A lane of a law with gains scaled to the live arm and its control rate, untried."""
        if law not in LAWS:
            raise refused(f"must be one of {', '.join(LAWS)}", law, "law")
        simulation = app_state.document.experiment.simulation
        rate = simulation.control_rate if simulation.mode == "sampled" else RATES[0]
        return {"lane": first_lane(app_state.arm, law, rate)}

    @router.post("", response_model=ArmReport, responses=_REFUSED, openapi_extra=_FILES)
    async def bring(
        request: Request,
        urdf: Annotated[str, Query(description="Path of the URDF where there are several.")] = "",
        tip: Annotated[str, Query(description="The link that is the arm's flange.")] = "",
        total_mass: Annotated[
            float | None, Query(gt=0.0, description="Mass of the whole arm in kg.")
        ] = None,
    ) -> dict[str, Any]:
        """Examine a URDF and keep the arm in it where nothing is refused.

        The answer tells, element by element, what is missing or wrong and what was assumed.
        """
        if "multipart/form-data" not in request.headers.get("content-type", ""):
            raise refused("send the files as multipart/form-data")
        async with request.form(max_files=MOST_FILES, max_fields=1) as form:
            sent = [
                (one.filename or "", one.file)
                for one in form.getlist("files")
                if isinstance(one, UploadFile)
            ]
            if not sent:
                raise refused("must be a URDF and its meshes, or a ZIP of them")
            return await run_in_threadpool(take_arm, sent, urdf, tip, total_mass)

    @router.post("/{name}/begin", response_model=ExperimentAnswer, responses=_UNKNOWN)
    def begin(name: str) -> dict[str, Any]:
        """Start the first experiment of an arm in the live session, at time 0."""
        try:
            arm_named(name)
        except ValueError as error:
            raise UnknownArmError(str(error)) from error
        load_kernels(name)
        preset = "paper" if name == SHIPPED else ""
        change = app_state.document.replace(first_experiment(name).experiment, preset, "http")
        return answer(change.revision, preset, change.experiment)

    @router.delete("/{name}", status_code=204, responses={**_UNKNOWN, **_REFUSED})
    def forget(name: str) -> Response:
        """Forget one of the user's own arms."""
        if name == app_state.arm:
            raise refused(
                "is the arm of the live experiment: begin with another one first", name, "name"
            )
        if not remove(name):
            raise UnknownArmError(f"no arm of your own is named {name}")
        forget_arm(name)
        return Response(status_code=204)

    return router
