r"""Torques that act later than a log has them: by a hold of a control period, a delay, a drive.

.. math:: \tau_{log}(t - d) = Y\theta \quad\Rightarrow\quad
    \tau_{log} \approx Y\theta + d\,\dot\tau_{log}

so that d is one number more of the linear equation, the same for all joints.
"""

from __future__ import annotations

import numpy as np

from slidetune.robot.identification.regressor import Equation
from slidetune.robot.identification.solving import Solution, half_widths

Array = np.ndarray

LEAST = 1e-4
"""Delay in [s] from which on it is taken into account (*ours*)."""


def lateness_of(equation: Equation, solution: Solution, fitted: Array) -> tuple[float, float]:
    """Return by how much torques act later than the log says, and half its 95 % interval, in [s].

    Args:
        equation: at every row.
        solution: its answer.
        fitted: which numbers were fitted. Shape (p,).

    Returns:
        Both 0 where the log can't tell.
    """
    rows, joints = equation.rate.shape
    rate = (equation.rate / solution.noise).reshape(-1, 1)
    slopes = solution.slopes[:, fitted]
    columns = np.column_stack([slopes, rate])
    scale = np.linalg.norm(columns, axis=0)
    if not scale.all() or np.linalg.matrix_rank(columns / scale) < len(scale):
        return 0.0, 0.0
    # What of the rate no other number explains, against what is left over.
    alone = rate[:, 0] - slopes @ np.linalg.lstsq(slopes, rate[:, 0], rcond=None)[0]
    residual = (solution.residual / solution.noise).reshape(-1)
    late = float(alone @ residual / (alone @ alone))
    left = residual - late * alone
    widths = half_widths(columns.reshape(rows, joints, -1), np.reshape(left, (rows, joints)))
    return late, float(widths[-1])
