"""The tables of the page are made of the figures that the schema publishes."""

from __future__ import annotations

import re
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, Request, Route, expect

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.loop.figures import FIGURES, Figure
from tests.browser.conftest import Complaints, Dashboard

SCHEMA = "**/api/schema"
COLUMNS = [figure for figure in FIGURES.values() if figure.column]


def heading(figure: Figure, joint: int | None = None) -> str:
    """Return what stands over a column of the page."""
    if figure.source == "margin":
        return f"{figure.short} / {FIGURES['gamma_limit'].short}"
    place = "" if joint is None else f" J{joint}"
    return f"{figure.short}{place} {figure.shown_unit}"


def headings(joints: int, source: tuple[str, ...]) -> list[str]:
    """Return what stands over the columns of some sources, of so many joints' mean errors."""
    found = []
    for figure in (each for each in COLUMNS if each.source in source):
        each_joint = range(1, joints + 1) if figure.reduced == "mean" else [None]
        found += [heading(figure, joint) for joint in each_joint]
    return found


def heads(table: Locator) -> Locator:
    return table.locator("thead th")


@pytest.fixture
def screen(dashboard: Dashboard, page: Page) -> Page:
    """A page, not opened yet, of short runs."""
    change = {"simulation": {"horizon": 1.0}}
    dashboard.client.patch("/api/experiment", json=change).raise_for_status()
    return page


def test_every_figure_with_a_column_stands_in_both_tables_under_its_heading(
    screen: Page, dashboard: Dashboard
) -> None:
    asked: list[Request] = []

    def note(request: Request) -> None:
        if request.url.endswith("/api/schema"):
            asked.append(request)

    screen.on("request", note)
    screen.goto(dashboard.url)
    live = heads(screen.locator("#metrics"))
    expect(live).to_have_text(["lane", *headings(JOINTS, ("run", "margin")), "notes"])
    unmeasured = screen.locator(
        "#metrics td.metrics-itae, #metrics td.metrics-high_frequency_torque"
    )
    expect(unmeasured).to_have_text(["–"] * 6)
    expect(unmeasured.first).to_have_attribute("title", FIGURES["high_frequency_torque"].not_live)
    expect(unmeasured.first).to_be_hidden()
    screen.get_by_label("all columns").check()
    expect(unmeasured.first).to_be_visible()
    screen.get_by_label("all columns").uncheck()
    for figure in COLUMNS:
        titles = live.evaluate_all("(all) => all.map((one) => one.title)")
        assert any(title.startswith(figure.meaning) for title in titles), figure.name
    screen.locator("[data-view=response]").click()
    estimate = FIGURES["error_estimate"]
    expect(heads(screen.locator(".response-table"))).to_have_text(
        [
            "Whole response 0 to 1 s",
            f"{estimate.short} {estimate.shown_unit}",
            *headings(3, ("run",)),
        ]
    )
    dashboard.client.patch("/api/experiment", json={"simulation": {"high_frequency": 500}})
    torque = screen.locator(".response-table .metrics-high_frequency_torque")
    expect(torque).to_have_text(["–"] * 3)
    expect(torque.first).to_have_attribute("title", FIGURES["high_frequency_torque"].unknown)
    expect(screen.locator(".response-table .metrics-switches").first).to_have_text(
        re.compile(r"^\d")
    )
    offered = [f"by {figure.title}" for figure in FIGURES.values() if figure.studied]
    expect(screen.locator(".study-metric option")).to_have_text(offered)
    # The page is built of it: it is asked for at once, and not again by what needs it later.
    assert len(asked) == 1
    screen.remove_listener("request", note)


def test_another_entry_is_another_column_without_a_line_of_script(
    screen: Page, dashboard: Dashboard
) -> None:
    def with_another_column(route: Route) -> None:
        answer = route.fetch()
        schema: dict[str, Any] = answer.json()
        for entry in schema["x-figures"]:
            if entry["name"] == "flange_max":
                entry |= {"column": True, "studied": True, "digits": 2, "title": "way off"}
                entry |= {"factor": 1e6, "shown_unit": "µm", "short": "off", "meaning": "How far"}
        route.fulfill(response=answer, json=schema)

    screen.route(SCHEMA, with_another_column)
    screen.goto(dashboard.url)
    for table in ("#metrics", ".response-table"):
        if table != "#metrics":
            screen.locator("[data-view=response]").click()
        head = heads(screen.locator(table)).filter(has_text=re.compile(r"^off µm$"))
        expect(head).to_have_attribute("title", "How far.")
        cells = screen.locator(f"{table} tbody .metrics-flange_max")
        # Micrometres of some millimetres, by two digits.
        expect(cells.first).to_have_text(re.compile(r"^[1-9]\d0+$"))
        expect(cells).to_have_count(3)
    expect(screen.locator(".study-metric option").last).to_have_text("by way off")
    screen.unroute(SCHEMA)


def test_a_busy_server_is_asked_for_the_schema_again(
    screen: Page, dashboard: Dashboard, complaints: Complaints
) -> None:
    complaints.allow("status of 503")
    refused: list[str] = []

    def refuse_once(route: Route) -> None:
        if refused:
            route.fallback()
            return
        refused.append(route.request.url)
        error = {"error": {"code": "busy", "message": "ask again", "fields": []}}
        route.fulfill(status=503, json=error)

    screen.route(SCHEMA, refuse_once)
    screen.goto(dashboard.url)
    expect(heads(screen.locator("#metrics")).nth(1)).to_have_text(heading(FIGURES["mae"], 1))
    expect(screen.locator(".control").first).to_be_visible()
    screen.unroute(SCHEMA)


def test_a_change_and_the_best_are_judged_by_which_way_is_better(
    screen: Page, dashboard: Dashboard
) -> None:
    screen.goto(dashboard.url)
    judged = screen.evaluate(
        """async () => {
          const [{changeOf}, {best}] = await Promise.all([
            import('/static/figures/change.js'), import('/static/figures/columns.js')]);
          const column = (better) => ({figure: {better, digits: 2}});
          return ['less', 'more', 'none'].map((better) => [
            changeOf(2, 1, better).text, changeOf(2, 5, better).text,
            changeOf(2, 5, better).kind, best(column(better), [1.234, null, 5])]);
        }"""
    )
    assert judged == [
        ["▼ 50 % better", "▲ 2.5× worse", "worse", "1.2"],
        ["▼ 50 % worse", "▲ 2.5× better", "better", "5.0"],
        ["▼ 50 %", "▲ 2.5×", "none", None],
    ]
