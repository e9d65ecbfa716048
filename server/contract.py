"""Every message of the HTTP and WebSocket contract as a typed model."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from robot.experiment import LaneName
from server.push import KICK, KICK_DURATION
from server.session import SPEEDS

Finite = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Torque = Annotated[Finite, Field(ge=-1000.0, le=1000.0)]
RequestId = (
    Annotated[int, Field(strict=True, ge=-(2**53), le=2**53)]
    | Annotated[str, Field(strict=True, max_length=80)]
)
_REQUEST_ID: TypeAdapter[int | str] = TypeAdapter(RequestId)
# JSON knows lists only; what is in it is as strict as elsewhere.
SixTorques = Annotated[tuple[Torque, Torque, Torque, Torque, Torque, Torque], Field(strict=False)]


class Strict(BaseModel):
    """A message that refuses what it doesn't know, and takes no ``true`` for a 1."""

    model_config = ConfigDict(extra="forbid", strict=True)


class RefusedField(BaseModel):
    """One refused value."""

    path: str = Field(
        examples=["lanes.NFTSM.nu", 'lanes."nu 0.5".nu'],
        description="Dotted keys; one that holds a dot or a quote stands in quotes, as in TOML.",
    )
    message: str = Field(examples=["nu must be in [0.01, 100] 1/s, got -3"])
    value: Any = Field(None, examples=[-3])
    allowed: str = Field("", examples=["[0.01, 100] 1/s"])
    line: int | None = Field(None, description="Line of the YAML text, where there is one.")


class ErrorDetail(BaseModel):
    """What went wrong."""

    code: str = Field(examples=["invalid"])
    message: str
    fields: list[RefusedField] = []


class ErrorAnswer(BaseModel):
    """The one shape of every error."""

    error: ErrorDetail


class Health(BaseModel):
    """Whether the server is well."""

    version: str
    uptime: float = Field(description="Seconds since the start.")
    state: Literal["running", "paused"]
    role: Literal["owner", "viewer"] = Field(description="A viewer watches and changes nothing.")
    limits: dict[str, int] = Field(description="By name: sizes in bytes, rates a second.")


class LawInfo(BaseModel):
    """One control law."""

    name: str = Field(examples=["rbfnn_nftsm"])
    title: str
    summary: str
    model_based: bool
    network: bool


class LaneStatus(BaseModel):
    """Whether a lane runs, and if not, why."""

    status: Literal["running", "frozen"]
    time: float | None = Field(description="When it left its bounds [s].")
    joint: int | None
    cause: str | None
    gamma: float | None = Field(description="Sampling margin where that is the reason.")
    radius: float | None = Field(
        description="Spectral radius of one control period where that is the reason."
    )
    remark: str | None = Field(
        description="That the live curves are approximate, where they are, in words."
    )


class ResultCounts(BaseModel):
    """How many results of the live experiment were kept; another number says that there is news."""

    response: int = Field(description="Whole responses: ``GET /api/results/response``.")
    lens: int = Field(description="Looks through a lens: ``GET /api/results/lens``.")


class SessionState(BaseModel):
    """Where the live session stands."""

    type: Literal["state"] = "state"
    time: float = Field(description="Simulated time [s].")
    playing: bool
    speed: float
    real_time_factor: float = Field(description="Simulated seconds a wall second, measured.")
    capped: bool = Field(description="Whether the machine is too slow for the speed.")
    revision: int
    epoch: int = Field(description="Counts resets and loaded experiments.")
    waiting_steps: int = Field(
        description="Steps that were asked for and will be made before what is asked for now; "
        "play, pause, reset and another experiment drop them."
    )
    horizon: float
    selected: str
    view: dict[str, Any]
    results: ResultCounts
    lanes: dict[str, LaneStatus]


_WAITING = "Steps that the live session makes before this takes force; 0: with the next step."


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

    torque: SixTorques = Field(KICK, description="N·m, each within ±1000.")
    duration: float = Field(KICK_DURATION, gt=0.0, le=10.0, description="s")


class Steps(Strict):
    """How many steps to make."""

    count: int = Field(1, ge=1, le=4000)


class Speed(Strict):
    """Simulated seconds a wall second."""

    speed: float = Field(ge=SPEEDS[0], le=SPEEDS[1], examples=[0.5])


def is_request_id(value: object) -> bool:
    """Whether a message may bear this as its ``id``, which comes back in the answer."""
    try:
        _REQUEST_ID.validate_python(value)
    except ValidationError:
        return False
    return True


class PatchMessage(Strict):
    """Change the experiment by a JSON Merge Patch."""

    type: Literal["patch"]
    patch: dict[str, Any]
    id: RequestId | None = None


class PlainCommand(Strict):
    """A command without anything to say."""

    type: Literal["play", "pause", "reset"]
    id: RequestId | None = None


class StepMessage(Steps):
    """Pause and make some steps."""

    type: Literal["step"]
    id: RequestId | None = None


class KickMessage(Kick):
    """Push all lanes' joints."""

    type: Literal["kick"]
    id: RequestId | None = None


class SpeedMessage(Speed):
    """Change the speed."""

    type: Literal["speed"]
    id: RequestId | None = None


class SelectMessage(Strict):
    """Show a lane's arm solid."""

    type: Literal["select"]
    lane: str
    id: RequestId | None = None


class ViewMessage(Strict):
    """Change how the scene shows the arms."""

    type: Literal["view"]
    exaggeration: float | None = Field(None, ge=1.0, le=50.0)
    ghosts: bool | None = None
    id: RequestId | None = None


class LaneMessage(Strict):
    """Duplicate a lane, gains and state."""

    type: Literal["lane"]
    origin: str
    name: LaneName
    id: RequestId | None = None


ClientMessage = Annotated[
    PatchMessage
    | PlainCommand
    | StepMessage
    | KickMessage
    | SpeedMessage
    | SelectMessage
    | ViewMessage
    | LaneMessage,
    Field(discriminator="type"),
]
