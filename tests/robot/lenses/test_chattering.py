"""The chattering lens looks above the frequency that the experiment sets."""

from __future__ import annotations

import pytest

from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.lenses.chattering import ChatteringView, look
from slidetune.robot.loop.simulate import simulate


def seen(bound: float) -> ChatteringView:
    """Return what the lens shows of a lane that chatters, of torque above that bound [Hz]."""
    change = {"simulation": {"horizon": 0.5, "high_frequency": bound}}
    packed = pack(load_preset("chattering-sign").patched(change))
    run = simulate(packed.experiment, estimate=False)
    name = next(iter(run.lanes))
    return look(packed, name, run.lanes[name])


def test_a_higher_bound_leaves_less_torque_above_it() -> None:
    low, high = seen(40.0), seen(400.0)
    assert (low.limit, high.limit) == (40.0, 400.0)
    assert low.above is not None
    assert high.above is not None
    assert 0.0 < high.above < low.above
    assert low.switches == high.switches


def test_a_bound_that_the_rows_can_not_show_leaves_the_torque_above_it_unknown() -> None:
    view = seen(500.0)
    assert view.above is None
    assert all(joint.above is None for joint in view.joints)


@pytest.mark.parametrize("bound", [60.0, 200.0])
def test_squares_of_the_joints_add_up_above_every_bound(bound: float) -> None:
    view = seen(bound)
    squares = sum(joint.above**2 for joint in view.joints if joint.above is not None)
    assert view.above == pytest.approx(squares**0.5)
