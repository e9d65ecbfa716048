"""An experiment as the numbers that the kernels take."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.arm import build_arm, nominal_arm
from slidetune.robot.environment.layout import pack_environment
from slidetune.robot.errors import FieldError, InvalidExperimentError, UnreachableError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.motion.circle import follow_circle
from slidetune.robot.motion.trajectory import CircleTrajectory, pack_trajectory

Array = np.ndarray


@dataclass(frozen=True)
class Packed:
    """An experiment ready to step; made away from the thread that steps it.

    Attributes:
        experiment: where it comes from.
        trajectory: see ``pack_trajectory``.
        environment: see ``pack_environment``.
        gains: numbers of each lane's law.
        model: the true arm.
        nominal: the arm that model-based laws know, ``None`` where it is the true one.
        chain: the true arm for the compiled recursion, ``None`` where that does not agree with
            Pinocchio.
        nominal_chain: the same of the nominal arm.
        places: the true arm for ``flange_positions``.
    """

    experiment: Experiment
    trajectory: Array
    environment: Array
    gains: dict[str, Array]
    model: pin.Model
    nominal: pin.Model | None
    chain: Array | None
    nominal_chain: Array | None
    places: Array

    @property
    def joints(self) -> int:
        """How many joints the arm has."""
        return int(self.model.nv)

    @property
    def compiled(self) -> bool:
        """Whether its arms are chains, so that a whole run is one compiled call."""
        lacks_nominal = self.nominal is not None and self.nominal_chain is None
        return self.chain is not None and not lacks_nominal


def pack(experiment: Experiment) -> Packed:
    """Turn an experiment into numbers.

    Raises:
        InvalidExperimentError: if the arm can't follow the trajectory.
    """
    trajectory, robot, turn = experiment.trajectory, experiment.robot, None
    if isinstance(trajectory, CircleTrajectory):
        try:
            turn = follow_circle(trajectory, robot.model)
        except UnreachableError as error:
            value = getattr(trajectory, error.field)
            refused = FieldError(f"trajectory.{error.field}", str(error), value)
            raise InvalidExperimentError([refused]) from error
    truth = build_arm(robot)
    joints = truth.model.nv
    environment = pack_environment(
        experiment.disturbance,
        robot.viscous_friction,
        robot.coulomb_friction,
        robot.torque_limit,
        robot.lag,
        2 if robot.lag_order == "second" else 1,
        joints,
    )
    nominal = nominal_arm(robot, experiment.disturbance.nominal_mismatch)
    return Packed(
        experiment=experiment,
        trajectory=pack_trajectory(trajectory, turn, joints),
        environment=environment,
        gains={name: lane.pack(joints) for name, lane in experiment.lanes.items()},
        model=truth.model,
        nominal=None if nominal is None else nominal.model,
        chain=truth.chain,
        nominal_chain=None if nominal is None else nominal.chain,
        places=truth.places,
    )
