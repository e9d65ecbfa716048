"""What the live WebSocket says to its clients, as typed models."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.quantity import MOST_JOINTS
from slidetune.robot.loop.figures import FIGURES
from slidetune.server.contract.messages import (
    ErrorDetail,
    LawInfo,
    RequestId,
    SessionState,
    ViewState,
)

_PerJoint = Annotated[list[float], Field(min_length=1, max_length=MOST_JOINTS)]


class LaneColor(BaseModel):
    """A lane and the colour that it has everywhere."""

    name: str
    color: str = Field(pattern="^#[0-9A-F]{6}$", examples=["#0072B2"])


class ChannelInfo(BaseModel):
    """One column of the telemetry frames."""

    name: str = Field(examples=["NFTSM/e1", "q_d1", "flange_d_x"])
    group: str = Field(
        description="Quantity: q_d, v_d and flange_d are desired and shared by all lanes; e, de "
        "(errors), tau (torque), S (sliding variable), f (network), weights, flange belong to one "
        "lane."
    )
    joint: int | str = Field(description="Joint, from 1, or axis x, y or z of a position.")
    lane: str = Field(description="The lane that it belongs to; empty if shared by all.")
    unit: str = Field(examples=["rad", "N·m"])


class LawFileState(BaseModel):
    """A file of a law of one's own, and what became of its present content."""

    file: str = Field(description="Its name.")
    law: str = Field(description="Name of its law.")
    state: Literal["good", "trying", "refused"] = Field(
        description="`good`: in use. `trying`: it was saved and is being tried. `refused`: it has "
        "an error; the last good version is in use."
    )
    message: str = Field(description="What is wrong with it, or what was left out, in one line.")
    trace: str = Field(description="The lines of the file that led to the error.")


class HelloMessage(BaseModel):
    """Everything that a client needs to begin.

    It comes first, and again whenever the columns of the frames change (another experiment, a lane
    more or less) or the client's queue was full: it replaces everything before it.
    """

    type: Literal["hello"]
    version: str = Field(description="Slidetune's.")
    client: str = Field(description="The client's own name: the `author` of its patches.")
    role: Literal["owner", "viewer"] = Field(description="A viewer may watch but change nothing.")
    revision: int = Field(description="Number of accepted changes of the experiment.")
    experiment: Experiment = Field(description="The current experiment.")
    baseline: Experiment = Field(description="The experiment as it was loaded or saved.")
    preset: str = Field(description="Name of the preset that it comes from, or empty.")
    lanes: list[LaneColor] = Field(description="In order.")
    channels: list[ChannelInfo] = Field(description="The columns of the frames, in order.")
    laws: list[LawInfo] = Field(description="Every control law that a lane may have.")
    law_files: list[LawFileState] = Field(
        description="Files of laws of one's own, as the command line names them."
    )
    state: SessionState
    selected: str = Field(description="The lane whose arm is solid in 3D.")
    view: ViewState


class PatchEcho(BaseModel):
    """A change of the experiment was accepted; sent to every client, its author included."""

    type: Literal["patch"]
    revision: int = Field(
        description="The revision after it; frames computed under it carry the same."
    )
    author: str = Field(description="Name of the client that asked; empty for HTTP.")
    id: RequestId | None = Field(description="The author's `id` of the request.")
    patch: dict[str, Any] = Field(description="The JSON Merge Patch (RFC 7396).")
    experiment: Experiment = Field(description="The whole experiment after it.")


class Since(BaseModel):
    """The time from which the total of a lane's figures counts."""

    time: float = Field(description="Simulated time of the first row that counts [s].")
    reason: Literal["reset", "change", "added", "branch"] = Field(
        description="`reset`: the session was reset, or its experiment loaded. `change`: the last "
        "change of the lane's closed loop: its law or gains, the arm, the trajectory, the "
        "disturbance or the simulation; a rename, a kick, the horizon and the high frequency do "
        "not count. `added`: the lane is new or a copy. `branch`: the session went back to this "
        "moment."
    )


def _figure(name: str) -> Any:
    return Field(description=FIGURES[name].description)


class Figures(BaseModel):
    """Performance of a lane over a span of time; rows after a freeze are excluded.

    Means are over time: after a change of step or control rate, each row counts by its own period.
    How each is called and written stands in ``x-figures`` of ``GET /api/schema``.
    """

    mae: _PerJoint = _figure("mae")
    max_error: _PerJoint = _figure("max_error")
    max_velocity_error: _PerJoint = _figure("max_velocity_error")
    chattering: float = _figure("chattering")
    switches: _PerJoint = _figure("switches")
    peak_torque: _PerJoint = _figure("peak_torque")
    flange_rms: float = _figure("flange_rms")
    flange_max: float = _figure("flange_max")
    rms_torque: _PerJoint = _figure("rms_torque")


class SamplingMargin(BaseModel):
    """Stability margin of a sampled loop at its control rate."""

    stable: bool = Field(description="Whether a small deviation decays.")
    radius: float | None = _figure("radius")
    bounded: bool = Field(description="Whether a motion outside the layer stays in a limit cycle.")
    gamma: float | None = _figure("gamma")
    gamma_limit: float | None = _figure("gamma_limit")


class Advice(BaseModel):
    """A remark on a lane's numbers."""

    level: Literal["info", "warning"] = Field(description="`warning` where a failure is expected.")
    path: str = Field(description="The field that it concerns.")
    message: str = Field(description="The value, the rule and the remedy.")
    patch: dict[str, Any] | None = Field(description="A merge patch that sets a good value.")
    title: str = Field(description="Title for that patch; empty if its values are clear enough.")


class LaneMetrics(BaseModel):
    """A lane's figures."""

    since: Since
    total: Figures | None = Field(description="Since then; null before the first row.")
    recent: Figures | None = Field(
        description="Over the last 10 s of simulated time, up to 0.1 s more, whatever changed."
    )
    gamma: float | None = Field(description="As in `margin`; null in continuous mode.")
    margin: SamplingMargin | None = Field(description="Null in continuous mode.")
    notes: list[Advice] = Field(description="Remarks on doubtful values.")


class MetricsMessage(BaseModel):
    """The figures of every lane, about twice per second."""

    type: Literal["metrics"]
    lanes: dict[str, LaneMetrics] = Field(description="By name.")


class StateMessage(SessionState):
    """State of the live session, five times per second and at every change."""


class LawsMessage(BaseModel):
    """The file of a law of one's own was saved, tried, taken or refused."""

    type: Literal["laws"]
    laws: list[LawInfo] = Field(description="Every control law that a lane may have.")
    law_files: list[LawFileState] = Field(description="All files of laws of one's own.")
    schema_: dict[str, Any] | None = Field(
        alias="schema",
        description="What `GET /api/schema` returns, if a law is another one now; else null. The "
        "`patch` that follows has the experiment with its gains.",
    )
    baseline: dict[str, Any] | None = Field(
        description="The experiment as it was loaded or saved, with its gains; null without schema."
    )


class NoticeMessage(BaseModel):
    """A message to be shown to all users."""

    type: Literal["notice"]
    message: str = Field(description="The text.")


class RefusalMessage(BaseModel):
    """A message of this client was refused and changed nothing; sent to this client only."""

    type: Literal["error"]
    id: RequestId | None = Field(description="The client's `id` of the request.")
    error: ErrorDetail


SERVER_MESSAGES: tuple[type[BaseModel], ...] = (
    HelloMessage,
    StateMessage,
    MetricsMessage,
    PatchEcho,
    LawsMessage,
    NoticeMessage,
    RefusalMessage,
)
"""All of them, in the order in which one meets them."""
