"""From the hand to the curve: what a drag costs, stage by stage: ``python -m tests.browser.drag``.

A server and a Chromium of their own; the hand is Playwright's mouse, 60 moves a second.
"""

from __future__ import annotations

import itertools
import os
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import typer
from playwright.sync_api import Browser, Page, sync_playwright

from tests.browser.chromium import FLAGS, FLAT_FLAGS, find
from tests.browser.conftest import Dashboard, running
from tests.trust.report import provenance, record, table

DRAGS = {
    "c of one lane": ("lanes.RBFNN-NFTSM.c", 3),
    "the disturbance of every lane": ("disturbance.constant", 3),
}
"""What is dragged: its control."""
MOVE_S = 1 / 60
REDRAWS = "redraws a second"
NOTE = """
(() => {
  const notes = window.dragNotes = [];
  const note = (what, more = {}) => notes.push({what, at: performance.now(), ...more});
  addEventListener('input', ({timeStamp}) => notes.push({what: 'input', at: timeStamp}), true);
  const send = WebSocket.prototype.send;
  WebSocket.prototype.send = function (data) {
    if (String(data).includes('"type":"patch"')) note('sent');
    return send.call(this, data);
  };
  const Socket = window.WebSocket;
  window.WebSocket = class extends Socket {
    constructor(...all) {
      super(...all);
      this.addEventListener('message', ({data}) => {
        if (typeof data !== 'string' || !data.startsWith('{"type":"patch"')) return;
        note('told', {revision: JSON.parse(data).revision});
      });
    }
  };
  const ask = window.fetch;
  window.fetch = async (address, options) => {
    if (!String(address).endsWith('/api/preview')) return ask(address, options);
    note('asked');
    const answer = await ask(address, options);
    const read = answer.arrayBuffer.bind(answer);
    answer.arrayBuffer = async () => {
      const bytes = await read();
      const length = new DataView(bytes).getUint32(0, true);
      const head = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
      note('answered', {revision: head.revision, bytes: bytes.byteLength});
      return bytes;
    };
    return answer;
  };
  addEventListener('DOMContentLoaded', () => {
    const status = () => document.querySelector('.response-status')?.dataset.response;
    let tabled = '';
    new MutationObserver((changes) => {
      if (status() !== tabled) { tabled = status(); note('tabled', {revision: Number(tabled)}); }
      if (!changes.some(({target}) => target.closest?.('.response .scatterlayer'))) return;
      const revision = Number(status());
      note('drawn', {revision});
      const {port1, port2} = new MessageChannel();
      port2.onmessage = () => note('painted', {revision});
      requestAnimationFrame(() => port1.postMessage(0));
    }).observe(document, {
      subtree: true, childList: true, attributeFilter: ['d', 'data-response'],
    });
  });
})();
"""
"""Keeps the moment of every stage in the page, from outside of its code."""


def open_page(page: Page, dashboard: Dashboard) -> None:
    """Open the response with its estimate."""
    page.add_init_script(NOTE)
    page.goto(dashboard.url)
    page.locator("[data-view=response]").click()
    page.wait_for_selector(".response-status[data-estimated=true]", timeout=60_000)


def drag(page: Page, path: str, seconds: float) -> list[dict[str, Any]]:
    """Move a slider to and fro; return what the page noted."""
    slider = page.locator(f"[data-path='{path}'] .slider").first
    slider.evaluate("one => { const part = one.closest('details'); if (part) part.open = true; }")
    slider.scroll_into_view_if_needed()
    box = slider.bounding_box()
    assert box is not None
    middle = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + 0.5 * box["width"], middle)
    page.evaluate("window.dragNotes.length = 0")
    page.mouse.down()
    begin = time.perf_counter()
    for move in itertools.count(1):
        passed = time.perf_counter() - begin
        if passed > seconds:
            break
        share = 0.5 + 0.25 * np.sin(2 * np.pi * passed / 4.0)
        page.mouse.move(box["x"] + share * box["width"], middle)
        time.sleep(max(0.0, begin + move * MOVE_S - time.perf_counter()))
    notes: list[dict[str, Any]] = page.evaluate("window.dragNotes")
    page.mouse.up()
    return notes


def busy(browser: Browser) -> float:
    """Return the CPU time of all processes of a Chromium in [s]."""
    session = browser.new_browser_cdp_session()
    processes = session.send("SystemInfo.getProcessInfo")["processInfo"]
    session.detach()
    return float(sum(process["cpuTime"] for process in processes))


def figures(notes: list[dict[str, Any]], seconds: float) -> dict[str, float]:
    """Return redraws a second, the first one's delay, and the median of every stage in [ms]."""
    moments: dict[str, list[dict[str, Any]]] = {}
    for note in notes:
        moments.setdefault(note["what"], []).append(note)

    def after(what: str, at: float) -> float:
        return next((n["at"] for n in moments.get(what, []) if n["at"] >= at), np.nan)

    def median(begin: str, end: str) -> float:
        found = [after(end, n["at"]) - n["at"] for n in moments.get(begin, [])]
        return float(np.nanmedian(found)) if found else float("nan")

    begin = moments["input"][0]["at"]
    first = {n["revision"]: n["at"] for n in reversed(moments["told"])}
    drawn = {n["revision"]: n["at"] for n in reversed(moments["painted"])}
    ages = [drawn[r] - first[r] for r in drawn if r in first]
    changed = [r for r in drawn if r in first]
    shown = {
        REDRAWS: len(changed) / seconds,
        "first move to first redraw": min(drawn[r] for r in changed) - begin,
        "move to patch sent": median("input", "sent"),
        "patch sent to its revision told": median("sent", "told"),
        "revision told to its curve painted": float(np.median(ages)),
        "request of a response to its last byte": median("asked", "answered"),
        "last byte to figures in the table": median("answered", "tabled"),
        "figures to curves drawn": median("tabled", "drawn"),
        "curves drawn to painted": median("drawn", "painted"),
        "painted to painted": float(np.median(np.diff(sorted(drawn.values())))),
        "answer [kB]": float(np.median([n["bytes"] for n in moments["answered"]])) / 1e3,
    }
    return shown


def measured(dashboard: Dashboard, flags: tuple[str, ...], seconds: float) -> dict[str, Any]:
    """Drag in a Chromium of its own; return the figures of each drag."""
    with sync_playwright() as playwright:
        program = str(find())
        browser = playwright.chromium.launch(executable_path=program, args=list(flags))
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        open_page(page, dashboard)
        found = {}
        for name, (path, rounds) in DRAGS.items():
            each = []
            for _ in range(rounds):
                before = busy(browser)
                one = figures(drag(page, path, seconds), seconds)
                spent = 1e3 * (busy(browser) - before) / seconds
                each.append({**one, "CPU of Chromium for each redraw": spent / one[REDRAWS]})
                page.wait_for_timeout(1500)
            found[name] = {key: float(np.median([one[key] for one in each])) for key in each[0]}
        browser.close()
    return found


def main(
    keep: bool = typer.Option(False, "--record", help="Write docs/performance.md."),
    seconds: float = typer.Option(4.0, help="How long each drag lasts."),
    scene: bool = typer.Option(True, help="Draw the 3D scene, in software."),
) -> None:
    """Drag sliders in Chromium and print what each stage costs."""
    columns = {}
    with tempfile.TemporaryDirectory() as folder, running((), Path(folder) / "log.txt") as server:
        columns["no 3D scene"] = measured(server, FLAT_FLAGS, seconds)
        if scene:
            columns["3D scene in software"] = measured(server, FLAGS, seconds)
    headings = ["median [ms], or as it says"]
    headings += [f"{drag}, {where}" for where, found in columns.items() for drag in found]
    every = [found[drag] for found in columns.values() for drag in found]
    rows = [[name, *(f"{one[name]:.3g}" for one in every)] for name in every[0]]
    body = f"{table(headings, rows)}\n\n{provenance('python -m tests.browser.drag --record')}"
    print(body)
    if keep:
        record("performance.md", "drag", body)


if __name__ == "__main__":
    os.environ.setdefault("NO_COLOR", "1")
    typer.run(main)
