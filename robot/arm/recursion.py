"""M(q) and h(q, v) of a serial chain in one compiled recursion.

Composite rigid bodies and Newton-Euler share one pass outwards. Every spatial vector is taken about
the origin of the base and in its axes: then nothing is carried from frame to frame, bodies add up
to composite ones, and an entry of M is one product of two vectors.
"""

from __future__ import annotations

from math import cos, sin

from slidetune.robot.kernels.compiler import inlined, kernel

# Columns of a chain, a row for each joint.
ROTATION = 0  # of the joint's frame in the one before, row by row; z is the joint's axis
PLACE = 9  # of the joint's frame in the one before [m]
MASS = 12  # of the joint's body [kg]
CENTRE = 13  # of the body in the joint's frame [m]
TENSOR = 16  # of the body about its centre: xx, xy, xz, yy, yz, zz [kg m^2]
ARMATURE = 22  # reflected inertia of the rotor [kg m^2, or kg where the joint slides]
SLIDES = 23  # 0 for a revolute joint, 1 for a prismatic one
CHAIN_COLUMNS = 24
# One more row holds the acceleration of free fall, in columns 0 to 2 [m/s^2].

# Columns of the memory that the recursion writes, a row for each joint: 0 to 5 the motion at a unit
# rate, angular, then linear at the origin; 6 to 11 what keeps the body on its motion, torque about
# the origin, then force; 12 the mass, 13 to 15 its first moment, 16 to 21 the inertia about the
# origin.
SCRATCH_COLUMNS = 22


@inlined
def _cross(a, b):  # type: ignore[no-untyped-def]
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def _plus(a, b):  # type: ignore[no-untyped-def]
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@inlined
def _times(s, a):  # type: ignore[no-untyped-def]
    return s * a[0], s * a[1], s * a[2]


@inlined
def _mixed(frame, a, b, c):  # type: ignore[no-untyped-def]
    """Return the vector with components a, b, c along a frame's axes."""
    x, y, z = frame
    return (
        x[0] * a + y[0] * b + z[0] * c,
        x[1] * a + y[1] * b + z[1] * c,
        x[2] * a + y[2] * b + z[2] * c,
    )


@inlined
def _turned(frame, numbers):  # type: ignore[no-untyped-def]
    """Return a tensor given along a frame's axes along those of the base."""
    xx, xy, xz, yy, yz, zz = numbers
    a, b, c = _mixed(frame, xx, xy, xz), _mixed(frame, xy, yy, yz), _mixed(frame, xz, yz, zz)
    x, y, z = frame
    return (
        a[0] * x[0] + b[0] * y[0] + c[0] * z[0],
        a[0] * x[1] + b[0] * y[1] + c[0] * z[1],
        a[0] * x[2] + b[0] * y[2] + c[0] * z[2],
        a[1] * x[1] + b[1] * y[1] + c[1] * z[1],
        a[1] * x[2] + b[1] * y[2] + c[1] * z[2],
        a[2] * x[2] + b[2] * y[2] + c[2] * z[2],
    )


@inlined
def _about_origin(moment, centre, about_centre):  # type: ignore[no-untyped-def]
    """Return a body's inertia about the origin (Steiner)."""
    x, y, z = moment[0] * centre[0], moment[1] * centre[1], moment[2] * centre[2]
    return (
        about_centre[0] + y + z,
        about_centre[1] - moment[0] * centre[1],
        about_centre[2] - moment[0] * centre[2],
        about_centre[3] + x + z,
        about_centre[4] - moment[1] * centre[2],
        about_centre[5] + x + y,
    )


@inlined
def _momentum(mass, moment, tensor, omega, velocity):  # type: ignore[no-untyped-def]
    """Return angular momentum about the origin and linear momentum of a body that moves."""
    xx, xy, xz, yy, yz, zz = tensor
    about = (
        xx * omega[0] + xy * omega[1] + xz * omega[2],
        xy * omega[0] + yy * omega[1] + yz * omega[2],
        xz * omega[0] + yz * omega[1] + zz * omega[2],
    )
    linear = _plus(_times(mass, velocity), _cross(omega, moment))
    return _plus(about, _cross(moment, velocity)), linear


@kernel
def chain_dynamics(chain, q, v, inertia, bias, scratch):  # type: ignore[no-untyped-def]
    r"""Write M and :math:`h = C\dot q + G` of a serial chain.

    .. math:: M_{ij} = S_i^T I^c_j S_j, \qquad
        h_j = S_j^T \sum_{k \ge j} (I_k A_k + V_k \times^* I_k V_k)

    with axes S, velocities V, accelerations A at :math:`\ddot q = 0` seen from free fall, inertias
    I and composite ones :math:`I^c` (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapters
    5 and 6).

    Args:
        chain: what ``pack_chain`` returned. Shape (n + 1, 24).
        q: joint angles in [rad], or displacements in [m]. Shape (n,).
        v: joint velocities in [rad/s], or [m/s]. Shape (n,).
        inertia: where M goes, with the armature. Shape (n, n).
        bias: where h goes in [N m], or [N]. Shape (n,).
        scratch: memory of its own. Shape (n, 22).
    """
    _outwards(chain, q, v, scratch)
    _inwards(chain, inertia, bias, scratch)


@inlined
def _outwards(chain, q, v, scratch):  # type: ignore[no-untyped-def]
    """Carry frame, velocity and acceleration from body to body; write axes, forces and bodies."""
    count, nothing = chain.shape[0] - 1, (0.0, 0.0, 0.0)
    frame = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    place, omega, velocity, alpha = nothing, nothing, nothing, nothing
    # To fall upwards is to feel the weight.
    acceleration = -chain[count, 0], -chain[count, 1], -chain[count, 2]
    for j in range(count):
        c, memory = chain[j], scratch[j]
        place = _plus(place, _mixed(frame, c[PLACE], c[PLACE + 1], c[PLACE + 2]))
        x, y, z = (
            _mixed(frame, c[0], c[3], c[6]),
            _mixed(frame, c[1], c[4], c[7]),
            _mixed(frame, c[2], c[5], c[8]),
        )
        if c[SLIDES] != 0.0:
            place = _plus(place, _times(q[j], z))
            axis, arm = nothing, z
        else:
            cosine, sine = cos(q[j]), sin(q[j])
            x, y = (
                _plus(_times(cosine, x), _times(sine, y)),
                _plus(_times(cosine, y), _times(-sine, x)),
            )
            axis, arm = z, _cross(place, z)
        frame = x, y, z
        joint_omega, joint_velocity = _times(v[j], axis), _times(v[j], arm)
        alpha = _plus(alpha, _cross(omega, joint_omega))
        bend = _plus(_cross(omega, joint_velocity), _cross(velocity, joint_omega))
        acceleration = _plus(acceleration, bend)
        omega, velocity = _plus(omega, joint_omega), _plus(velocity, joint_velocity)
        mass = c[MASS]
        centre = _plus(place, _mixed(frame, c[CENTRE], c[CENTRE + 1], c[CENTRE + 2]))
        moment = _times(mass, centre)
        tensor = _turned(frame, (c[TENSOR], c[17], c[18], c[19], c[20], c[21]))
        tensor = _about_origin(moment, centre, tensor)
        angular, linear = _momentum(mass, moment, tensor, omega, velocity)
        torque, force = _momentum(mass, moment, tensor, alpha, acceleration)
        torque = _plus(torque, _plus(_cross(omega, angular), _cross(velocity, linear)))
        force = _plus(force, _cross(omega, linear))
        memory[0], memory[1], memory[2] = axis
        memory[3], memory[4], memory[5] = arm
        memory[6], memory[7], memory[8] = torque
        memory[9], memory[10], memory[11] = force
        memory[12] = mass
        memory[13], memory[14], memory[15] = moment
        memory[16], memory[17], memory[18], memory[19], memory[20], memory[21] = tensor


@inlined
def _inwards(chain, inertia, bias, scratch):  # type: ignore[no-untyped-def]
    """Add up forces and bodies from the last joint to the first; write M and h."""
    nothing, mass = (0.0, 0.0, 0.0), 0.0
    torque, force, moment, high, low = nothing, nothing, nothing, nothing, nothing
    for j in range(chain.shape[0] - 2, -1, -1):
        own = scratch[j]
        axis, arm = (own[0], own[1], own[2]), (own[3], own[4], own[5])
        torque = _plus(torque, (own[6], own[7], own[8]))
        force = _plus(force, (own[9], own[10], own[11]))
        bias[j] = _dot(axis, torque) + _dot(arm, force)
        mass += own[12]
        moment = _plus(moment, (own[13], own[14], own[15]))
        high = _plus(high, (own[16], own[17], own[18]))
        low = _plus(low, (own[19], own[20], own[21]))
        tensor = high[0], high[1], high[2], low[0], low[1], low[2]
        about, along = _momentum(mass, moment, tensor, axis, arm)
        for i in range(j):
            other = scratch[i]
            entry = _dot(about, (other[0], other[1], other[2]))
            entry += _dot(along, (other[3], other[4], other[5]))
            inertia[i, j] = entry
            inertia[j, i] = entry
        inertia[j, j] = _dot(about, axis) + _dot(along, arm) + chain[j, ARMATURE]
