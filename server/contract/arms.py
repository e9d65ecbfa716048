"""What is said of arms over HTTP."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, Field


class ArmSummary(BaseModel):
    """One arm in the list."""

    name: str = Field(description="Value of `model` in the section `robot`.", examples=["jaka_zu5"])
    title: str = Field(description="Name on the screen.")
    meaning: str = Field(description="The arm in one line.")
    joints: int = Field(description="How many it has; 0 where it is damaged.")
    shipped: bool = Field(description="Whether it ships with Slidetune.")
    problem: str = Field("", description="Why it can't be used.")


class ArmList(BaseModel):
    """All arms."""

    arms: list[ArmSummary] = Field(description="Those that ship first.")
    live: str = Field(description="Name of the arm of the live experiment.")


class FirstLane(BaseModel):
    """A lane for the live arm."""

    lane: dict[str, Any] = Field(
        description="A law and gains of the live arm's size, for a patch; of the shipped arm the "
        "law alone, whose defaults are for it."
    )


class ArmFinding(BaseModel):
    """What the doctor says about one element of the description."""

    kind: Literal["refused", "assumed", "noted"] = Field(
        description="`refused`: the arm can't be loaded. `assumed`: it can, with what is said in "
        "the place of what is missing. `noted`: it can, and this deserves a look."
    )
    where: str = Field(examples=["joint elbow"])
    line: int | None = Field(description="Line of the element in the file.")
    text: str = Field(description="What is wrong, the value and what is allowed.")
    remedy: str = Field(description="A way out.")


class ArmReport(BaseModel):
    """What the doctor says of a description, and the name that its arm is kept by."""

    name: str = Field(
        description="Value of `model` in the section `robot`; empty where the arm is refused."
    )
    robot: str = Field(description="Name of the robot in the file.")
    summary: str = Field(description="One sentence.")
    tip: str = Field(description="The link that is its flange.")
    joints: list[str] = Field(description="From base to tip.")
    held: list[str] = Field(description="Joints that are held at their neutral place.")
    findings: list[ArmFinding] = Field(description="The refused ones first.")
