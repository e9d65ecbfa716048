"""A lane's whole horizon in one compiled call, bound to its arrays."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from slidetune.robot.arm.dynamics import chain_of
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.integrator.cutting import LOOSENESS
from slidetune.robot.integrator.horizon import STAGE, STOPPED, run_continuous, run_sampled
from slidetune.robot.integrator.kernel_arrays import TOLERANCE, kernel_table
from slidetune.robot.integrator.law_call import compiled_advance, compiled_law
from slidetune.robot.integrator.stages import FIRST, PLAIN, make_stage
from slidetune.robot.kernels.by_address import address_of
from slidetune.robot.kernels.for_joints import for_joints
from slidetune.robot.laws import law_of
from slidetune.robot.laws.law import Law
from slidetune.robot.loop.lane import Lane
from slidetune.robot.loop.steps import measures_apart

Array = np.ndarray
Rows = Callable[[Array, Array], int]
"""``make(rows, stop)``: makes the rows from ``rows[0]`` to ``rows[1]``; see ``run_continuous``."""


def load_law(law: Law, joints: int) -> None:
    """Compile or load what lanes of an arm with so many joints will call of a law.

    It takes long: away from the thread that steps them.
    """
    compiled_law(for_joints(law.control, joints))
    if law.advance is not None:
        compiled_advance(for_joints(law.advance, joints))


def bind_rows(lane: Lane, packed: Packed) -> Rows | None:
    """Return what makes a lane's rows, ``None`` where its arm can't be compiled.

    Args:
        lane: a lane that stands at the beginning.
        packed: the experiment as numbers.
    """
    if packed.chain is None or not packed.compiled:
        return None
    simulation, gains = packed.experiment.simulation, packed.experiment.lanes[lane.name]
    law = law_of(gains).used_by(gains)
    sampled = simulation.mode == "sampled"
    truth = nominal = chain_of(packed.chain)
    if measures_apart(law, packed) if sampled else law.model_based and packed.nominal is not None:
        nominal = chain_of(packed.chain if packed.nominal_chain is None else packed.nominal_chain)
    table = kernel_table(
        truth,
        nominal,
        packed.gains[lane.name],
        packed.environment,
        packed.trajectory,
        lane.work,
        lane.record,
        **law.kernels,
        step=simulation.arm_step,
        period=simulation.row_period,
        commands=lane.commands,
        delay=simulation.delay,
    )
    if sampled:
        run = for_joints(run_sampled, packed.joints)
        return lambda rows, stop: run(simulation.plant_substeps, rows, stop, table)
    cutting, first = lane.cutting, FIRST if simulation.scheme == "extrapolated" else PLAIN
    stage = address_of(for_joints(make_stage, packed.joints), STAGE)
    through = for_joints(run_continuous, packed.joints)
    table.view(np.float64)[TOLERANCE] = cutting[LOOSENESS]
    return lambda rows, stop: through(stage, first, rows, stop, cutting, table)


def stepped_rows(lane: Lane, packed: Packed) -> Rows:
    """Return the same by single steps over Pinocchio."""
    step, period = lane.step, packed.experiment.simulation.row_period

    def make(rows: Array, stop: Array) -> int:
        for row in range(int(rows[0]), int(rows[1])):
            rows[0] = row
            if stop[0]:
                return STOPPED
            bad = step(row * period, row, row)
            if bad:
                return bad
        rows[0] = rows[1]
        return 0

    return make
