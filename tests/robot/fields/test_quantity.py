"""What the fields of an experiment say of themselves, and what they refuse."""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Iterator
from typing import Any, get_args

import pytest
from pydantic import ValidationError
from pydantic.fields import FieldInfo

from slidetune.robot.arm import section as robot
from slidetune.robot.environment import disturbance
from slidetune.robot.experiment import simulation
from slidetune.robot.fields.quantity import JOINTS, MOST_JOINTS, Section, allowed_text
from slidetune.robot.laws import LAWS
from slidetune.robot.laws.terms.network import NetworkGains
from slidetune.robot.laws.terms.surface import LinearSurface, NftsmSurface
from slidetune.robot.laws.terms.switching import ReachingGains
from slidetune.robot.motion import trajectory

# Ratios, counts and weights: pure numbers, so that they have no unit.
WITHOUT_UNIT = {
    "inertia_scale",
    "nominal_mismatch",
    "alpha",
    "c",
    "mu",
    "p",
    "k",
    "plant_substeps",
    "seed",
}
TAGS = {"law", "kind", "slidetune"}


def sections() -> list[type[Section]]:
    found = [law.lane for law in LAWS.values()]
    for module in (robot, simulation, disturbance, trajectory):
        for _, kind in inspect.getmembers(module, inspect.isclass):
            if issubclass(kind, Section) and kind.__module__ == module.__name__:
                found.append(kind)
    return found


def fields() -> Iterator[tuple[type[Section], str, FieldInfo]]:
    for section in sections():
        for name, info in section.model_fields.items():
            yield section, name, info


def is_section(info: FieldInfo) -> bool:
    kinds = get_args(info.annotation) or (info.annotation,)
    return all(isinstance(kind, type) and issubclass(kind, Section) for kind in kinds)


def is_number(info: FieldInfo) -> bool:
    kinds = {info.annotation, *get_args(info.annotation)}
    return bool(kinds & {float, int}) or any(float in get_args(kind) for kind in kinds)


FIELDS = [(s, n, i) for s, n, i in fields() if n not in TAGS and not is_section(i)]
NUMBERS = [(s, n, i) for s, n, i in FIELDS if is_number(i)]
IDS = [f"{section.__name__}.{name}" for section, name, _ in NUMBERS]


def extra(info: FieldInfo) -> dict[str, Any]:
    assert isinstance(info.json_schema_extra, dict)
    return info.json_schema_extra


def vary(info: FieldInfo, number: float) -> Any:
    """Give ``number`` the shape that a field wants."""
    if isinstance(info.default, tuple):
        return [number, *info.default[1:]]
    return int(number) if info.annotation is int else number


def refused(section: type[Section], **values: Any) -> str:
    with pytest.raises(ValidationError) as caught:
        section(**values)
    return str(caught.value)


def test_all_numbers_of_the_document_are_looked_at() -> None:
    assert len(NUMBERS) > 60
    assert {"k1", "nu", "step", "torque_limit", "seed", "radius"} <= {
        name for _, name, _ in NUMBERS
    }


@pytest.mark.parametrize(("section", "name", "info"), NUMBERS, ids=IDS)
def test_every_number_says_what_it_is(section: type[Section], name: str, info: FieldInfo) -> None:
    record = extra(info)
    assert info.title
    assert info.title[0].isupper()
    assert info.description
    assert info.description.endswith(".")
    assert {"minimum", "maximum", "step", "scale", "source"} <= set(record)
    assert bool(record.get("unit")) != (name in WITHOUT_UNIT)


@pytest.mark.parametrize(("section", "name", "info"), NUMBERS, ids=IDS)
def test_every_number_has_bounds_that_make_a_slider(
    section: type[Section], name: str, info: FieldInfo
) -> None:
    record = extra(info)
    low, high, step = record["minimum"], record["maximum"], record["step"]
    assert low < high
    assert 0.0 < step <= high - low
    if record["scale"] == "log":
        assert low > 0.0
    defaults = info.default if isinstance(info.default, tuple) else (info.default,)
    assert all(value is None or low <= value <= high for value in defaults)


@pytest.mark.parametrize(
    ("section", "name", "info"), FIELDS, ids=[f"{s.__name__}.{n}" for s, n, _ in FIELDS]
)
def test_every_field_has_a_title_and_a_meaning(
    section: type[Section], name: str, info: FieldInfo
) -> None:
    assert info.title
    assert info.description


@pytest.mark.parametrize(("section", "name", "info"), NUMBERS, ids=IDS)
def test_a_number_outside_its_bounds_is_refused_with_value_bounds_and_unit(
    section: type[Section], name: str, info: FieldInfo
) -> None:
    record = extra(info)
    low, high = record["minimum"], record["maximum"]
    for value in (low - 1.0, high + (2.0 if record.get("odd") else 1.0)):
        text = refused(section, **{name: vary(info, value)})
        assert f"must be in [{low:g}, {high:g}]" in text
        assert f"got {value:.12g}" in text
        assert record.get("unit", "") in text


@pytest.mark.parametrize(("section", "name", "info"), NUMBERS, ids=IDS)
def test_a_number_that_is_none_is_refused(
    section: type[Section], name: str, info: FieldInfo
) -> None:
    for value in (math.nan, math.inf, -math.inf):
        if info.annotation is not int:
            assert "must be in" in refused(section, **{name: vary(info, value)})
    for value in (True, "1", [], {}, [1.0, 2.0], b"1", 1j):
        assert re.search("must be (a|one) ", refused(section, **{name: value}))


@pytest.mark.parametrize(("section", "name", "info"), NUMBERS, ids=IDS)
def test_only_a_limit_can_be_off(section: type[Section], name: str, info: FieldInfo) -> None:
    if name == "torque_limit":
        assert section(**{name: None}).torque_limit is None
    else:
        assert re.search("must be (a|one) ", refused(section, **{name: None}))


@pytest.mark.parametrize("name", ["nu", "c", "mu"])
@pytest.mark.parametrize("joint", range(JOINTS))
def test_one_bad_joint_is_found(name: str, joint: int) -> None:
    values = [0.5] * JOINTS
    values[joint] = 1234.5
    assert "got 1234.5" in refused(NftsmSurface, **{name: values})


@pytest.mark.parametrize("name", ["k1", "k2", "epsilon"])
def test_bounds_themselves_are_allowed(name: str) -> None:
    record = extra(ReachingGains.model_fields[name])
    for bound in (record["minimum"], record["maximum"]):
        assert getattr(ReachingGains(**{name: bound}), name) == bound
        assert getattr(ReachingGains(**{name: [bound] * JOINTS}), name) == (bound,) * JOINTS


@pytest.mark.parametrize("value", [2, 4.0, 5.5, 0, 100])
def test_only_odd_whole_numbers_make_an_exponent(value: float) -> None:
    assert "odd whole numbers only" in refused(NftsmSurface, p=value)


@pytest.mark.parametrize(("p", "k"), [(3, 3), (5, 5), (7, 3), (9, 3), (3, 5)])
def test_exponent_outside_one_to_two_is_refused_with_its_value(p: int, k: int) -> None:
    text = refused(NftsmSurface, p=p, k=k)
    assert "p/k must lie between 1 and 2" in text
    assert f"got {p / k:.3g}" in text
    assert "p and its denominator k together" in text


def test_exponent_is_judged_joint_by_joint() -> None:
    good = NftsmSurface(p=[5, 7, 9, 5, 7, 9], k=[3, 5, 7, 3, 5, 7])
    assert good.pack_surface()[3].tolist() == pytest.approx([5 / 3, 7 / 5, 9 / 7] * 2)
    assert "p/k" in refused(NftsmSurface, p=[5, 5, 5, 5, 5, 7], k=3)


@pytest.mark.parametrize("value", [0.5, -1, 2**31, "1", 1.5, None, True])
def test_seed_is_a_whole_number(value: object) -> None:
    refused(disturbance.Disturbance, seed=value)


def test_whole_number_may_be_written_as_a_float() -> None:
    assert disturbance.Disturbance(seed=7.0).seed == 7


@pytest.mark.parametrize("section", sections(), ids=lambda section: section.__name__)
def test_sections_are_frozen(section: type[Section]) -> None:
    value = section()
    name = next(iter(section.model_fields))
    with pytest.raises(ValidationError, match="frozen"):
        setattr(value, name, getattr(value, name))


@pytest.mark.parametrize("section", sections(), ids=lambda section: section.__name__)
def test_sections_refuse_what_they_do_not_know(section: type[Section]) -> None:
    assert "extra_forbidden" in refused(section, surely_not_a_field=1)


def test_schema_carries_the_record_of_a_gain() -> None:
    gain = ReachingGains.model_json_schema()["properties"]["k1"]
    assert gain["title"] == "Proportional reaching gain"
    assert (gain["unit"], gain["minimum"], gain["maximum"]) == ("N·m·s/rad", 0.0, 1000.0)
    kinds = [choice["type"] for choice in gain["anyOf"]]
    assert kinds == ["number", "array"]
    assert (gain["anyOf"][1]["minItems"], gain["anyOf"][1]["maxItems"]) == (1, MOST_JOINTS)


def test_allowed_values_in_words() -> None:
    record = extra(NftsmSurface.model_fields["p"])
    assert allowed_text(record) == "[1, 99], odd whole numbers only"
    assert allowed_text(extra(LinearSurface.model_fields["lambda_"])) == "[0.01, 100] 1/s"
    assert allowed_text(extra(NetworkGains.model_fields["network_input"])) == ""
