"""Rows of the arrays that the compiled kernels share.

A numba call pays for every argument, so that one lane's numbers live in few arrays, one column a
joint. This module names their rows; nothing else knows where a number lies. Rows are the same for
every arm; a number that belongs to no joint has a row of its own and stands in column 0.
"""

from __future__ import annotations

from itertools import accumulate

from slidetune.robot.fields.quantity import MOST_JOINTS

NODES = 10
"""Gaussians per joint (*published*)."""

# --- the state: angle, velocity, weights -------------------------------------------------------
Q = 0  # joint angle [rad]
V = 1  # joint velocity [rad/s]
W = 2  # network weights, NODES rows; of a law without a network its memory, from the first on
DELIVERED = W + NODES  # torque at the joint, behind a drive with a lag [N m]
BETWEEN = DELIVERED + 1  # torque between two lags in series [N m]
STATE_ROWS = 16  # two rows more than there are: so all three states lie alike in cache lines

CURRENT = 0  # state at the beginning of the step
FULL = STATE_ROWS  # after one whole step
HALF = 2 * STATE_ROWS  # after half a step

# --- one evaluation of the loop ----------------------------------------------------------------
QD = 3 * STATE_ROWS  # desired angle [rad]
VD = QD + 1  # desired velocity [rad/s]
AD = QD + 2  # desired acceleration [rad/s^2]
F = QD + 3  # torque that a joint loses: disturbance and friction [N m]
F_SLOPE = QD + 4  # dF/dv [N m s/rad]
PUSH = QD + 5  # torque by which a person pushes the arm [N m], set from outside
TAU = QD + 6  # controller torque [N m]
S = QD + 7  # sliding variable [rad/s]
S_V = QD + 8  # dS/d(de)
S_E = QD + 9  # dS/de [1/s]
GAIN = QD + 10  # slope of the reaching law at S [N m s/rad]
NETWORK = QD + 11  # network output f [N m]
NETWORK_SLOPE = QD + 12  # phi * sum of squared hidden outputs
LEARNING = QD + 13  # learning rate phi
LEAKAGE = QD + 14  # leakage sigma [1/s]
MEASURED_Q = QD + 15  # angle that the controller sees [rad]
MEASURED_V = QD + 16  # velocity that the controller sees [rad/s]
APPLIED = QD + 17  # torque that reaches the joints [N m]
REACH = QD + 18  # reaching law, before SHAPE [N m, or rad/s^2 where SHAPE is an inertia]
SHAPED = QD + 19  # whether SHAPE is in use
HOLD = QD + 20  # whether the torque is APPLIED, held, whatever S does
HELD = QD + 21  # whether a joint is SLIDING
BENDS = QD + 22  # whether SHAPE is divided by S_V and so changes with the velocity
CURVED = QD + 23  # how the step was solved: BY_TANGENTS, BY_NEW_TANGENTS, BY_CURVES
PERIOD = QD + 24  # control period [s], 0 in continuous mode
HIDDEN = QD + 25  # hidden outputs, NODES rows
SHAPE = HIDDEN + NODES  # n x n matrix between reaching law and torque, where SHAPED is set
CURVE = SHAPE + MOST_JOINTS  # the reaching law itself, CURVE_ROWS: see laws/terms/switching.py
CURVE_ROWS = 7
TERMINAL_C = CURVE + CURVE_ROWS  # c of the terminal surface, where BENDS is set
TERMINAL_MU = TERMINAL_C + 1  # its mu
TERMINAL_RATIO = TERMINAL_C + 2  # its p/k
DRIFT = TERMINAL_C + 3  # rate at which S changes apart from the motion [rad/s^2]

# --- one implicit step ---------------------------------------------------------------------------
MATRIX = DRIFT + 1  # n x n system matrix
RIGHT = MATRIX + MOST_JOINTS  # its right-hand side
DIAGONAL = RIGHT + 1  # its diagonal, before elimination
ACCELERATION = RIGHT + 2  # a: acceleration over the step [rad/s^2]
S_FREE = RIGHT + 3  # S at the end of the step if a were 0 [rad/s]
S_FALL = RIGHT + 4  # by how much S at the end falls per unit of a [s]
GIVEN = RIGHT + 5  # torque of the controller without its reaching law [N m]
LOST = RIGHT + 6  # torque that a joint loses without Coulomb friction [N m]
LOAD = RIGHT + 7  # torque that a joint's own curve is asked to balance [N m]
YIELD = RIGHT + 8  # da/d(LOAD) of a joint alone: 0 where it is held on its surface
RESIDUAL = RIGHT + 9  # what the equation of a joint leaves [N m]
SLIDING = RIGHT + 10  # whether a joint is held on S = 0 by a set-valued torque
HELD_TORQUE = RIGHT + 11  # the torque that holds it there [N m]
LEARNT = RIGHT + 12  # what a step adds to the weight of a node that is fully active [N m]
KEPT = RIGHT + 13  # share of a weight that a step leaves [-]
TRIAL = RIGHT + 14  # a backup of LOAD while a Newton step is tried [N m]
DISTURBANCE = RIGHT + 15  # mean of the disturbance over the step, less the push [N m]
DISTURBANCE_HALF = RIGHT + 16  # the same over its first half, where that differs [N m]
WITHHELD = RIGHT + 17  # share of a command that a lag does not deliver within the step [-]
CARRIED = RIGHT + 18  # what it delivers in its place, of the torques before [N m]
COMMAND = RIGHT + 19  # the controller's torque at the end of the step, within its limit [N m]
REACHED = RIGHT + 20  # what sign(S) gives a joint that it holds on S = 0, before SHAPE [as REACH]

# --- what a lane remembers of its steps ----------------------------------------------------------
CHANGE_Q = REACHED + 1  # (y_half - y_full)/h^2 of the last accepted step, angles [rad/s^2]
CHANGE_V = CHANGE_Q + 1  # the same of the velocities [rad/s^3]
KNOWN = CHANGE_Q + 2  # whether CHANGE holds something
UNSOLVED = CHANGE_Q + 3  # steps whose equation was not solved to its tolerance
LEFT = CHANGE_Q + 4  # what the equations of one step left at most [rad/s]
CAPPED = CHANGE_Q + 5  # rows in which the step was not cut as far as its error asked
CUT = CHANGE_Q + 6  # rows in which the step was cut
MEMORY_ROWS = 7  # CHANGE_Q to CUT: what a lane's next step depends on besides its state
WRONG = CHANGE_Q + 7  # error of the last step as a multiple of what it may be
OVER = CHANGE_Q + 8  # the same of the parts of a row that could not be cut further
PASSED = CHANGE_Q + 9  # velocity that a passage through a thin layer leaves open [rad/s]
EDGE = CHANGE_Q + 10  # whether a pulse begins or ends within the step
RESIGNED = CHANGE_Q + 11  # whether a step that isn't solved may not be cut any more
OBSERVED = CHANGE_Q + 12  # r: estimate of a disturbance observer of -F [N m]
WORK_ROWS = CHANGE_Q + 13

# --- one recorded row of a lane: groups, each with a number a joint -----------------------------
RECORD = ("q", "v", "tau", "S", "f", "weights", "q_d", "v_d")
R_Q, R_V, R_TAU, R_S, R_F, R_WEIGHTS, R_QD, R_VD = range(len(RECORD))


# --- the gains of a lane: blocks of rows, one below the other ------------------------------------
def stacked(*rows: int) -> tuple[slice, ...]:
    """Return where each block lies in an array of blocks with that many rows each."""
    ends = list(accumulate(rows))
    return tuple(slice(end - count, end) for end, count in zip(ends, rows, strict=True))
