"""axe-core, looking at a page as it stands in light and in dark."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import axe_playwright_python
from playwright.sync_api import Page, expect

AXE = Path(axe_playwright_python.__file__).parent / "axe.min.js"
RULES: dict[Any, list[str] | None] = {"light": None, "dark": ["color-contrast"]}
"""By theme: every rule, then the one that a theme can break."""
DRAWN = """() => new Promise((done) => {
  requestAnimationFrame(() => requestAnimationFrame(() => done(null)));
})"""
"""Waits until the page is drawn in the colours of another theme."""
FOREIGN = ["iframe", ".js-plotly-plot .main-svg", ".swagger-ui"]
"""Left out: Viser's page in its frame, what Plotly draws (every plot's figures stand in a table or
a readout of ours as well), and Swagger UI's page. None of them is ours to mend."""
LOOK = """async ([include, foreign, rules]) => {
  const context = {include: [include], exclude: foreign};
  const only = rules && {type: 'rule', values: rules};
  const options = {iframes: false, resultTypes: ['violations'], ...(only && {runOnly: only})};
  const {violations} = await axe.run(context, options);
  return violations.flatMap(({id, impact, nodes}) => nodes.map((node) => (
    {id, impact, node: node.html.slice(0, 200), why: node.failureSummary})));
}"""


class Inspector:
    """Looks at a page, view by view, and keeps what is serious."""

    def __init__(self, page: Page) -> None:
        self._page = page
        self.found: list[str] = []

    def start(self) -> None:
        """Bring axe-core into the page, which must have been opened."""
        self._page.evaluate(AXE.read_text(encoding="utf-8"))

    def themes(self) -> Iterator[str]:
        """Put the page into light, then into dark."""
        for theme in RULES:
            # Reduced motion: a colour on its way from one theme to the other would be nobody's.
            self._page.emulate_media(color_scheme=theme, reduced_motion="reduce")
            yield theme

    def look(self, view: str, part: str = "body") -> None:
        """Look at a part of the page as it stands, in both themes."""
        for theme in self.themes():
            self.look_once(view, part, theme)

    def look_once(self, view: str, part: str, theme: str) -> None:
        """Look at a part of the page in the theme that it is in."""
        expect(self._page.locator(part).first).to_be_visible()
        self._page.evaluate(DRAWN)
        findings: list[dict[str, Any]] = self._page.evaluate(LOOK, [part, FOREIGN, RULES[theme]])
        self.found += [
            f"{view}, {theme}: {one['id']} at {one['node']}: {one['why']}"
            for one in findings
            if one["impact"] in ("serious", "critical")
        ]
