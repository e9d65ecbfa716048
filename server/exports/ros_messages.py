"""How messages of ROS 2 are laid out, as its packages of the same names define them (Humble)."""

from __future__ import annotations

_STAMP = """\
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
_HEADER = (
    """\
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
"""
    + _STAMP
)
JOINT_STATE = (
    """\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
"""
    + _HEADER
)
POSE_STAMPED = (
    """\
std_msgs/Header header
geometry_msgs/Pose pose
================================================================================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
"""
    + _HEADER
)
NUMBERS = """\
std_msgs/MultiArrayLayout layout
float64[] data
================================================================================
MSG: std_msgs/MultiArrayLayout
std_msgs/MultiArrayDimension[] dim
uint32 data_offset
================================================================================
MSG: std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride
"""
TEXT = "string data\n"
DEFINITIONS = {
    "sensor_msgs/msg/JointState": JOINT_STATE,
    "geometry_msgs/msg/PoseStamped": POSE_STAMPED,
    "std_msgs/msg/Float64MultiArray": NUMBERS,
    "std_msgs/msg/String": TEXT,
}
