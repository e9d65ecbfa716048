"""The disturbance's section of an experiment: torques, a wrong nominal model, sensor noise."""

from __future__ import annotations

from slidetune.robot.fields.quantity import Integer, Number, PerJoint, Section, field


class SineTorque(Section):
    """A sinusoidal torque."""

    amplitude: PerJoint = field(
        0.0,
        title="Amplitude",
        symbol="F_sine",
        unit="N·m",
        low=-200.0,
        high=200.0,
        step=0.5,
        meaning="Amplitude of the sinusoidal torque.",
    )
    frequency: Number = field(
        1.0,
        title="Frequency",
        symbol="f",
        unit="Hz",
        low=0.01,
        high=100.0,
        step=0.01,
        scale="log",
        meaning="Cycles per second.",
    )
    phase: Number = field(
        0.0,
        title="Phase",
        unit="rad",
        low=-3.1416,
        high=3.1416,
        step=0.01,
        meaning="Phase at t = 0.",
    )


class PulseTorque(Section):
    """A rectangular torque pulse."""

    amplitude: PerJoint = field(
        0.0,
        title="Height",
        symbol="F_pulse",
        unit="N·m",
        low=-200.0,
        high=200.0,
        step=0.5,
        meaning="Torque during the pulse.",
    )
    start: Number = field(
        3.0,
        title="Start",
        unit="s",
        low=0.0,
        high=60.0,
        step=0.1,
        meaning="Start of the first pulse.",
    )
    duration: Number = field(
        0.5,
        title="Duration",
        unit="s",
        low=0.001,
        high=60.0,
        step=0.01,
        scale="log",
        meaning="Length of a pulse.",
    )
    period: Number = field(
        0.0,
        title="Period",
        unit="s",
        low=0.0,
        high=60.0,
        step=0.1,
        meaning="Time from one pulse to the next; 0 for a single one.",
    )


class NoiseTorque(Section):
    """A random torque of limited bandwidth."""

    amplitude: PerJoint = field(
        0.0,
        title="Root mean square",
        symbol="F_noise",
        unit="N·m",
        low=0.0,
        high=100.0,
        step=0.1,
        meaning="RMS value of the noise torque.",
    )
    bandwidth: Number = field(
        10.0,
        title="Bandwidth",
        unit="Hz",
        low=0.1,
        high=200.0,
        step=0.1,
        scale="log",
        meaning="Highest frequency in the noise.",
    )


class SensorNoise(Section):
    """White noise on the measured angles and velocities, in sampled mode."""

    position: Number = field(
        0.0,
        title="Angle noise",
        unit="rad",
        low=0.0,
        high=0.01,
        step=0.00001,
        applies="sampled",
        meaning="Standard deviation of every angle sample.",
    )
    velocity: Number = field(
        0.0,
        title="Velocity noise",
        unit="rad/s",
        low=0.0,
        high=0.5,
        step=0.0001,
        applies="sampled",
        meaning="Standard deviation of every velocity sample.",
    )


class Disturbance(Section):
    """Everything that the controller does not know."""

    constant: PerJoint = field(
        0.0,
        title="Constant torque",
        symbol="F",
        unit="N·m",
        low=-200.0,
        high=200.0,
        step=0.5,
        equation="Eq. 1",
        source="inferred",
        meaning="Constant disturbance torque, opposing τ.",
    )
    sine: SineTorque = SineTorque()
    pulse: PulseTorque = PulseTorque()
    noise: NoiseTorque = NoiseTorque()
    nominal_mismatch: Number = field(
        1.0,
        title="Nominal model",
        symbol="M̂/M",
        low=0.1,
        high=3.0,
        step=0.01,
        meaning="Masses and inertias of the nominal model, which model-based laws compute with, "
        "relative to those of the arm.",
    )
    sensor_noise: SensorNoise = SensorNoise()
    seed: Integer = field(
        1,
        title="Seed",
        low=0,
        high=2**31 - 1,
        step=1,
        meaning="The same seed gives the same noise: a run can be repeated bit for bit.",
    )
