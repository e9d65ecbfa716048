"""Every message of the HTTP and WebSocket contract as a typed model."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from slidetune.robot.experiment.document import LaneName
from slidetune.robot.fields.quantity import MOST_JOINTS
from slidetune.robot.lessons.lesson import MOST_EXAGGERATION
from slidetune.server.live.push import KICK_DURATION
from slidetune.server.live.session import SPEEDS

Finite = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Torque = Annotated[Finite, Field(ge=-1000.0, le=1000.0)]
RequestId = (
    Annotated[int, Field(strict=True, ge=-(2**53), le=2**53)]
    | Annotated[str, Field(strict=True, max_length=80)]
)
_REQUEST_ID: TypeAdapter[int | str] = TypeAdapter(RequestId)
# JSON knows lists only; what is in it is as strict as elsewhere.
Torques = Annotated[tuple[Torque, ...], Field(strict=False, min_length=1, max_length=MOST_JOINTS)]


class Strict(BaseModel):
    """A message that refuses what it doesn't know, and takes no ``true`` for a 1."""

    model_config = ConfigDict(extra="forbid", strict=True)


class RefusedField(BaseModel):
    """One refused value."""

    path: str = Field(
        examples=["lanes.NFTSM.nu", 'lanes."nu 0.5".nu'],
        description="Dotted keys; a key with a dot or a quote in it is quoted, as in TOML.",
    )
    message: str = Field(
        examples=["nu must be in [0.01, 100] 1/s, got -3"], description="What is wrong with it."
    )
    value: Any = Field(None, examples=[-3], description="The value that was sent.")
    allowed: str = Field(
        "", examples=["[0.01, 100] 1/s"], description="The values that are allowed."
    )
    line: int | None = Field(None, description="Line of the YAML text, if any.")


class ErrorDetail(BaseModel):
    """What went wrong."""

    code: str = Field(examples=["invalid"], description="Code for programs.")
    message: str = Field(description="What is wrong and the remedy, in words.")
    fields: list[RefusedField] = Field([], description="The refused values, if any.")


class ErrorAnswer(BaseModel):
    """The common format of all errors."""

    error: ErrorDetail


class Health(BaseModel):
    """Health of the server."""

    version: str
    uptime: float = Field(description="Seconds since the start.")
    state: Literal["running", "paused"]
    compiled: bool = Field(
        description="Whether whole runs of the live experiment take M and h from the compiled "
        "recursion; false: Pinocchio step by step, slower."
    )
    role: Literal["owner", "viewer"] = Field(description="A viewer may watch but change nothing.")
    limits: dict[str, int] = Field(description="By name: sizes in bytes, rates per second.")


class LawInfo(BaseModel):
    """One control law."""

    name: str = Field(examples=["rbfnn_nftsm"])
    title: str
    summary: str
    model_based: bool = Field(description="Whether it uses a model of the arm.")
    network: bool = Field(description="Whether it adapts a network.")
    version: str = Field(
        description="Digest of the file that it was read from; empty if it ships with Slidetune."
    )


class LaneStatus(BaseModel):
    """Whether a lane runs, and if not, why."""

    status: Literal["running", "frozen"] = Field(description="Frozen: it left its bounds.")
    time: float | None = Field(description="When it left its bounds [s].")
    joint: int | None = Field(description="The joint that left them, from 1.")
    cause: str | None = Field(description="What happened, in words.")
    gamma: float | None = Field(description="Sampling margin, if that is the cause.")
    radius: float | None = Field(
        description="Spectral radius of one control period, if that is the cause."
    )
    began: float = Field(
        description="When it started from its initial state [s]: 0, or when it was reset on its "
        "own."
    )
    trace: str = Field(
        description="The lines of a law's own file that led there, if its law failed."
    )
    remark: str | None = Field(description="A warning if the live curves are approximate.")


class ViewState(BaseModel):
    """How the scene shows the arms."""

    exaggeration: float = Field(description="Factor by which deviations are enlarged.")
    ghosts: bool = Field(description="Whether the arms of the lanes not selected are drawn.")


class ResultCounts(BaseModel):
    """How many results of the live experiment were kept; a changed number means a new result."""

    response: int = Field(description="Whole responses: ``GET /api/results/response``.")
    lens: int = Field(description="Lens results: ``GET /api/results/lens``.")
    logs: int = Field(description="Changes of logs and of their curves: ``GET /api/logs``.")


class SessionState(BaseModel):
    """State of the live session."""

    type: Literal["state"]
    time: float = Field(description="Simulated time [s].")
    playing: bool = Field(description="Whether time is running.")
    speed: float = Field(description="Requested simulated seconds per wall-clock second.")
    real_time_factor: float = Field(description="Measured simulated seconds per wall-clock second.")
    capped: bool = Field(description="Whether the machine is too slow for the speed.")
    revision: int = Field(description="Revision of the experiment that is being stepped.")
    epoch: int = Field(description="Number of resets and loaded experiments.")
    waiting_steps: int = Field(
        description="Requested steps that are still to be made, before any new request; play, "
        "pause, reset and another experiment discard them."
    )
    horizon: float = Field(description="Length of a whole response [s].")
    selected: str = Field(description="The lane whose arm is solid in 3D.")
    view: ViewState
    results: ResultCounts = Field(description="Number of results that viewers may read.")
    lanes: dict[str, LaneStatus] = Field(description="By name.")


_WAITING = "Steps that the live session makes before this takes effect; 0: at the next step."


class Accepted(BaseModel):
    """A command that the live session carries out."""

    accepted: Literal[True] = True
    waiting_steps: int = Field(description=_WAITING)


class ExperimentAnswer(BaseModel):
    """The live document."""

    revision: int
    preset: str
    experiment: dict[str, Any]
    waiting_steps: int = Field(0, description=_WAITING)


class LinkAnswer(BaseModel):
    """A link to the live experiment."""

    link: str = Field(description="What follows `#x=` in the address of a page.")


class LinkRequest(BaseModel):
    """A link to open."""

    link: str = Field(description="The text of `GET /api/link`, or an address with it.")
    despite: bool = Field(
        False, description="Open it even where another version makes another experiment of it."
    )


class PresetSummary(BaseModel):
    """One preset in a list."""

    name: str
    title: str
    description: str
    shipped: bool
    problem: str = Field("", description="Why it can't be loaded.")


class PresetList(BaseModel):
    """All presets."""

    presets: list[PresetSummary]


class PresetAnswer(PresetSummary):
    """One preset, whole."""

    experiment: dict[str, Any]


class Kick(Strict):
    """A push of all lanes' joints."""

    torque: Torques | None = Field(
        None,
        description="Torque [N·m] of each joint, force [N] of one that slides, each within ±1000; "
        "by default one that fits the arm's inertia.",
        examples=[[60.0, 60.0, 40.0, 10.0, 5.0, 2.0]],
    )
    duration: float = Field(
        KICK_DURATION,
        gt=0.0,
        le=10.0,
        description="How long it lasts [s]; rounded up to whole control steps.",
    )


class Reset(Strict):
    """What to reset."""

    lane: str | None = Field(
        None,
        description="`null`: everything, back to t = 0. Otherwise only this lane, while time "
        "continues: it restarts at the current point of the trajectory, with the initial error and "
        "velocity of the simulation, zero weights and no torque pending in the input delay.",
    )


class Steps(Strict):
    """How many steps to make."""

    count: int = Field(1, ge=1, le=4000, description="Control steps.")


class Speed(Strict):
    """Simulated seconds a wall second."""

    speed: float = Field(
        ge=SPEEDS[0], le=SPEEDS[1], description="Multiple of real time.", examples=[0.5]
    )


def is_request_id(value: object) -> bool:
    """Whether a message may bear this as its ``id``, which comes back in the answer."""
    try:
        _REQUEST_ID.validate_python(value)
    except ValidationError:
        return False
    return True


class Request(Strict):
    """What every message to the live session may contain."""

    id: RequestId | None = Field(None, description="Your own id for it; the answer contains it.")


class PatchMessage(Request):
    """Change the experiment by a JSON Merge Patch (RFC 7396); state and time continue."""

    type: Literal["patch"]
    patch: dict[str, Any] = Field(examples=[{"lanes": {"NFTSM": {"nu": 30}}}])


class PlainCommand(Request):
    """A command without parameters."""

    type: str


class PlayMessage(PlainCommand):
    """Start time; queued steps are discarded."""

    type: Literal["play"]


class PauseMessage(PlainCommand):
    """Stop time; queued steps are discarded."""

    type: Literal["pause"]


class ResetMessage(Reset, Request):
    """Reset the session or one lane; resetting the session discards queued steps."""

    type: Literal["reset"]


class StepMessage(Steps, Request):
    """Pause and make some steps; at most 4000 are queued, further ones are not."""

    type: Literal["step"]


class KickMessage(Kick, Request):
    """Push all lanes' joints."""

    type: Literal["kick"]


class SpeedMessage(Speed, Request):
    """Change the speed."""

    type: Literal["speed"]


class SelectMessage(Request):
    """Show a lane's arm solid."""

    type: Literal["select"]
    lane: str = Field(description="Its name.", examples=["NFTSM"])


class ViewMessage(Request):
    """Change how the scene shows the arms; omitted settings stay as they are."""

    type: Literal["view"]
    exaggeration: float | None = Field(
        None,
        ge=1.0,
        le=MOST_EXAGGERATION,
        description="Factor by which deviations are enlarged.",
        examples=[20],
    )
    ghosts: bool | None = Field(None, description="Whether the other lanes' arms are drawn.")


class LaneMessage(Request):
    """Add a lane with the gains and the state of another."""

    type: Literal["lane"]
    origin: str = Field(description="Name of the lane to copy.", examples=["NFTSM"])
    name: LaneName = Field(description="Name of the new one.", examples=["NFTSM 2"])


ClientMessage = Annotated[
    PatchMessage
    | PlayMessage
    | PauseMessage
    | ResetMessage
    | StepMessage
    | KickMessage
    | SpeedMessage
    | SelectMessage
    | ViewMessage
    | LaneMessage,
    Field(discriminator="type"),
]
