"""The closed loop of the reference: its right-hand side and that one's exact Jacobian.

State: angles, velocities, where a law has a network ten weights a joint, and the torques of each
lag of the drives. Equations: ``Liu et al. 2025`` with the corrections of docs/notation.md, written
anew. ``sign(S)`` is a saturation whose layer is so thin that it no longer matters.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from tests.reference.arm import arm
from tests.reference.disturbance import disturbance
from tests.reference.motion import motion

Array = np.ndarray
NODES = 10
COULOMB_WIDTH = 0.02


class Loop:
    """One lane of an experiment as an ordinary differential equation.

    Attributes:
        start: state at time 0.
        edges: times at which the right-hand side is not smooth in [s].
        within: a time in the piece between two edges that is being integrated in [s].
    """

    def __init__(
        self, document: dict[str, Any], thin: float, arms: tuple[pin.Model, pin.Model] | None = None
    ) -> None:
        """Read an experiment of one lane.

        Args:
            document: the experiment as plain values, complete.
            thin: layer that stands for ``sign`` in [rad/s].
            arms: the true and the nominal arm; by default those of the published arm.
        """
        (self.lane,) = document["lanes"].values()
        robot, section = document["robot"], document["disturbance"]
        simulation = document["simulation"]
        self.thin = thin
        known = robot["payload"]["known"]
        self.model, self.nominal = arms or (
            arm(robot),
            arm(robot, section["nominal_mismatch"], payload=known),
        )
        self.joints = self.model.nv
        self.data = self.model.createData()
        self.nominal_data = self.nominal.createData()
        self.viscous, self.coulomb = (
            self._wide(robot["viscous_friction"]),
            self._wide(robot["coulomb_friction"]),
        )
        limit = robot["torque_limit"]
        self.limit = self._wide(np.inf if limit is None else limit)
        self.motion, bends = motion(document["trajectory"], self.joints)
        self.disturbance, jumps = disturbance(section, simulation["horizon"], self.joints)
        self.within = 0.0
        self.edges = sorted({*bends, *jumps})
        self.network = self.lane["law"].startswith("rbfnn")
        q_d, v_d, _ = self.motion(0.0)
        still = simulation["initial_velocity"] == "rest"
        q, v = q_d - self._wide(simulation["initial_error"]), 0.0 * v_d if still else v_d
        self.lag = self._wide(robot["lag"])
        self.lags = {"first": 1, "second": 2}[robot["lag_order"]] if self.lag.any() else 0
        if self.lags and not self.lag.all():
            raise ValueError("the reference has a lag at every joint or at none")
        weights = NODES * self.joints if self.network else 0
        self.start = np.concatenate([q, v, np.zeros(weights + self.lags * self.joints)])

    def _wide(self, value: Any) -> Array:
        return np.broadcast_to(np.array(value, dtype=float), self.joints).copy()

    def _surface(self, e: Array, de: Array) -> tuple[Array, Array, Array, Array]:
        """Return S, its slopes over e and de, and de times the second slope over de."""
        lane = self.lane
        if "lambda_" in lane:
            slope = self._wide(lane["lambda_"])
            return slope * e + de, slope, np.ones(self.joints), np.zeros(self.joints)
        nu, c, mu = self._wide(lane["nu"]), self._wide(lane["c"]), self._wide(lane["mu"])
        power = self._wide(lane["p"]) / self._wide(lane["k"])
        size = np.abs(de) ** (power - 1.0)
        bend = mu * power * (power - 1.0) * size * np.sign(de)
        s = nu * e + c * de + mu * size * de
        return s, nu, c + mu * power * size, np.abs(bend) * np.sign(bend) * np.sign(de)

    def _reaching(self, s: Array) -> tuple[Array, Array]:
        """Return the reaching law and its slope."""
        lane = self.lane
        k1, k2, layer = self._wide(lane["k1"]), self._wide(lane["k2"]), self._wide(lane["epsilon"])
        kind = lane["switching"]
        if kind == "tanh":
            switched = np.tanh(s / layer)
            slope = (1.0 - switched**2) / layer
        else:
            layer = layer if kind == "saturation" else np.full(self.joints, self.thin)
            switched = np.clip(s / layer, -1.0, 1.0)
            slope = np.where(np.abs(s) < layer, 1.0 / layer, 0.0)
        if lane["reaching"] == "exponential":
            return k1 * s + k2 * switched, k1 + k2 * slope
        if lane["reaching"] == "constant":
            return k2 * switched, k2 * slope
        size = np.maximum(np.abs(s), 1e-12)
        power = size ** lane["alpha"]
        return k1 * power * switched, k1 * power * (slope + lane["alpha"] * np.abs(switched) / size)

    def _hidden(self, q: Array, q_d: Array) -> tuple[Array, Array]:
        """Return the Gaussians' outputs and their slopes over q. Shapes (10, n)."""
        lane = self.lane
        source = lane["network_input"]
        x, sign = {"error": (q_d - q, -1.0), "angle": (q, 1.0), "desired": (q_d, 0.0)}[source]
        centres = np.linspace(-lane["center_span"], lane["center_span"], NODES)[:, None]
        width = self._wide(lane["width"])
        hidden = np.exp(-((x - centres) ** 2) / (2.0 * width**2))
        return hidden, -sign * hidden * (x - centres) / width**2

    def torque(self, t: float, y: Array) -> dict[str, Array]:
        """Return the controller's torque before its limit, and its slopes over q, v and weights."""
        lane, (q_d, v_d, a_d) = self.lane, self.motion(t)
        q, v = y[: self.joints], y[self.joints : 2 * self.joints]
        e, de = q_d - q, v_d - v
        if lane["law"] == "computed_torque":
            kp, kd = self._wide(lane["kp"]), self._wide(lane["kd"])
            return self._by_model(q, v, a_d + kd * de + kp * e, kp, kd)
        s, s_e, s_v, bent = self._surface(e, de)
        reached, gain = self._reaching(s)
        if self.network:
            weights = self._weights(y)
            hidden, tilt = self._hidden(q, q_d)
            f, f_q = (weights * hidden).sum(axis=0), (weights * tilt).sum(axis=0)
            over_q, over_v = np.diag(f_q - gain * s_e), np.diag(-gain * s_v)
            found = {"tau": f + reached, "q": over_q, "v": over_v}
            return {**found, "S": s, "s_e": s_e, "s_v": s_v, "hidden": hidden, "tilt": tilt}
        x = a_d + s_e / s_v * de
        # bent is de * ds_v/d(de): the slope of de/s_v is (1 - bent/s_v)/s_v.
        over_de = s_e / s_v * (1.0 - bent / s_v)
        if not lane.get("inertia_shaped", False):
            found = self._by_model(q, v, x, np.zeros(self.joints), over_de)
            found["tau"] = found["tau"] + reached
            found["q"] = found["q"] - np.diag(gain * s_e)
            found["v"] = found["v"] - np.diag(gain * s_v)
        else:
            bend = np.divide(bent, de, out=np.zeros(self.joints), where=de != 0.0)
            over_shaped = gain - reached * bend / s_v**2
            y_a, over_e = x + reached / s_v, gain * s_e / s_v
            found = self._by_model(q, v, y_a, over_e, over_de + over_shaped)
        return {**found, "S": s}

    def _by_model(
        self, q: Array, v: Array, a: Array, over_e: Array, over_de: Array
    ) -> dict[str, Array]:
        """Return M a + C v + G of the nominal arm, ``a`` having these slopes over e and de."""
        model, data = self.nominal, self.nominal_data
        dq, dv, M = pin.computeRNEADerivatives(model, data, q, v, a)
        M = np.triu(M) + np.triu(M, 1).T
        tau = np.array(data.tau)
        return {"tau": tau, "q": dq - M * over_e, "v": dv - M * over_de}

    def _weights(self, y: Array) -> Array:
        weights: Array = y[2 * self.joints : (2 + NODES) * self.joints].reshape(NODES, self.joints)
        return weights

    def drives(self, y: Array) -> Array:
        """Return the torques of the lags, from the command to the joint. Shape (0 to 2, n)."""
        torques: Array = y[len(y) - self.lags * self.joints :].reshape(self.lags, self.joints)
        return torques

    def rate(self, t: float, y: Array) -> Array:
        """Return dy/dt."""
        q, v = y[: self.joints], y[self.joints : 2 * self.joints]
        law = self.torque(t, y)
        given = np.clip(law["tau"], -self.limit, self.limit)
        late = []
        for torque in self.drives(y):
            late.append((given - torque) / self.lag)
            given = torque
        lost = self.disturbance(t, self.within) + self.viscous * v
        lost = lost + self.coulomb * np.tanh(v / COULOMB_WIDTH)
        a = pin.aba(self.model, self.data, q, v, given - lost)
        if not self.network:
            return np.concatenate([v, a, *late])
        phi, sigma = self._wide(self.lane["learning_rate"]), self._wide(self.lane["leakage"])
        learned = phi * law["hidden"] * law["S"] - sigma * self._weights(y)
        return np.concatenate([v, a, learned.ravel(), *late])

    def jacobian(self, t: float, y: Array) -> Array:
        """Return the slopes of ``rate`` over the state. Shape (n, n)."""
        q, v = y[: self.joints], y[self.joints : 2 * self.joints]
        law = self.torque(t, y)
        free = (np.abs(law["tau"]) <= self.limit)[:, None]
        command = np.clip(law["tau"], -self.limit, self.limit)
        given = self.drives(y)[-1] if self.lags else command
        rubbing = np.tanh(v / COULOMB_WIDTH)
        lost = self.disturbance(t, self.within) + self.viscous * v + self.coulomb * rubbing
        a_q, a_v, inverse = pin.computeABADerivatives(self.model, self.data, q, v, given - lost)
        inverse = np.triu(inverse) + np.triu(inverse, 1).T
        damping = np.diag(self.viscous + self.coulomb * (1.0 - rubbing**2) / COULOMB_WIDTH)
        out = np.zeros((len(y), len(y)))
        one, two = slice(0, self.joints), slice(self.joints, 2 * self.joints)
        out[one, two] = np.eye(self.joints)
        # Where the command goes, and by how much it moves what is there.
        size = len(y) - self.lags * self.joints
        at, by = (
            (slice(size, size + self.joints), np.diag(1.0 / self.lag))
            if self.lags
            else (two, inverse)
        )
        out[two, one], out[two, two] = a_q, a_v - inverse @ damping
        out[at, one] += by @ (free * law["q"])
        out[at, two] += by @ (free * law["v"])
        for n in range(self.lags):
            rows = slice(size + n * self.joints, size + (n + 1) * self.joints)
            out[rows, rows] = -np.diag(1.0 / self.lag)
            if n:
                out[rows, size : size + self.joints] = np.diag(1.0 / self.lag)
        if self.lags:
            out[two, len(y) - self.joints :] = inverse
        if not self.network:
            return out
        phi, sigma = self._wide(self.lane["learning_rate"]), self._wide(self.lane["leakage"])
        hidden, tilt = law["hidden"], law["tilt"]
        for n in range(NODES):
            rows = slice((2 + n) * self.joints, (3 + n) * self.joints)
            out[at, rows] = by * (free[:, 0] * hidden[n])
            over_q = phi * (tilt[n] * law["S"] - hidden[n] * law["s_e"])
            out[rows, one] = np.diag(over_q)
            out[rows, two] = np.diag(-phi * hidden[n] * law["s_v"])
            out[rows, rows] = np.diag(-sigma)
        return out
