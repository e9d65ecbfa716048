"""The generated reference has everything that there is."""

from __future__ import annotations

import asyncio
import inspect
import re
from typing import Any

import pytest

import slidetune
from docs.site.command_page import commands, shown_parameters
from docs.site.field_pages import SECTIONS, fields_of, schema, section_paths
from docs.site.http_pages import operations
from docs.site.live_page import messages
from docs.site.own_documents import own_documents
from docs.site.python_page import ERRORS, RETURNED
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.laws import SHIPPED
from tests.docs.built import Html


@pytest.fixture(scope="module")
def documents() -> tuple[dict[str, Any], dict[str, Any]]:
    """OpenAPI and AsyncAPI of the application."""
    return asyncio.run(own_documents())


def test_every_command_with_every_option_is_there(built: dict[str, Html]) -> None:
    page = built["reference/commands.html"]
    listed = dict(commands())
    assert {"slidetune serve", "slidetune run", "slidetune tune", "slidetune arm add"} <= set(
        listed
    )
    for words, command in listed.items():
        assert words.replace(" ", "-") in page.ids
        for one in shown_parameters(command):
            names = one.opts if one.param_type_name == "option" else [one.name.upper()]
            assert [name for name in names if name not in page.text] == [], words


def test_every_route_is_there(
    built: dict[str, Html], documents: tuple[dict[str, Any], dict[str, Any]]
) -> None:
    openapi = documents[0]
    page = built["reference/http.html"]
    routes = [f"{method} {path}" for method, path, _ in operations(openapi)]
    assert len(routes) == sum(len(methods) for methods in openapi["paths"].values())
    assert [route for route in routes if route not in page.text] == []
    models = built["reference/http-messages.html"]
    assert {name.lower() for name in openapi["components"]["schemas"]} <= models.ids


def test_every_message_of_the_live_websocket_is_there(
    built: dict[str, Html], documents: tuple[dict[str, Any], dict[str, Any]]
) -> None:
    asyncapi = documents[1]
    page = built["reference/websocket.html"]
    names = [name for way in ("receive", "send") for name, _, _ in messages(asyncapi, way)]
    assert len(names) == len(asyncapi["components"]["messages"])
    assert {"patch", "hello", "telemetry"} <= set(names)
    assert [name for name in names if name not in page.ids] == []


def leaves(value: Any, path: str) -> set[str]:
    """Return the paths of all values of a document, those of lists and of nothing included."""
    if isinstance(value, dict) and value:
        return {one for key, inner in value.items() for one in leaves(inner, f"{path}.{key}")}
    return {path}


def test_every_field_of_an_experiment_is_there(built: dict[str, Html]) -> None:
    whole = schema()
    page = built["reference/experiment.html"]
    for name in SECTIONS:
        for model, path, _ in section_paths(name, whole):
            assert {key for key, _ in fields_of(model, path, whole)} <= page.ids, path
    # What an experiment has by default, told by the experiment and not by its schema.
    document = Experiment().document()
    for name in ("robot", "disturbance", "simulation", "uncertainty"):
        assert leaves(document[name], name) <= page.ids
    assert leaves(document["trajectory"], "trajectory.sine") <= page.ids
    assert {"title", "description", "slidetune"} <= page.ids


def test_every_gain_of_every_law_is_there(built: dict[str, Html]) -> None:
    page = built["reference/gains.html"]
    for law in SHIPPED:
        lane = Experiment.from_document({"lanes": {"A": {"law": law}}}).document()["lanes"]["A"]
        missing = {f"lanes.{law}.{name}" for name in lane} - page.ids
        assert missing == set()


def test_the_public_face_is_there_with_what_it_returns(built: dict[str, Html]) -> None:
    page = built["reference/python.html"]
    public = [name for name in slidetune.__all__ if not name.startswith("_")]
    assert {f"slidetune.{name}" for name in public} <= page.ids
    assert {*RETURNED, *ERRORS} <= page.ids
    for name in public:
        public_one = getattr(slidetune, name)
        words = " ".join((inspect.getdoc(public_one) or "").split("\n\n")[0].split())
        assert words.replace("``", "") in " ".join(page.text.split()), name
    methods = re.findall(r"slidetune\.server\.client\.dashboard\.Dashboard\.(\w+)", str(page.ids))
    assert {"patch", "record", "preview", "telemetry"} <= set(methods)


def test_no_page_of_the_reference_shows_raw_markup(built: dict[str, Html]) -> None:
    for name, page in built.items():
        if name.startswith("reference/"):
            assert not re.search(r":math:|\.\. math::|:::|\*\*[^*\n]+\*\*|<a id", page.text), name
