"""What a search for gains came to, for who goes on with it in Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.shown import Shown
from slidetune.robot.study.results import table_of
from slidetune.robot.study.study import Study
from slidetune.robot.study.tune import Trial, best_of
from slidetune.robot.study.tuning import Tuning
from slidetune.server.report.study_report import ratio_text, tuning_document

Array = np.ndarray


@dataclass(frozen=True)
class Judged:
    """One set of gains and how it did; with draws, figures are those of the draw that counts.

    Attributes:
        number: which trial, from 0; the first is the lane as it was.
        gains: what was searched, by name, in the gains' own units; of six gains that are turned
            alike the greatest.
        figures: mean and greatest error, chattering and so on by the names that ``Run`` has for
            them, in SI units; one number for all joints, ``None`` where the run has none.
        ratios: value over bound of every goal, by name: 1 is just met.
        score: the ratio that decides: the largest hard one where one is above 1 or there is no
            soft goal, else the largest soft one; ``None`` where the run left its bounds.
        kept: whether every hard goal holds.
        diverged_at: when it left its bounds in [s], or ``None``.
        draws: over all draws: how many, ``diverged`` and ``kept`` as shares, ``means`` of the mean
            error and of chattering.
    """

    number: int
    gains: Mapping[str, float]
    figures: Mapping[str, float | None]
    ratios: Mapping[str, float | None]
    score: float | None
    kept: bool
    diverged_at: float | None
    draws: Mapping[str, Any]


@dataclass(frozen=True, repr=False)
class Tuned(Shown):
    """What ``slidetune.tune`` found.

    Attributes:
        experiment: the one whose lane was tuned, as it was.
        settings: what was searched, and how.
        trials: every set of gains that was tried, in order; the first is the present one.
        interrupted: whether it was interrupted before all trials were done.
    """

    experiment: Experiment
    settings: Tuning
    trials: tuple[Trial, ...] = field(repr=False)
    interrupted: bool = False

    def __repr__(self) -> str:
        """Return lane, trials and the best score."""
        done = f"{len(self.trials)} of {self.settings.trials} trials"
        kept = "kept" if self.after.kept else "not kept"
        score = ratio_text(self.after.score, 3)
        return f"Tuned({self.settings.lane}: {done}, best score {score}, hard goals {kept})"

    @property
    def best(self) -> Experiment:
        """The experiment with the best gains, as it was but for them."""
        return self._study.variant(self._best)

    @property
    def before(self) -> Judged:
        """How the lane did as it was."""
        return _judged(self.trials[0])

    @property
    def after(self) -> Judged:
        """How it does with the best gains, which are the present ones where none are better."""
        return _judged(self._best)

    @property
    def columns(self) -> dict[str, Array]:
        """All trials as columns, a row each: ``pandas.DataFrame(tuned.columns)``.

        ``number``, the gains and figures by name in SI units, ``ratio of …`` of every goal,
        ``cost``, ``score``, ``kept``, ``diverged_at``, ``refused``; ``draws``, and the shares of
        them that diverged and kept the hard goals; ``beaten`` for those that were given up before
        they met all draws. NaN stands for what there is not. Each of shape (trials,).
        """
        table = table_of(self.trials)
        return {name: _column(values) for name, values in table.items()}

    def document(self) -> dict[str, Any]:
        """Return it as plain JSON values, those that ``slidetune tune --json`` writes."""
        return tuning_document(self.experiment, self.settings, self.trials)

    @property
    def _study(self) -> Study:
        return Study("tune", self.experiment, self.settings)

    @property
    def _best(self) -> Trial:
        best = best_of(self.trials)
        assert best is not None  # the first one meets all draws
        return best


def _judged(trial: Trial) -> Judged:
    made = trial.outcome
    return Judged(
        trial.number,
        trial.values,
        made.figures,
        made.ratios,
        made.score,
        made.kept,
        made.diverged_at,
        trial.draws,
    )


def _column(values: Sequence[Any]) -> Array:
    if all(isinstance(one, bool) for one in values):
        return np.array(values, bool)
    if all(isinstance(one, int) for one in values):
        return np.array(values, np.int64)
    if any(isinstance(one, str) for one in values):
        return np.array(values, object)
    return np.array([np.nan if one is None else one for one in values], float)
