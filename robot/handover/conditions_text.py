"""The conditions as a page that people read."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from slidetune.robot.arm.known import arm_named
from slidetune.robot.fields.units import BETWEEN, unit_of_joints
from slidetune.robot.goals.uncertainty import Uncertainty
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.figures import FIGURES, STUDIED

Document = dict[str, Any]
_NONE = "–"
_QUANTILES = ("quantile", "unit", "5 %", "median", "95 %", "worst")
_RIGHT = "---:"
_INITIAL = {"desired": "that of the desired motion", "rest": "0"}


def conditions_markdown(conditions: Document) -> str:
    """Return what ``conditions_of`` returned as Markdown."""
    slides = arm_named(conditions["arm"]["model"]).slides
    law = LAWS[conditions["law"]].title
    lines = [
        f"# Conditions of {law}",
        "",
        f"Lane {table_cell(conditions['lane'])} of the experiment in `experiment.yaml`, by "
        f"Slidetune {conditions['slidetune']}. `conditions.json` has the same as numbers.",
        "",
        *_listed("Warnings", conditions["warnings"]),
        "## The loop",
        "",
        *_table(("", ""), _loop(conditions, slides)),
        *_table(
            ("", *(f"J{number}" for number in range(1, len(slides) + 1))),
            _by_joint(conditions, slides),
            _RIGHT,
        ),
        "## Margins",
        "",
        *_table(("", ""), _margins(conditions)),
        *_outcome("How it did", conditions["outcome"], slides),
    ]
    if conditions["outcome_as_tuned"] is not None:
        title = "How it did in continuous mode, as it was tuned"
        lines += _outcome(title, conditions["outcome_as_tuned"], slides)
    lines += _robustness(conditions["robustness"], slides)
    remarks = [one["message"] for one in conditions["advice"] if one["level"] == "info"]
    lines += _listed("Remarks", remarks)
    lines += _listed("What is not covered", conditions["not_covered"])
    return "\n".join(lines).rstrip("\n") + "\n"


def _unit(unit: str, slides: Sequence[bool]) -> str:
    """Return the unit of an arm's joints, without the bar that would end a cell."""
    return unit_of_joints(unit, slides).replace(BETWEEN, " or ")


def table_cell(text: str) -> str:
    """Return text that ends no cell of a table and begins no markup."""
    shown = "".join(letter if letter.isprintable() else "?" for letter in text)
    return "".join(f"\\{letter}" if letter in "\\`*_|[]#" else letter for letter in shown)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]], numbers: str = "") -> list[str]:
    """Return the lines of a table; ``numbers`` is ``---:`` where all but the first column are."""
    if not rows:
        return []
    line = _row(["---", *[numbers or "---"] * (len(head) - 1)])
    return [_row(head), line, *(_row(row) for row in rows), ""]


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _listed(title: str, items: Sequence[str]) -> list[str]:
    return [f"## {title}", "", *(f"- {item}" for item in items), ""] if items else []


def _number(value: float | None, factor: float = 1.0) -> str:
    return _NONE if value is None else f"{factor * value:.4g}"


def _loop(conditions: Document, slides: Sequence[bool]) -> list[tuple[str, str]]:
    control, arm, payload = conditions["control"], conditions["arm"], conditions["arm"]["payload"]
    nominal, noise = arm["nominal"], conditions["environment"]["sensor_noise"]
    mass = f"{payload['mass']:g} kg at {payload['center']} m of the flange's frame"
    known = "known" if nominal["knows_payload"] else "not known"
    angle = _unit("rad", slides)
    model = "the law takes none"
    if LAWS[conditions["law"]].model_based:
        model = f"digest {nominal['digest']}, masses times {nominal['scale']:g} of the arm's"
    return [
        ("control rate", f"{control['rate']:g} Hz, period {control['period']:g} s"),
        ("input delay", f"{control['input_delay']:g} s"),
        ("tuned in", f"{control['tuned_mode']} mode, arm's step {control['tuned_step']:g} s"),
        ("arm", f"{table_cell(arm['title'])}, digest {arm['digest']} with its payload"),
        ("masses", f"{arm['inertials']}, times {arm['inertia_scale']:g}"),
        ("payload", f"{mass}, {known} to the controller" if payload["mass"] else "none"),
        ("nominal model (M, h)", model),
        ("motion", f"{conditions['motion']['kind']}, over {control['horizon']:g} s"),
        ("initial velocity", _INITIAL[conditions["initial_velocity"]]),
        (
            "noise of q and v",
            f"{noise['position']:g} {angle} and {noise['velocity']:g} {_unit('rad/s', slides)}",
        ),
    ]


def _by_joint(conditions: Document, slides: Sequence[bool]) -> list[list[str]]:
    arm, drives = conditions["arm"], conditions["drives"]
    order = " (two in series)" if drives["lag_order"] == "second" else ""
    rows = [
        ("name", None, arm["joints"]),
        ("torque limit", "N·m", drives["torque_limit"]),
        (f"lag of the drive{order}", "s", drives["lag"]),
        ("rotor inertia", "kg·m²", arm["armature"]),
        ("viscous friction", "N·m·s/rad", arm["viscous_friction"]),
        ("Coulomb friction", "N·m", arm["coulomb_friction"]),
        ("initial error", "rad", conditions["initial_error"]),
    ]
    return [
        [title, *map(table_cell, values)]
        if unit is None
        else [f"{title} [{_unit(unit, slides)}]", *map(_number, values)]
        for title, unit, values in rows
    ]


def _margins(conditions: Document) -> list[tuple[str, str]]:
    margin, threshold = conditions["margin"], conditions["threshold"]
    radius = "no boundary layer" if margin["radius"] is None else f"{margin['radius']:.4g}"
    rows = [
        ("ρ, spectral radius of a control period (stable below 1)", radius),
        ("γ, sampling margin", _number(margin["gamma"])),
        ("γ at which this loop becomes unstable", _number(margin["gamma_limit"])),
    ]
    layers = "not told for this law and switching function"
    if threshold is not None:
        each = [_number(layer) for layer in threshold["joints"]]
        common = _number(threshold["common"])
        layers = f"{common} for all joints" + (f"; one by one {', '.join(each)}" if each else "")
    return [*rows, ("ε* above which it does not chatter [rad/s]", layers)]


def _outcome(title: str, outcome: Document, slides: Sequence[bool]) -> list[str]:
    lines = [f"## {title}", ""]
    if outcome["frozen"] is not None:
        lines += [outcome["frozen"]["cause"], ""]
    goals = [
        (
            table_cell(name),
            table_cell(goal["said"]),
            goal["priority"],
            _number(goal["ratio"]),
            "yes" if goal["kept"] else "no",
        )
        for name, goal in outcome["goals"].items()
    ]
    head = ("goal", "bound", "priority", "value over bound", "kept")
    lines += _table(head, goals) or ["The experiment has no goals.", ""]
    lines += _table(("figure", "unit", "value"), _figures(outcome["figures"], slides))
    estimate = outcome["accuracy"]["error_estimate"]
    if estimate is not None:
        angle = _unit("rad", slides)
        lines += [f"Estimated error of the simulated positions: {estimate:.2g} {angle}.", ""]
    return lines


def _figures(figures: Document, slides: Sequence[bool]) -> list[tuple[str, str, str]]:
    rows = []
    for name, value in figures.items():
        figure = FIGURES.get(name)
        if figure is None or name == "diverged_at":
            continue
        values = list(value) if isinstance(value, list | tuple) else [value]
        shown = ", ".join(_number(one, figure.factor) for one in values)
        rows.append((figure.title, _unit(figure.shown_unit, slides), shown))
    return rows


def _robustness(robustness: Document | None, slides: Sequence[bool]) -> list[str]:
    if robustness is None:
        return []
    fields = Uncertainty.model_fields
    ranges = [
        (str(fields[name].title), *(f"{end:g}" for end in ends))
        for name, ends in robustness["uncertain"].items()
    ]
    worst = robustness["worst_found"]
    return [
        "## Robustness",
        "",
        f"{robustness['draws']} draws, seed {robustness['seed']}: "
        f"{robustness['kept']:.1%} kept every hard goal, {robustness['diverged']:.1%} left their "
        "bounds.",
        "",
        *_table(("uncertain", "from", "to"), ranges, _RIGHT),
        *_table(_QUANTILES, list(_quantiles(robustness)), _RIGHT),
        *([] if worst is None else _worst(worst, robustness["tried_for_worst"])),
    ]


def _quantiles(robustness: Document) -> Iterator[tuple[str, ...]]:
    labels = ("p5", "median", "p95", "worst")
    quantiles = robustness["quantiles"]
    for name in STUDIED:
        if (found := quantiles["figures"].get(name)) is not None:
            figure = FIGURES[name]
            values = (_number(found[label], figure.factor) for label in labels)
            yield (figure.title, figure.shown_unit, *values)
    for name, found in quantiles["ratios"].items():
        yield (f"goal {table_cell(name)}", "", *(_number(found[label]) for label in labels))


def _worst(worst: Document, tries: int) -> list[str]:
    values = ", ".join(f"{name} {value:.4g}" for name, value in worst["values"].items())
    kept = "every hard goal is kept" if worst["outcome"]["kept"] else "a hard goal is missed"
    return [f"Worst of {tries} tries of a search for it: {kept}, at {values}.", ""]
