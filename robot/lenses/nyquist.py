"""The picture of harmonic balance: a joint's Nyquist curve, and -1/N(A) of its switching term."""

from __future__ import annotations

import numpy as np

from slidetune.robot.margins.harmonic_balance import LOWEST, LimitCycle
from slidetune.robot.margins.switching_loop import SwitchingLoop
from slidetune.robot.margins.switching_term import SwitchingTerm

Array = np.ndarray

_CURVE = 90
"""Points of a Nyquist curve (*ours*)."""
_LINE = 40
"""Points of the line -1/N(A) (*ours*)."""


def nyquist_curve(loop: SwitchingLoop, joint: int, cycle: LimitCycle | None) -> tuple[Array, Array]:
    """Return frequencies in [rad/s] and the curve there in [rad/s], of super-twisting in [s].

    About the limit cycle, or where there is none over all frequencies at which one is looked for;
    empty where the joint's gain is 0.

    Args:
        loop: the loop around the switching terms.
        joint: which joint, from 0.
        cycle: its limit cycle.

    Returns:
        Shapes (n,) and (n,), the second complex.
    """
    if cycle is not None:
        omega = np.geomspace(0.3 * cycle.omega, min(8.0 * cycle.omega, loop.fastest), _CURVE)
        return omega, cycle.curve(loop, joint, omega)
    omega = np.geomspace(LOWEST, loop.fastest, _CURVE)
    curve = loop.folded(omega) * loop.response(omega)[:, joint, joint]
    return (omega, curve) if np.any(curve) else (np.empty(0), np.empty(0, complex))


def balance_line(
    loop: SwitchingLoop, term: SwitchingTerm, joint: int, cycle: LimitCycle | None, curve: Array
) -> Array:
    """Return amplitudes A in [rad/s] and -1/N(A), from a small swing to past the crossing.

    Empty where there is no curve, and for super-twisting without a limit cycle, whose line depends
    on its frequency.

    Args:
        loop: the loop around the switching terms.
        term: these of all six joints.
        joint: which joint, from 0.
        cycle: its limit cycle.
        curve: its Nyquist curve. Shape (n,).

    Returns:
        Amplitudes, real parts, imaginary parts. Shape (3, m).
    """
    if not len(curve) or (cycle is None and term.twisting):
        return np.empty((3, 0))
    layer = float(term.layer[joint]) if term.has_layer else 0.0
    size = (layer or float(np.median(np.abs(curve)))) if cycle is None else cycle.crossing
    omega = loop.fastest if cycle is None else cycle.omega
    if cycle is not None and term.twisting:
        amplitudes = np.geomspace(1e-2, 4.0, _LINE) * cycle.amplitude
    elif layer == 0.0:
        amplitudes = np.geomspace(1e-2, 2.0, _LINE) * size
    else:
        amplitudes = np.geomspace(0.05 * layer, 3.0 * max(size, layer), _LINE)
    one = term.of([joint])
    passed = [one.describing_function(np.array([A]), omega, loop.hold)[0] for A in amplitudes]
    back = -1.0 / np.array(passed)
    return np.array([amplitudes, back.real, back.imag])
