"""The gains of any law as a type of pydantic's: which laws there are may change at any time."""

from __future__ import annotations

from functools import lru_cache, reduce
from operator import or_
from typing import Annotated, Any

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, TypeAdapter
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from slidetune.robot.fields.quantity import Section
from slidetune.robot.fields.refusal import Variants
from slidetune.robot.laws import LAWS


@lru_cache(maxsize=2)
def _union(lanes: tuple[type[Section], ...]) -> TypeAdapter[Section]:
    union: Any = Annotated[reduce(or_, lanes), Field(discriminator="law")]
    return TypeAdapter(union)


def _present() -> TypeAdapter[Section]:
    """Return the gains of the laws that there are now."""
    return _union(AnyLane.variants())


class AnyLane(Variants):
    """Law and gains of a lane: in JSON Schema a union of all laws, told apart by ``law``."""

    @classmethod
    def variants(cls) -> tuple[type[Section], ...]:
        """Return the gains' models of all laws that there are now."""
        return tuple(law.lane for law in LAWS.values())

    @classmethod
    def __get_pydantic_core_schema__(cls, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        """Validate by the laws that there are when it is asked."""
        return core_schema.with_info_plain_validator_function(
            lambda value, info: _present().validate_python(value, context=info.context)
        )

    @classmethod
    def __get_pydantic_json_schema__(
        cls, _: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Describe the laws that there are when it is asked."""
        return handler(_present().core_schema)
