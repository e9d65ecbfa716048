"""What every number of an experiment says of itself: symbol, unit, bounds, equation, meaning.

The same record is the documentation, the slider and the validation: ``field`` puts it into the
JSON Schema, and ``Section`` refuses what lies outside it.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, TypedDict

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    PlainSerializer,
    PlainValidator,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from slidetune.robot.fields.plain_values import PlainMapping, UnfitError, plain_values

JOINTS = 6
"""Joints of the shipped arm; a kernel for another one has their number in this one's place."""
MOST_JOINTS = 12
"""Joints of the longest arm (*ours*)."""

Scale = Literal["linear", "log"]
Source = Literal["published", "corrected", "vendor", "inferred", "ours"]


class Fraction(TypedDict):
    """How a field and another one are chosen together, as a fraction.

    Attributes:
        over: name of the field that is the denominator.
        title: the fraction's name in words.
        symbol: its sign.
        pairs: numerators and denominators to offer.
    """

    over: str
    title: str
    symbol: str
    pairs: list[tuple[int, int]]


class Weight(TypedDict):
    """What weights the term of which a field is a part: at 0 the field has no effect.

    Attributes:
        name: name of the field.
        symbol: its sign.
    """

    name: str
    symbol: str


_NUMBER: dict[str, Any] = {"type": "number"}
PER_JOINT = "per_joint"
"""Says of an array in the JSON Schema that it has a number for each joint of the arm."""
_EACH: dict[str, Any] = {
    "type": "array",
    "items": _NUMBER,
    "minItems": 1,
    "maxItems": MOST_JOINTS,
    PER_JOINT: True,
}


def _real(value: object) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _vector(value: object, size: int) -> tuple[float, ...] | None:
    if not isinstance(value, list | tuple) or len(value) != size:
        return None
    numbers = [_real(item) for item in value]
    return None if None in numbers else tuple(number for number in numbers if number is not None)


def _joints(info: ValidationInfo) -> int:
    """Return how many joints the arm of what is validated has: by default the shipped one's."""
    return int((info.context or {}).get("joints", JOINTS))


def _numbers(count: int) -> str:
    return f"a list of {count} numbers" if count > 1 else "a list of one number"


def _per_joint(value: object, info: ValidationInfo) -> float | tuple[float, ...]:
    number = _real(value)
    if number is not None:
        return number
    vector = _vector(value, _joints(info))
    if vector is None:
        raise ValueError(f"must be one number for all joints or {_numbers(_joints(info))}")
    return vector


def _limit(value: object, info: ValidationInfo) -> float | tuple[float, ...] | None:
    return None if value is None else _per_joint(value, info)


def _joint_vector(value: object, info: ValidationInfo) -> tuple[float, ...]:
    vector = _vector(value, _joints(info))
    if vector is None:
        raise ValueError(f"must be {_numbers(_joints(info))}")
    return vector


def _point(value: object) -> tuple[float, ...]:
    vector = _vector(value, 3)
    if vector is None:
        raise ValueError("must be a list of 3 numbers: x, y, z")
    return vector


def _range(value: object) -> tuple[float, ...] | None:
    if value is None:
        return None
    vector = _vector(value, 2)
    if vector is None:
        raise ValueError("must be a list of 2 numbers, the least and the greatest, or null")
    return vector


def _number(value: object) -> float:
    number = _real(value)
    if number is None:
        raise ValueError("must be a number")
    return number


def _integer(value: object) -> int:
    if isinstance(value, float) and value.is_integer():
        return int(value)
    if not isinstance(value, int) or isinstance(value, bool) or abs(value) > 2**53:
        raise ValueError("must be a whole number")
    return value


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def refusal(path: str, value: object, text: str) -> PydanticCustomError:
    """Return the error by which a section refuses a combination of values.

    Args:
        path: the field to blame, relative to the section, dotted.
        value: its value.
        text: what is wrong, what is allowed and the way out.
    """
    context = {"path": path, "value": value, "text": text}
    return PydanticCustomError("combination", "{text}", context)


Number = Annotated[float, PlainValidator(_number), WithJsonSchema(_NUMBER)]
Integer = Annotated[int, PlainValidator(_integer), WithJsonSchema({"type": "integer"})]
PerJoint = Annotated[
    float | tuple[float, ...],
    PlainValidator(_per_joint),
    PlainSerializer(_plain),
    WithJsonSchema({"anyOf": [_NUMBER, _EACH]}),
]
"""One number for all joints, or one a joint."""
PerJointOrOff = Annotated[
    float | tuple[float, ...] | None,
    PlainValidator(_limit),
    PlainSerializer(_plain),
    WithJsonSchema({"anyOf": [_NUMBER, _EACH, {"type": "null"}]}),
]
"""One number for all joints, one a joint, or ``None`` for none at all."""
JointVector = Annotated[
    tuple[float, ...], PlainValidator(_joint_vector), PlainSerializer(_plain), WithJsonSchema(_EACH)
]
Point = Annotated[
    tuple[float, ...],
    PlainValidator(_point),
    PlainSerializer(_plain),
    WithJsonSchema({"type": "array", "items": _NUMBER, "minItems": 3, "maxItems": 3}),
]

Range = Annotated[
    tuple[float, ...] | None,
    PlainValidator(_range),
    PlainSerializer(_plain),
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "array", "items": _NUMBER, "minItems": 2, "maxItems": 2},
                {"type": "null"},
            ]
        }
    ),
]
"""The least and the greatest value, or ``None`` for none at all."""


def field(
    default: Any,
    *,
    title: str,
    meaning: str,
    symbol: str = "",
    unit: str = "",
    low: float | None = None,
    high: float | None = None,
    step: float | None = None,
    scale: Scale = "linear",
    odd: bool = False,
    joint: bool = False,
    fraction: Fraction | None = None,
    equation: str = "",
    group: str = "",
    applies: str = "",
    needs: dict[str, tuple[str, ...]] | None = None,
    weight: Weight | None = None,
    usual: tuple[float, ...] | None = None,
    source: Source = "ours",
) -> Any:
    """Describe one value of an experiment, once, for the schema, the slider and the validation.

    Args:
        default: value when none is given.
        title: name in words.
        meaning: one sentence: what it does.
        symbol: sign in the paper or in the field.
        unit: unit in text, empty for none.
        low: least permitted value.
        high: greatest permitted value.
        step: step of the slider and of the arrow keys.
        scale: whether a slider runs linearly or logarithmically.
        odd: whether only odd whole numbers are permitted.
        joint: whether it is the number of a joint, which ends where the arm does.
        fraction: the fraction of which this is the numerator.
        equation: where it stands, such as ``Eq. 5``.
        group: heading under which the screen shows it.
        applies: the simulation mode in which it acts, empty for both.
        needs: by the name of a choice in the same section, the options under which it acts; it
            has no effect under the others.
        weight: the field in the same section that weights the term of which this is a part.
        usual: value that a field is switched on with, where it is off by default.
        source: where the default comes from.

    Returns:
        A pydantic field.
    """
    extra: dict[str, Any] = {
        "symbol": symbol,
        "unit": unit,
        "step": step,
        "scale": scale,
        "odd": odd or None,
        "joint": joint or None,
        "fraction": fraction,
        "equation": equation,
        "group": group,
        "applies": applies,
        "needs": needs,
        "weight": weight,
        "usual": usual,
        "source": source,
        "minimum": low,
        "maximum": high,
    }
    kept = {key: value for key, value in extra.items() if value not in (None, "")}
    return Field(default, title=title, description=meaning, json_schema_extra=kept)


def bounds(section: type[BaseModel], name: str) -> tuple[float, float]:
    """Return the least and the greatest value that a numeric field permits."""
    extra: Any = section.model_fields[name].json_schema_extra
    return float(extra["minimum"]), float(extra["maximum"])


def allowed_text(extra: dict[str, Any]) -> str:
    """Say in words what a field permits, from its schema record."""
    unit = f" {extra['unit']}" if extra.get("unit") else ""
    low, high = extra.get("minimum"), extra.get("maximum")
    bounds = f"[{low:g}, {high:g}]{unit}" if low is not None and high is not None else ""
    return f"{bounds}, odd whole numbers only" if extra.get("odd") else bounds


class Section(BaseModel):
    """A frozen part of an experiment; refuses unknown keys and values outside their bounds."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)

    @model_validator(mode="before")
    @classmethod
    def _fit(cls, values: Any) -> Any:
        if isinstance(values, BaseModel | PlainMapping):
            return values
        try:
            return plain_values(values)
        except UnfitError as error:
            raise refusal(error.path, None, str(error)) from error

    @field_validator("*", mode="after")
    @classmethod
    def _within_bounds(cls, value: Any, info: ValidationInfo) -> Any:
        extra = cls.model_fields[info.field_name or ""].json_schema_extra
        if not isinstance(extra, dict) or "minimum" not in extra or value is None:
            return value
        if extra.get("joint"):
            extra = {**extra, "maximum": _joints(info)}
        low, high = float(extra["minimum"]), float(extra["maximum"])  # type: ignore[arg-type]
        for number in value if isinstance(value, tuple) else (value,):
            if not low <= number <= high or (extra.get("odd") and number % 2 != 1):
                raise ValueError(f"must be in {allowed_text(extra)}, got {number:.12g}")
        return value
