"""A whole run as one HTML file that needs no network: what was run, what came out, a replay."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from slidetune.robot.arm.known import arm_named
from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from slidetune.robot.loop.simulate import Run
from slidetune.server.report.figure_page import (
    BUCKETS,
    Additions,
    figure_page,
    html_paragraphs,
    html_table,
    in_script,
)
from slidetune.server.report.run_figures import run_sections
from slidetune.server.report.run_report import Document, json_text, span_text
from slidetune.server.run_report.apart import RecordingError
from slidetune.server.run_report.described import difference_rows, gain_rows
from slidetune.server.run_report.outcome import advice_items, figure_tables, goal_table, lane_items
from slidetune.server.run_report.recording import Film, film_of
from slidetune.server.run_report.repeating import Repeating, repeating, versions
from slidetune.server.run_report.replay_part import replay_part, replay_scripts

POLICY = (
    "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval'; "
    "style-src 'unsafe-inline'; img-src data: blob:; connect-src data: blob:; font-src data:; "
    "worker-src blob:; base-uri 'none'; form-action 'none'"
)
"""What the page's browser lets it do. The replay, a page within it, is held to it as well: it
unpacks its pictures with WebAssembly, and reads what it holds itself as data and blobs."""

_STYLE = Path(__file__).with_name("run_report.css")
_SCRIPT = Path(__file__).with_name("run_report.js")
_PARTS = (
    ("experiment", "Experiment"),
    ("goals", "Goals"),
    ("figures", "Figures"),
    ("replay", "Replay"),
    ("advice", "Advice"),
    ("plots", "Plots"),
    ("repeat", "Repeat it"),
    ("yaml", "YAML"),
)


@dataclass(frozen=True)
class RunReport:
    """A report that is ready to be written.

    Attributes:
        html: the file.
        rate: pictures a second of its replay in [1/s], 0 where it has none.
    """

    html: str
    rate: float


def run_report(
    run: Run, document: Document, record: Callable[[Film], bytes], arm: Sequence[str] = ()
) -> RunReport:
    """Return the report of a run.

    Args:
        run: the run.
        document: its figures, as ``server.report.run_report.report`` returns them.
        record: makes the recording of the replay. Where it can't, the report is whole but for that,
            and says why.
        arm: the options that named the arm on the command line.
    """
    film = film_of(run)
    try:
        recording, missing = record(film), ""
    except (RecordingError, OSError) as error:
        recording, missing = b"", str(error)
    again = repeating(run.experiment, document["since"], arm)
    body = "".join(
        [
            _lead(run, document),
            _contents(),
            _part("experiment", _experiment(run, again)),
            _part("goals", goal_table(run)),
            _part("figures", _figures(run, document)),
            _part("replay", replay_part(run, film, missing)),
            _part("advice", advice_items(document)),
            _part("plots", html_paragraphs([_PLOTS])),
        ]
    )
    tail = _part("repeat", _repeat(run, again)) + _part("yaml", _yaml(run))
    scripts = (
        f'<script type="application/json" id="report">{in_script(json_text(document))}</script>\n'
        f"{replay_scripts(recording)}<script>{_SCRIPT.read_text(encoding='utf-8')}</script>\n"
    )
    additions = Additions(tail, _STYLE.read_text(encoding="utf-8"), scripts, POLICY)
    title = run.experiment.title or "Untitled experiment"
    html = figure_page(title, body, run_sections(run), additions)
    return RunReport(html, film.rate if recording else 0.0)


_PLOTS = (
    f"Curves are thinned out: of each of {BUCKETS} spans of time a curve keeps its least and its "
    "greatest value, so that peaks and chattering are there and what lies between is not. The "
    "figures above are computed from every row. A curve ends where its lane left its bounds."
)


def _part(name: str, content: str) -> str:
    return f'<h2 id="part-{name}">{escape(dict(_PARTS)[name])}</h2>\n{content}'


def _contents() -> str:
    links = (f'<a href="#part-{name}">{escape(title)}</a>' for name, title in _PARTS)
    return f'<nav aria-label="Parts of this report">{" ".join(links)}</nav>\n'


def _lead(run: Run, document: Document) -> str:
    experiment = run.experiment
    arm, simulation = arm_named(experiment.robot.model), experiment.simulation
    rate = f" at {simulation.control_rate:g} Hz" if simulation.mode == "sampled" else ""
    count = f"{len(run.lanes)} {'lane' if len(run.lanes) == 1 else 'lanes'}"
    said = (
        f"A simulation with Slidetune {document['slidetune']}: {count} on {arm.title}, "
        f"{simulation.horizon:g} s, trajectory {experiment.trajectory.kind}, {simulation.mode} "
        f"mode{rate}."
    )
    description = re.split(r"\n\s*\n", experiment.description.strip())
    texts = [" ".join(text.split()) for text in description if text]
    return html_paragraphs([*texts, said]) + lane_items(run)


def _experiment(run: Run, again: Repeating) -> str:
    experiment = run.experiment
    if again.same:
        text = f"It is the preset {again.preset}, as it ships."
        changed = html_paragraphs([text])
    elif again.preset:
        headings, rows = difference_rows(again.baseline, experiment)
        text = f"What differs from the shipped preset {again.preset}, the nearest there is."
        changed = html_table(headings, rows, text)
    else:
        changed = html_paragraphs(["It is nearest to no preset that ships: see the YAML below."])
    headings, rows = gain_rows(experiment)
    gains = html_table(headings, rows, "Every gain; — where a law has none of that name.")
    state = "" if again.preset and not again.same else " open"
    return (
        f"{changed}<details{state}><summary>Every gain of every lane</summary>{gains}</details>\n"
    )


def _figures(run: Run, document: Document) -> str:
    slides = arm_named(run.experiment.robot.model).slides
    lines = span_text(document, slides).splitlines()
    return html_paragraphs(lines) + figure_tables(run, document)


def _repeat(run: Run, again: Repeating) -> str:
    seed = run.experiment.disturbance.seed
    facts = ", ".join(f"{name} {value}" for name, value in versions().items())
    texts = [
        *again.needs,
        f"Made with {facts}. The same versions on the same machine give the same figures bit for "
        "bit; others may differ by rounding.",
        f"Seed of the sensor noise (disturbance.seed): {seed}; it matters where there is noise.",
    ]
    return (
        f'<pre class="command"><code id="command">{escape(again.command)}</code></pre>\n'
        f'<p class="buttons"><button type="button" data-copies="command">Copy the command</button>'
        f"</p>\n{html_paragraphs(texts)}"
    )


def _yaml(run: Run) -> str:
    text = escape(experiment_to_yaml(run.experiment))
    return (
        '<p class="buttons"><button type="button" data-copies="yaml-text">Copy the YAML</button> '
        '<button type="button" data-saves="yaml-text">Save it as experiment.yaml</button></p>\n'
        "<details><summary>The whole experiment</summary>"
        f'<pre tabindex="0"><code id="yaml-text">{text}</code></pre></details>\n'
    )
