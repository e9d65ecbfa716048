"""What stands beside the experiment's JSON Schema where it is published."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

from slidetune.robot.loop.figures import FIGURES, Better, Reduction, Source
from slidetune.server.contract.messages import LawInfo

_MAE = FIGURES["mae"]


class FigureInfo(BaseModel):
    """One figure of a lane: how it is called, written and judged wherever it is shown."""

    name: str = Field(
        examples=[_MAE.name],
        description="Its key in the figures of a run, its accuracy or a margin.",
    )
    title: str = Field(examples=[_MAE.title], description="In words.")
    short: str = Field(examples=[_MAE.short], description="Heading of a column.")
    symbol: str = Field(examples=[_MAE.symbol], description="Empty where the title says it best.")
    unit: str = Field(examples=[_MAE.unit], description="Of the number as it is; empty for none.")
    shown_unit: str = Field(
        examples=[_MAE.shown_unit], description="Of the number as people read it."
    )
    factor: float = Field(examples=[_MAE.factor], description="From `unit` to `shown_unit`.")
    digits: int = Field(description="Significant digits on the screen.")
    per_joint: bool = Field(description="Whether there is one for each joint.")
    reduced: Reduction = Field(description="How those become one.")
    better: Better = Field(description="Which way is better.")
    meaning: str = Field(description="What it is, without a full stop.")
    source: Source = Field(
        description="Where it stands: `run`: the figures of a run; `accuracy`: how good the run "
        "is; `margin`: how a sampled loop stands."
    )
    column: bool = Field(description="Whether the page's tables have a column for it.")
    live: bool = Field(description="Whether the live session measures it while it runs.")
    studied: bool = Field(description="Whether studies tell it, and gains can be judged by it.")


class JointInfo(BaseModel):
    """One joint of an arm."""

    name: str = Field(description="Its name in the description of the arm.", examples=["joint_1"])
    slides: bool = Field(description="Whether it slides: then m and N stand for rad and N·m.")


class ArmInfo(BaseModel):
    """An arm."""

    name: str = Field(description="Value of `model` in the section `robot`.", examples=["jaka_zu5"])
    title: str = Field(description="Name on the screen.", examples=["JAKA Zu 5"])
    meaning: str = Field(description="The arm in one line.")
    joints: list[JointInfo] = Field(description="From base to tip.")


class SchemaAnswer(BaseModel):
    """JSON Schema of an experiment, with what else its readers need to show one."""

    model_config = ConfigDict(extra="allow")

    x_laws: list[LawInfo] = Field(alias="x-laws", description="Every control law.")
    x_figures: list[FigureInfo] = Field(
        alias="x-figures", description="Every figure of a lane, in the order of the tables."
    )
    x_arm: ArmInfo = Field(alias="x-arm", description="The arm of the live document.")
    x_bounds: dict[str, float] = Field(
        alias="x-bounds",
        description="Longest names in characters, and the greatest factor by which deviations are "
        "enlarged.",
    )
