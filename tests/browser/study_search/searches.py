"""A short search on a real dashboard, and its result mounted alone on the page."""

from __future__ import annotations

import time
from typing import Any

from playwright.sync_api import Page, expect

from tests.browser.conftest import Dashboard
from tests.browser.lenses.test_lenses import patch

LANE = "RBFNN-NFTSM"
GOALS = {
    "near": {"kind": "response", "channel": "e", "start": 0.5, "bound": 0.005},
    "quiet": {"kind": "figure", "figure": "chattering", "bound": 200},
}
HARD = {"strong": {"kind": "response", "channel": "tau", "bound": 400, "priority": "hard"}}
GAINS = {"nu": {"low": 1, "high": 100}, "c": {"low": 0.5, "high": 50}}
DEADLINE = 120.0

MOUNT = """async ([number, count]) => {
  const load = (path) => import(`/static/${path}`);
  const [{Api}, {History}, {mountNotices}, {SearchResult}, studies] = await Promise.all([
    'api/api.js', 'api/undo.js', 'dom/notices.js', 'study_search/search_result.js',
    'api/requests/studies.js'].map(load));
  const api = new Api();
  api.connect();
  await new Promise((done) => api.addEventListener('hello', done, {once: true}));
  const history = new History(api);
  const place = document.createElement('div');
  place.className = 'harness';
  place.style = 'position: fixed; inset: 0; z-index: 20; overflow: auto;'
    + 'background: var(--surface)';
  document.body.append(place);
  const notices = document.createElement('div');
  document.body.append(notices);
  const result = new SearchResult(api, {history, tell: mountNotices(notices)});
  place.append(result.element);
  const study = await studies.oneStudy(number);
  const entries = await new Promise((done) => {
    const all = [];
    studies.followStudy(number, (summary, news) => {
      all.push(...news);
      if (all.length === study.total) done(all);
    }, () => {});
  });
  result.update(study, entries.slice(0, count ?? entries.length));
  Object.assign(window, {harness: {api, history, result, study, entries}});
}"""


def searched(dashboard: Dashboard, goals: dict[str, Any], **wanted: Any) -> dict[str, Any]:
    """Search, and return the study with its entries once it has ended."""
    patch(dashboard, {"goals": goals, "simulation": {"horizon": 2.0}})
    told = {"lane": LANE, "trials": 32, "gains": GAINS, "quiet": False, **wanted}
    made = dashboard.client.post("api/studies", json={"kind": "tune", "wanted": told})
    made.raise_for_status()
    number = made.json()["id"]
    end = time.monotonic() + DEADLINE
    while (study := dashboard.client.get(f"api/studies/{number}").json())["state"] != "done":
        assert time.monotonic() < end, study
        assert study["state"] in ("waiting", "running"), study
        time.sleep(0.1)
    entries = dashboard.client.get(f"api/studies/{number}/entries").json()["entries"]
    return {**study, "entries": entries}


def mounted(
    page: Page, dashboard: Dashboard, study: dict[str, Any], count: int | None = None
) -> None:
    """Open the page with the result of a search over it."""
    page.goto(dashboard.url)
    expect(page.locator("#header")).to_contain_text("live")
    page.evaluate(MOUNT, [study["id"], count])
    expect(page.locator(".search-words")).not_to_be_empty()
