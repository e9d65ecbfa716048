"""What is said of logs of a real arm over HTTP."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field

from slidetune.server.contract.messages import Finite, Strict

LONGEST_SHIFT = 1e6
"""Greatest shift in [s] (*ours*): eleven days."""
MOST_MAPPED = 100
"""Most columns that a mapping names (*ours*): time, and five of twelve joints."""
Text = Annotated[str, Field(max_length=500)]
Shift = Annotated[Finite, Field(ge=-LONGEST_SHIFT, le=LONGEST_SHIFT)]
Part = Literal["payload", "armature", "viscous_friction", "coulomb_friction", "constant"]
_PARTS: list[Part] = ["payload", "armature", "viscous_friction", "coulomb_friction", "constant"]


class LogWanted(Strict):
    """How a file is to be read, where its headers don't say it."""

    mapping: dict[Text, Text] = Field(
        {},
        max_length=MOST_MAPPED,
        examples=[{"time": "stamp", "1": "shoulder", "1.torque": "shoulder_nm"}],
        description="Column by what it holds: `time`, a joint by its name or its number from 1, "
        "with `.velocity`, `.torque`, `.current` or `.desired` behind it.",
    )
    source: Text | None = Field(
        None, description="The topic of an MCAP file, or what stands before the names that count."
    )
    angles: Literal["", "rad", "deg"] = Field(
        "", description="Unit of angles without one; velocities without one have it per s."
    )
    time: Literal["", "s", "ms", "us", "ns"] = Field("", description="Unit of time without one.")


class LogSummary(BaseModel):
    """One log."""

    number: int = Field(description="By which it is asked for.")
    name: str = Field(description="Of the file.")
    arm: str = Field(description="The arm that it is of.")
    rows: int
    duration: float = Field(description="From the first row to the last [s].")
    rate: float = Field(description="Rows a second [Hz].")
    holds: list[str] = Field(
        description="What it has columns of: `angles`, `velocities`, `torques`, `currents`, "
        "`desired angles`."
    )
    remarks: list[str] = Field(description="What was assumed and left out.")
    shown: bool = Field(description="Whether it is shown beside the lanes.")
    shift: float | None = Field(
        description="What is added to its time [s]; `null`: found by cross-correlation."
    )


class LogList(BaseModel):
    """All logs that are kept until the server ends."""

    logs: list[LogSummary] = Field(description="The oldest first.")


class LogReason(BaseModel):
    """Why a file was not read."""

    message: str = Field(description="What is wrong, where, and the way out.")
    row: int | None = Field(description="Line of the file or message of the topic, from 1.")
    column: str = Field(description="Header of the column, where one is to blame.")
    value: str = Field(description="What stands there.")


class LogReport(BaseModel):
    """What became of a file that was sent."""

    log: LogSummary | None = Field(description="`null`: it was not read as it stands.")
    reason: LogReason | None = Field(description="Why not.")
    columns: list[str] = Field(description="The headers that there are.")
    sources: list[str] = Field(description="What may be named as the source, where it has to be.")
    joints: list[str] = Field(description="Names of the arm's joints, from base to tip.")
    mapping: dict[str, str] = Field(
        description="The columns that headers, or the mapping that was sent, say clearly: by "
        "`time`, the number of a joint from 1, and that with `.torque`."
    )


class LogChange(Strict):
    """What is changed about a log."""

    shown: bool | None = Field(None, description="Show it beside the lanes, two at most.")


class OverlayRequest(Strict):
    """At which shift a log is compared with the live experiment."""

    shift: Shift | Literal["auto"] | None = Field(
        None,
        description="Added to its time [s], and kept; `auto`: found by cross-correlation; `null`: "
        "as it was last.",
    )


class TrajectoryRequest(Strict):
    """How a log is made a desired motion."""

    spacing: Annotated[Finite, Field(gt=0.0)] | None = Field(
        None, description="Time between two waypoints [s]; `null`: as many as it takes."
    )


class LogTrajectory(BaseModel):
    """A log as a desired motion."""

    patch: dict[str, Any] = Field(description="Merge patch that lets the experiment follow it.")
    spacing: float = Field(description="Time between two waypoints [s].")
    waypoints: int = Field(description="How many.")
    duration: float = Field(description="From the first row to the last [s].")
    rms: list[float] = Field(description="Effective residual of each joint [rad], or [m].")
    greatest: list[float] = Field(description="Greatest residual of each joint [rad], or [m].")
    limits: list[str] = Field(description="Where it exceeds the arm's limits.")
    remarks: list[str] = Field(description="What else it does.")


class IdentifyRequest(Strict):
    """What is fitted to a log."""

    parts: list[Part] = Field(_PARTS, min_length=1, max_length=5)
    constants: list[Finite] | None = Field(
        None,
        min_length=1,
        max_length=12,
        description="Torque at the joint per current [N·m/A], gear included: one for all, or one "
        "a joint. `null`: the log has torques.",
    )


class LogEstimate(BaseModel):
    """One number that was asked for."""

    path: str = Field(examples=["robot.viscous_friction.2"], description="Joint or axis from 0.")
    title: str
    unit: str
    present: float = Field(description="Its value in the experiment.")
    value: float | None = Field(description="What the log says; `null` where it can't tell.")
    low: float | None = Field(description="Lower end of the 95 % interval.")
    high: float | None = Field(description="Upper end.")
    told: Literal["yes", "given", "no"] = Field(
        description="`given`: as long as what `reason` names is right."
    )
    reason: str


class LogIdentification(BaseModel):
    """What a log says of the arm."""

    estimates: list[LogEstimate]
    patch: dict[str, Any] = Field(description="Merge patch that sets what it tells.")
    rms_torque: list[float] = Field(description="Effective torque of each joint [N·m].")
    rms_residual: list[float] = Field(description="Effective residual of each joint [N·m].")
    bandwidth: float = Field(description="Cutoff of the fit [Hz].")
    remarks: list[str]
    time: list[float] = Field(description="Of the curves [s]; extremes of pieces of time.")
    torque: list[list[float]] = Field(description="Measured below the cutoff, by joint [N·m].")
    residual: list[list[float]] = Field(description="Measured minus fitted, by joint [N·m].")
