"""Tries a law from a file of one's own in every way in which it will be used, and adds it."""

from __future__ import annotations

import numpy as np

from slidetune.robot.arm.dynamics import dynamics
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.kernels.workspace import MEASURED_Q, MEASURED_V, QD, RECORD, TAU, VD, WORK_ROWS
from slidetune.robot.law_files.fitted import Document, fitted
from slidetune.robot.law_files.law_file import law_from
from slidetune.robot.law_files.refused import LawFileError, refused_by
from slidetune.robot.law_files.source import Source
from slidetune.robot.laws import LAWS, register
from slidetune.robot.laws.law import Law
from slidetune.robot.loop.lane import Lane
from slidetune.robot.loop.response import lane_response
from slidetune.robot.margins.margin import loop_margin
from slidetune.robot.motion.trajectory import reference

SPAN = 1.0
"""Longest time that is tried of an experiment in [s] (*ours*)."""
_MODES = ("continuous", "sampled")


def take_law(source: Source, name: str = "", document: Document | None = None) -> Law:
    """Read a law from its own file, try it, and add it to the laws that there are.

    Args:
        source: the content of the file.
        name: name of the law so far, where the file is read again.
        document: an experiment in which it has to do as well, over its first second.

    Raises:
        LawFileError: with the lines of the file that are to blame; no law is changed then.
    """
    law = law_from(source, name)
    before = LAWS.get(law.name)
    register(law)
    try:
        _try(law, source.name, document)
    except Exception as error:
        # Not before it is added: a lane finds its law by name.
        del LAWS[law.name]
        if before is not None:
            LAWS[law.name] = before
        raise refused_by(error, source.name, source.path) from error
    return law


def _try(law: Law, file: str, document: Document | None) -> None:
    for mode in _MODES:
        simulation = {"mode": mode, "horizon": 0.1, "step": 0.005, "control_rate": 200.0}
        own = {"lanes": {"A": {"law": law.name}}, "simulation": simulation}
        packed = pack(Experiment.from_document(own))
        _ask(law, packed, file)
        _step(packed, "A")
        lane_response(packed.experiment, "A")
        loop_margin(packed, "A")
    if document is not None:
        experiment = Experiment.from_document(fitted(document, law)[0])
        packed = pack(experiment)
        for name, lane in experiment.lanes.items():
            if lane.law == law.name:
                _step(packed, name)


def _ask(law: Law, packed: Packed, file: str) -> None:
    """Ask a law once, in plain Python first: what is wrong there, that tells with its line.

    One that leaves a torque as it was is refused: it would be another law's.
    """
    work = np.zeros((WORK_ROWS, packed.joints))
    reference(0.0, packed.trajectory, work)
    work[MEASURED_Q], work[MEASURED_V], work[TAU] = work[QD], work[VD], np.nan
    arm = dynamics(packed.model, work[MEASURED_Q], work[MEASURED_V])
    arm.refill()
    plain = getattr(law.control, "py_func", law.control)
    plain(0, packed.gains["A"], arm.inertia, arm.bias, work)
    if np.isnan(work[TAU]).any():
        joints = ", ".join(str(joint + 1) for joint in np.flatnonzero(np.isnan(work[TAU])))
        text = f"control wrote no torque to work[TAU] for joint {joints}, or one that is no number"
        raise LawFileError(file, text)


def _step(packed: Packed, name: str) -> None:
    """Step a lane for a while; what its law raises comes through."""
    period = packed.experiment.simulation.row_period
    lane = Lane(name, packed, np.zeros((2, len(RECORD), packed.joints)))
    for number in range(round(min(packed.experiment.simulation.horizon, SPAN) / period) + 1):
        if lane.step(number * period, number, number % 2):
            return  # it left its bounds, as any law may
