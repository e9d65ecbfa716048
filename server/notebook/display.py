"""Results as a notebook takes them: Plotly's JSON, HTML without a script, and plain text."""

from __future__ import annotations

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import Run
from slidetune.robot.shown import Bundle
from slidetune.server.client.whole_response import WholeResponse
from slidetune.server.notebook.experiment_view import experiment_view
from slidetune.server.notebook.html_form import html_form
from slidetune.server.notebook.plotly_form import plotly_form
from slidetune.server.notebook.run_view import response_view, run_view
from slidetune.server.notebook.text_form import text_form
from slidetune.server.notebook.view import View

PLOTLY = "application/vnd.plotly.v1+json"
"""MIME type that Plotly's own extensions of JupyterLab and VS Code draw."""


def drawn(shown: object) -> Bundle:
    """Return the forms of a result by MIME type; none of them asks the network for anything."""
    view = _view(shown)
    if view is None:
        return {}
    forms: Bundle = {"text/plain": text_form(view), "text/html": html_form(view)}
    return {PLOTLY: plotly_form(view), **forms} if view.plots else forms


def _view(shown: object) -> View | None:
    if isinstance(shown, Run):
        return run_view(shown)
    if isinstance(shown, WholeResponse):
        return response_view(shown)
    if isinstance(shown, Experiment):
        return experiment_view(shown)
    from slidetune.server.notebook.tuned import Tuned  # samplers take a second to load
    from slidetune.server.notebook.tuned_view import tuned_view

    return tuned_view(shown) if isinstance(shown, Tuned) else None
