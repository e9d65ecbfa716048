"""The closed loop in plain NumPy for whoever has M(q) and h(q, v), or holds a torque."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tests.peers.controller import Answer, Controller
from tests.peers.problem import SAMPLE, Array, MassAndBias, Problem, Run, Trace

LOST = 20.0
"""Velocity [rad/s] from which on a loop counts as diverged (*ours*; 1 is desired at most)."""

State = tuple[Array, Array, Array]


def implicit_step(
    controller: Controller, h: float, answer: Answer, M: Array, bias: Array, state: State
) -> State:
    """Return the state after one linearly implicit Euler step of size ``h`` [s]."""
    q, v, W = state
    damping, torque = controller.linearized(h, answer)
    matrix = M.copy()
    matrix.flat[::7] += h * damping
    a = np.linalg.solve(matrix, torque - bias)
    v = v + h * a
    return q + h * v, v, controller.learned(h, answer, a, W)


def start(problem: Problem) -> State:
    """Return q [rad], v [rad/s] and the weights at t = 0."""
    return np.zeros(6), problem.v0.copy(), np.zeros((len(problem.centers), 6))


def lost(v: Array) -> bool:
    """Whether a velocity is past all bounds, or no number."""
    return not np.abs(v).max() < LOST


def follow(
    problem: Problem, steps: int, state: State, step: Callable[[float, State], State]
) -> Trace:
    """Repeat ``step(t, state)`` and keep what the trace wants."""
    rows = []
    for n in range(steps):
        if n % SAMPLE == 0:
            rows.append(state[0].copy())
        state = step(n * problem.h, state)
        if lost(state[1]):
            return Trace(np.array(rows), (n + 1) * problem.h)
    return Trace(np.array([*rows, state[0]]))


Step = Callable[[float, State], State]


def plain_step(problem: Problem, mass_and_bias: MassAndBias) -> Step:
    """Return a step of the plain scheme, first order."""
    controller, h = Controller(problem), problem.h

    def step(t: float, state: State) -> State:
        M, bias = mass_and_bias(state[0], state[1])
        return implicit_step(controller, h, controller(t, *state), M, bias, state)

    return step


def extrapolated_step(problem: Problem, mass_and_bias: MassAndBias) -> Step:
    """Return a step of the extrapolated scheme: two half steps doubled, less one whole step."""
    controller, h, half = Controller(problem), problem.h, 0.5 * problem.h

    def step(t: float, state: State) -> State:
        M, bias = mass_and_bias(state[0], state[1])
        answer = controller(t, *state)
        q1, v1, W1 = implicit_step(controller, h, answer, M, bias, state)
        middle = implicit_step(controller, half, answer, M, bias, state)
        M, bias = mass_and_bias(middle[0], middle[1])
        answer = controller(t + half, *middle)
        q2, v2, W2 = implicit_step(controller, half, answer, M, bias, middle)
        return 2.0 * q2 - q1, 2.0 * v2 - v1, 2.0 * W2 - W1

    return step


def plain(problem: Problem, steps: int, mass_and_bias: MassAndBias) -> Run:
    """Return a run of the plain scheme."""
    step = plain_step(problem, mass_and_bias)
    return lambda: follow(problem, steps, start(problem), step)


def extrapolated(problem: Problem, steps: int, mass_and_bias: MassAndBias) -> Run:
    """Return a run of the extrapolated scheme."""
    step = extrapolated_step(problem, mass_and_bias)
    return lambda: follow(problem, steps, start(problem), step)


def held(problem: Problem, steps: int, advance: Callable[[Array], tuple[Array, Array]]) -> Run:
    """Return a run of a simulator that takes a torque and holds it for a control period.

    Args:
        problem: the loop.
        steps: how many control periods.
        advance: goes on by one period under a torque in [N m]; returns q [rad] and v [rad/s].
    """
    controller, rate = Controller(problem), problem.h * problem.learning_rate

    def step(t: float, state: State) -> State:
        answer = controller(t, *state)
        q, v = advance(answer.torque - problem.external)
        return q, v, state[2] + answer.hidden * (rate * answer.S)

    return lambda: follow(problem, steps, start(problem), step)
