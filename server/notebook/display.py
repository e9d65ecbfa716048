"""Results as a notebook takes them: Plotly's JSON, HTML without a script, and plain text."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import Run
from slidetune.robot.shown import Bundle
from slidetune.server.client.whole_response import WholeResponse
from slidetune.server.notebook.experiment_view import experiment_view
from slidetune.server.notebook.html_form import html_form
from slidetune.server.notebook.plotly_form import plotly_form
from slidetune.server.notebook.run_view import response_view, run_view
from slidetune.server.notebook.text_form import text_form
from slidetune.server.notebook.tuned import Tuned
from slidetune.server.notebook.tuned_view import tuned_view
from slidetune.server.notebook.view import View

PLOTLY = "application/vnd.plotly.v1+json"
"""MIME type that Plotly's own extensions of JupyterLab and VS Code draw."""

_VIEWS: tuple[tuple[type, Callable[[Any], View]], ...] = (
    (Run, run_view),
    (WholeResponse, response_view),
    (Tuned, tuned_view),
    (Experiment, experiment_view),
)


def drawn(shown: object) -> Bundle:
    """Return the forms of a result by MIME type; none of them asks the network for anything."""
    for kind, view_of in _VIEWS:
        if isinstance(shown, kind):
            view = view_of(shown)
            forms: Bundle = {"text/plain": text_form(view), "text/html": html_form(view)}
            return {PLOTLY: plotly_form(view), **forms} if view.plots else forms
    return {}
