"""Random experiments, drawn from the schema that the sliders are drawn from."""

from __future__ import annotations

import math
import random
from typing import Any

from slidetune.robot.arm.known import SHIPPED, arm_named
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.quantity import MOST_JOINTS
from slidetune.robot.goals.section import OF_THE_WHOLE_ARM

Schema = dict[str, Any]
Document = dict[str, Any]

AT_A_BOUND = 0.12
"""Share of numbers that are drawn exactly at a bound (*ours*): that is where things go wrong."""
REFUSED = 0.15
"""Share of experiments in which combinations that may be refused are left as drawn (*ours*)."""
PROMPT = 0.5
"""Share of experiments whose drives have no lag (*ours*): most loops have none, and few draws."""
LANES = 3
"""Most lanes of a drawn experiment (*ours*)."""
STEPS = 20_000
"""Steps of the arm that a run may take, where its shortest horizon allows (*ours*)."""
LONGEST = 0.5
"""Longest horizon in [s] (*ours*)."""
GOALS = 2
"""Most goals of a drawn experiment (*ours*)."""
OF_A_CIRCLE = 3
"""Fewest joints with which a flange goes round."""
SHORTEST = 0.1
"""Shortest horizon that the schema takes in [s]."""


class Draw:
    """Draws documents from the schema of ``Experiment``."""

    def __init__(
        self,
        seed: int,
        without: tuple[str, ...] = (),
        prompt: float = PROMPT,
        arms: tuple[str, ...] = (SHIPPED,),
    ) -> None:
        """Draw always the same for the same seed.

        Args:
            seed: what the draws follow.
            without: options that are not to be drawn.
            prompt: share of experiments whose drives have no lag.
            arms: which arms they may be about.
        """
        self._dice = random.Random(seed)
        self._without, self._prompt, self._arms = without, prompt, arms
        self._joints = 0
        self._schema = Experiment.model_json_schema()

    def document(self) -> Document:
        """Return an experiment within its bounds, of which a combination may still be refused."""
        apart = {"lanes", "goals", "uncertainty", "title", "description"}
        arm = self._dice.choice(self._arms) if len(self._arms) > 1 else self._arms[0]
        self._joints = arm_named(arm).joints
        drawn: Document = self._object(self._schema, skip=apart)
        drawn["robot"]["model"] = arm
        variants = self._schema["properties"]["lanes"]["additionalProperties"]
        names = [f"Lane {n + 1}" for n in range(self._dice.randint(1, LANES))]
        drawn["lanes"] = {name: self._value(variants) for name in names}
        simulation = drawn["simulation"]
        simulation["horizon"] = self._horizon(simulation)
        if self._dice.random() > REFUSED:
            self._avoid_refusal(drawn)
        if drawn["robot"]["model"] != SHIPPED:
            drawn["robot"]["inertials"] = "vendor"
        if self._dice.random() < self._prompt:
            drawn["robot"]["lag"] = 0.0
        # Last, so that what is run is drawn as without them.
        drawn["goals"] = {
            f"Goal {n + 1}": self._goal() for n in range(self._dice.randint(0, GOALS))
        }
        drawn["uncertainty"] = self._uncertainty()
        return drawn

    def _goal(self) -> Document:
        goal: Document = self._value(self._schema["properties"]["goals"]["additionalProperties"])
        if goal.get("channel", goal.get("figure")) in OF_THE_WHOLE_ARM:
            goal["joint"] = 0
        goal["joint"] = min(goal["joint"], self._joints)
        if goal["kind"] == "response":
            goal["start"], goal["end"] = sorted(self._dice.sample(range(120), 2))
        return goal

    def _uncertainty(self) -> Document:
        drawn: Document = self._value(self._schema["properties"]["uncertainty"])
        ranges = {name: sorted(ends) for name, ends in drawn.items() if isinstance(ends, list)}
        return {**drawn, **ranges}

    def _avoid_refusal(self, drawn: Document) -> None:
        """Change the combinations that are known to be refused."""
        for lane in drawn["lanes"].values():
            if lane.get("reaching") == "power" and lane["switching"] == "implicit":
                lane["switching"] = "sign"
            if "p" in lane:
                odd = [2 * self._dice.randint(1, 24) + 1 for _ in range(self._joints)]
                lane["k"] = odd
                lane["p"] = [k + 2 * self._dice.randint(1, k // 2) for k in odd]
        if drawn["trajectory"]["kind"] == "circle" and self._joints < OF_A_CIRCLE:
            drawn["trajectory"] = {"kind": "quintic"}
        if drawn["trajectory"]["kind"] == "circle":
            del drawn["trajectory"]["pose"]
            drawn["trajectory"]["radius"] = self._dice.uniform(0.005, 0.1)
        if drawn["trajectory"]["kind"] == "recorded":
            rows = [[self._dice.uniform(-1.0, 1.0) for _ in range(6)] for _ in range(12)]
            text = "\n".join(" ".join(map(str, row)) for row in rows)
            drawn["trajectory"] = {"kind": "recorded", "spacing": 0.3, "waypoints": text}

    def _horizon(self, simulation: Document) -> float:
        steps = 1.0 / simulation["step"]
        if simulation["mode"] == "sampled":
            steps = simulation["control_rate"] * simulation["plant_substeps"]
        return float(min(LONGEST, max(SHORTEST, STEPS / steps)))

    def _object(self, schema: Schema, skip: set[str] = frozenset()) -> Document:  # type: ignore[assignment]
        parts = schema["properties"].items()
        return {name: self._value(part) for name, part in parts if name not in skip}

    def _value(self, schema: Schema) -> Any:
        """Return a value that a part of the schema takes."""
        if "$ref" in schema:
            return self._value(self._named(schema["$ref"]))
        if "const" in schema:
            return schema["const"]
        if "enum" in schema:
            return self._dice.choice([one for one in schema["enum"] if one not in self._without])
        if "oneOf" in schema:
            return self._value(self._dice.choice(schema["oneOf"]))
        if "anyOf" in schema:
            return self._shaped(self._dice.choice(schema["anyOf"]), schema)
        return self._shaped(schema, schema)

    def _named(self, reference: str) -> Schema:
        named: Schema = self._schema["$defs"][reference.rpartition("/")[2]]
        return named

    def _shaped(self, shape: Schema, bounds: Schema) -> Any:
        """Return a value of a shape, with the bounds of the property that it belongs to."""
        kind = shape["type"]
        if kind == "object":
            return self._object(shape)
        if kind == "null":
            return None
        if kind == "boolean":
            return self._dice.random() < 0.5
        if kind == "array":
            per_joint = shape["maxItems"] == MOST_JOINTS
            count = self._joints if per_joint else shape["minItems"]
            return [self._number(bounds, "number") for _ in range(count)]
        if kind == "string":
            return ""
        return self._number(bounds, kind)

    def _number(self, bounds: Schema, kind: str) -> float | int:
        low, high = float(bounds["minimum"]), float(bounds["maximum"])
        if self._dice.random() < AT_A_BOUND:
            value = self._dice.choice([low, high])
        elif bounds.get("scale") == "log" and low > 0.0:
            value = math.exp(self._dice.uniform(math.log(low), math.log(high)))
            value = min(max(value, low), high)
        else:
            value = self._dice.uniform(low, high)
        if bounds.get("odd"):
            return min(2 * int(value // 2) + 1, int(high) if int(high) % 2 else int(high) - 1)
        return round(value) if kind == "integer" else value
