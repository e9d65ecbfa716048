"""A whole run, to be exported."""

from __future__ import annotations

from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from slidetune.robot.loop.simulate import Run
from slidetune.server.exports.recorded import GROUPS, Recorded, Said


def recorded_run(run: Run) -> Recorded:
    """Return every row of a run; rows after a lane left its bounds are NaN there."""
    first = next(iter(run.lanes.values()))
    names = [name for name, _ in GROUPS] + ["flange"]
    return Recorded(
        experiment=run.experiment.document(),
        yaml=experiment_to_yaml(run.experiment),
        time=run.time,
        revision=None,
        desired={"q_d": run.q_d, "v_d": run.v_d, "flange_d": first.flange_desired},
        lanes={
            name: {group: getattr(lane, group) for group in names}
            for name, lane in run.lanes.items()
        },
        remarks=tuple(
            Said(lane.freeze.time, name, {"remark": lane.freeze.cause})
            for name, lane in run.lanes.items()
            if lane.freeze is not None
        ),
    )
