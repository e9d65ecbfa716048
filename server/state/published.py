"""What the server says of the laws and fields that there are."""

from __future__ import annotations

from typing import Any

from slidetune.robot.experiment.document import LONGEST_LANE_NAME, Experiment
from slidetune.robot.experiment.preset_name import LONGEST_NAME
from slidetune.robot.laws import LAWS
from slidetune.robot.lessons.lesson import MOST_EXAGGERATION
from slidetune.robot.loop.figures import FIGURES


def law_infos() -> list[dict[str, Any]]:
    """Return name, title and summary of every law."""
    names = ("name", "title", "summary", "model_based", "network", "version")
    return [{name: getattr(law, name) for name in names} for law in LAWS.values()]


def published_schema() -> dict[str, Any]:
    """Return the JSON Schema of an experiment with what else its readers need."""
    return {
        **Experiment.model_json_schema(),
        "x-laws": law_infos(),
        "x-figures": [figure.document() for figure in FIGURES.values()],
        "x-bounds": {
            "lane_name": LONGEST_LANE_NAME,
            "preset_name": LONGEST_NAME,
            "exaggeration": MOST_EXAGGERATION,
        },
    }
