"""Laws with a memory, and the loops around them, written anew with NumPy, SciPy and Pinocchio."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

from tests.reference.arm import JOINTS, arm
from tests.reference.motion import motion

Array = np.ndarray


def _wide(value: Any) -> Array:
    return np.broadcast_to(np.array(value, dtype=float), JOINTS)


class PlainLoop:
    """One lane of an experiment without friction and limits, under a constant disturbance.

    Attributes:
        torque: ``(t, q, v, memory)`` returns the torque of the law alone, and how fast its memory
            changes.
        memory: the memory at the beginning. Shape (6,).
    """

    def __init__(self, document: dict[str, Any]) -> None:
        """Read an experiment of one lane as plain values, complete."""
        (self.lane,) = document["lanes"].values()
        robot, self.simulation = document["robot"], document["simulation"]
        self.model = arm(robot)
        self.data = self.model.createData()
        self.nominal = arm(robot, document["disturbance"]["nominal_mismatch"])
        self.nominal_data = self.nominal.createData()
        self.lost = _wide(document["disturbance"]["constant"])
        self.motion, _ = motion(document["trajectory"], JOINTS)
        q_d, v_d, _ = self.motion(0.0)
        self.q, self.v = q_d - _wide(self.simulation["initial_error"]), v_d
        self.torque: Callable[..., tuple[Array, Array]] = getattr(self, self.lane["law"])
        rates = {"none": 0.0, "momentum": self.lane["observer_rate"], "time_delay": np.inf}
        self.rate = _wide(rates[self.lane["observer"]])
        self.memory = np.zeros(JOINTS)
        if self.lane["law"] == "integral_smc":
            e, de = q_d - self.q, v_d - self.v
            self.memory = -(de + _wide(self.lane["kd"]) * e)
        if self.lane["law"] == "adaptive_smc":
            self.memory = np.minimum(_wide(self.lane["k2_min"]), _wide(self.lane["k2"]))

    def _by_model(self, q: Array, v: Array, a: Array) -> Array:
        return np.array(pin.rnea(self.nominal, self.nominal_data, q, v, a))

    def _switched(self, s: Array, k2: Array) -> Array:
        lane = self.lane
        x = s / _wide(lane["epsilon"])
        functions = {"tanh": np.tanh, "saturation": lambda x: np.clip(x, -1, 1), "sign": np.sign}
        return np.array(_wide(lane["k1"]) * s + k2 * functions[lane["switching"]](x))

    def super_twisting(self, t: float, q: Array, v: Array, z: Array) -> tuple[Array, Array]:
        """Levant 1993: k1 |S|^0.5 sign(S) + z."""
        q_d, v_d, a_d = self.motion(t)
        slope, k1, k2 = (_wide(self.lane[name]) for name in ("lambda_", "k1", "k2"))
        s = v_d - v + slope * (q_d - q)
        twist = k1 * np.sqrt(np.abs(s)) * np.sign(s) + z
        return self._by_model(q, v, a_d + slope * (v_d - v) + twist), k2 * np.sign(s)

    def integral_smc(self, t: float, q: Array, v: Array, z: Array) -> tuple[Array, Array]:
        """Utkin and Shi 1996: S is 0 at the beginning."""
        q_d, v_d, a_d = self.motion(t)
        kp, kd = _wide(self.lane["kp"]), _wide(self.lane["kd"])
        e, de = q_d - q, v_d - v
        reached = self._switched(de + kd * e + z, _wide(self.lane["k2"]))
        return self._by_model(q, v, a_d + kd * de + kp * e + reached), kp * e

    def adaptive_smc(self, t: float, q: Array, v: Array, k: Array) -> tuple[Array, Array]:
        """Plestan et al. 2010."""
        q_d, v_d, a_d = self.motion(t)
        slope, rate = _wide(self.lane["lambda_"]), _wide(self.lane["adaptation_rate"])
        s = v_d - v + slope * (q_d - q)
        a = a_d + slope * (v_d - v) + self._switched(s, self.bounded(k))
        growth = np.where(np.abs(s) < _wide(self.lane["epsilon"]), -1.0, 1.0)
        return self._by_model(q, v, a), rate * np.abs(s) * growth

    def bounded(self, memory: Array) -> Array:
        """Return a memory within its bounds."""
        lane = self.lane
        if lane["law"] == "adaptive_smc":
            memory = np.minimum(np.maximum(memory, _wide(lane["k2_min"])), _wide(lane["k2"]))
        if lane["law"] == "super_twisting":
            memory = np.clip(memory, -_wide(lane["z_max"]), _wide(lane["z_max"]))
        return memory

    def sampled(self) -> tuple[Array, Array, Array, Array]:
        """Return angles, torques, memory and the estimate of F at each sample. Shapes (n, 6)."""
        rows, period = [], 1.0 / self.simulation["control_rate"]
        steps = self.simulation["plant_substeps"]
        h, q, v, memory = period / steps, self.q.copy(), self.v.copy(), self.memory
        # What the nominal arm would have been short of over the period before, low-pass filtered.
        keep, estimate, before = np.exp(-self.rate * period), np.zeros(JOINTS), None
        for sample in range(round(self.simulation["horizon"] / period) + 1):
            if before is not None:
                start, torque, bias = before
                inertial = self._by_model(q, 0 * v, (v - start) / period)
                inertial = inertial - self._by_model(q, 0 * v, 0 * v)
                estimate = keep * estimate + (1 - keep) * (torque - bias - inertial)
            tau, rate = self.torque(sample * period, q, v, memory)
            tau = tau + estimate
            rows.append((q, tau, memory, estimate))
            before = v, tau, self._by_model(q, v, 0 * v)
            memory = self.bounded(memory + period * rate)
            for _ in range(steps):
                v = v + h * pin.aba(self.model, self.data, q, v, tau - self.lost)
                q = q + h * v
        q_rows, tau_rows, memory_rows, estimates = map(np.array, zip(*rows, strict=True))
        return q_rows, tau_rows, memory_rows, estimates

    def continuous(self, times: Array) -> Array:
        """Return angles, memory and the estimate of F at given times. Shape (n, 18).

        Time-delay estimation without a delay makes the arm the nominal one, undisturbed.
        """
        instant = np.isinf(self.rate)

        def rate(t: float, y: Array) -> Array:
            q, v, memory, estimate = y.reshape(4, JOINTS)
            tau, change = self.torque(t, q, v, memory)
            # At a bound, or past it by a step of the solver, it goes no further.
            stuck = (memory - self.bounded(memory)) * change >= 0.0
            stuck &= self.bounded(memory + np.sign(change)) == self.bounded(memory)
            change = np.where(stuck, 0.0, change)
            if instant.any():
                a = pin.aba(self.nominal, self.nominal_data, q, v, tau)
                return np.concatenate([v, a, change, np.zeros(JOINTS)])
            tau = tau + estimate
            a = pin.aba(self.model, self.data, q, v, tau - self.lost)
            missing = tau - self._by_model(q, v, a)
            return np.concatenate([v, a, change, self.rate * (missing - estimate)])

        start = np.concatenate([self.q, self.v, self.memory, np.zeros(JOINTS)])
        # A rate that jumps spoils the differences from which Radau takes its slopes.
        jumps = self.lane["law"] == "adaptive_smc"
        method, longest = ("DOP853", 1e-3) if jumps else ("Radau", 1e-2)
        span, close = (0.0, times[-1]), {"rtol": 1e-8, "atol": 1e-9, "max_step": longest}
        found = solve_ivp(rate, span, start, method, t_eval=times, **close)
        return np.delete(found.y.T, np.s_[JOINTS : 2 * JOINTS], axis=1)
