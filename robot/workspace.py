"""Rows of the arrays that the compiled kernels share.

A numba call pays for every argument, so that one lane's numbers live in few arrays of six columns,
one column a joint. This module names their rows; nothing else knows where a number lies.
"""

from __future__ import annotations

from robot.quantity import JOINTS

NODES = 10
"""Gaussians per joint (*published*)."""

# --- the state: angle, velocity, weights -------------------------------------------------------
Q = 0  # joint angle [rad]
V = 1  # joint velocity [rad/s]
W = 2  # network weights, NODES rows
STATE_ROWS = 2 + NODES

CURRENT = 0  # state at the beginning of the step
FULL = STATE_ROWS  # after one whole step
HALF = 2 * STATE_ROWS  # after half a step

# --- one evaluation of the loop ----------------------------------------------------------------
QD = 3 * STATE_ROWS  # desired angle [rad]
VD = QD + 1  # desired velocity [rad/s]
AD = QD + 2  # desired acceleration [rad/s^2]
F = QD + 3  # torque lost to the world: disturbance and friction [N m]
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
HELD = QD + 19  # marks of the joints whose torque is at its limit: -1, 0, 1
FLAGS = QD + 20  # [0]: whether SHAPE is in use
HIDDEN = QD + 21  # hidden outputs, NODES rows
SHAPE = HIDDEN + NODES  # 6 x 6 matrix between reaching law and torque, where FLAGS[0] is set
MATRIX = SHAPE + JOINTS  # 6 x 6 system matrix of the implicit step
RIGHT = MATRIX + JOINTS  # its right-hand side
LEARNT = RIGHT + 1  # what a step adds to the weight of a node that is fully active [N m]
KEPT = RIGHT + 2  # share of a weight that a step leaves [-]
WORK_ROWS = RIGHT + 3

# --- one recorded row of a lane: groups of six columns -----------------------------------------
RECORD = ("q", "v", "tau", "S", "f", "weights", "q_d", "v_d")
RECORD_COLUMNS = len(RECORD) * JOINTS
