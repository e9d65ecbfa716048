"""The network lens agrees with the run that it looks at, and with the needed torque."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.kernels.workspace import NODES
from slidetune.robot.lenses import network_view
from slidetune.robot.lenses.probe import Probe
from slidetune.robot.loop.simulate import LaneRun, simulate

LANE = "A"


def experiment(lane: dict[str, Any], **sections: Any) -> Experiment:
    simulation = {"horizon": 2.0, **sections.pop("simulation", {})}
    return Experiment.from_document({"lanes": {LANE: lane}, "simulation": simulation, **sections})


def ran(one: Experiment) -> tuple[Packed, LaneRun]:
    return pack(one), simulate(one).lanes[LANE]


@pytest.fixture(scope="module")
def learning() -> tuple[Packed, LaneRun]:
    """A network that is narrow enough to tell its inputs apart."""
    lane = {"law": "rbfnn_nftsm", "width": 0.3, "network_input": "desired", "nu": 5.0}
    return ran(experiment(lane, disturbance={"constant": [-22.5, -33.0, -20.0, 0, 0, 0]}))


def test_weights_and_hidden_outputs_give_the_networks_last_output(learning: Any) -> None:
    packed, run = learning
    gains = packed.experiment.lanes[LANE]
    inputs = network_view.visited_inputs(gains, run)
    for j in range(6):
        hidden = network_view.hidden_outputs(inputs[-1:, j], gains.centers(), gains.width)
        # The weights are those after the last step, one step later than the recorded output.
        output = hidden[0] @ run.final_weights[:, j]
        assert output == pytest.approx(run.f[-1, j], rel=2e-3, abs=0.02)


def test_norms_of_the_final_weights_continue_the_recorded_ones(learning: Any) -> None:
    _, run = learning
    norms = np.linalg.norm(run.final_weights, axis=0)
    assert run.final_weights.shape == (NODES, 6)
    assert norms == pytest.approx(run.weights[-1], rel=1e-2)


def test_needed_torque_is_what_the_exact_model_applies_on_its_surface(undisturbed: Any) -> None:
    """NFTSM knows the arm, so that without a disturbance S stays 0 and tau is the needed torque."""
    one = undisturbed.experiment.patched(
        {
            "lanes": {"RBFNN-NFTSM": None, "RBFNN-SMC": None},
            "simulation": {"horizon": 1.0, "initial_velocity": "desired"},
        }
    )
    packed, run = pack(one), simulate(one)
    lane, probe = run.lanes["NFTSM"], Probe(packed, "NFTSM")
    for row in (10, 300, 900):
        needed = probe.needed_torque(float(run.time[row]), lane.q[row], lane.v[row])
        assert needed == pytest.approx(lane.tau[row], abs=1e-3)


def test_needed_torque_holds_the_disturbance_and_the_friction() -> None:
    lane = {"law": "nftsm"}
    free = pack(experiment(lane))
    rough = pack(
        experiment(
            lane,
            disturbance={"constant": -20.0},
            robot={"viscous_friction": 2.0, "coulomb_friction": 3.0},
        )
    )
    q, v = np.linspace(-1.0, 1.0, 6), np.linspace(-1.0, 1.0, 6)
    extra = Probe(rough, LANE).needed_torque(0.3, q, v) - Probe(free, LANE).needed_torque(0.3, q, v)
    assert extra == pytest.approx(-20.0 + 2.0 * v + 3.0 * np.tanh(v / 0.02))


def test_learnt_share_compares_f_with_the_needed_torque(learning: Any) -> None:
    packed, run = learning
    view = network_view.look(packed, LANE, run)
    assert view is not None
    assert view.input == "desired"
    for j, joint in enumerate(view.joints):
        rows = np.searchsorted(run.time, view.torque_time)
        assert np.array_equal(joint.f, run.f[rows, j])
        late = rows >= len(run.time) // 2
        missing = np.sqrt(np.mean((joint.needed - joint.f)[late] ** 2))
        assert joint.missing_rms == pytest.approx(missing)
        assert joint.learnt == pytest.approx(1.0 - missing / joint.needed_rms)


def test_a_wide_network_is_one_node_and_a_narrow_one_tells_inputs_apart(learning: Any) -> None:
    packed, run = learning
    narrow = network_view.look(packed, LANE, run)
    wide_packed = pack(packed.experiment.patched({"lanes": {LANE: {"width": 10.0}}}))
    wide = network_view.look(wide_packed, LANE, run)
    assert narrow is not None
    assert wide is not None
    assert wide.joints[0].effective_nodes == pytest.approx(1.0, abs=1e-3)
    assert wide.joints[0].spread < 0.05
    assert narrow.joints[0].effective_nodes > 1.5
    assert narrow.joints[0].spread > 0.5


def test_coverage_falls_where_inputs_leave_the_centres(learning: Any) -> None:
    packed, run = learning
    patch = {"lanes": {LANE: {"width": 0.05, "center_span": 0.4}}}
    view = network_view.look(pack(packed.experiment.patched(patch)), LANE, run)
    assert view is not None
    desired = run.q[:, 0] + run.e[:, 0]
    reach = 0.05 * np.sqrt(2.0 * np.log(10.0))
    apart = np.abs(desired[:, None] - view.centers).min(axis=1)
    assert view.joints[0].coverage == pytest.approx(np.mean(apart < reach))
    assert 0.0 < view.joints[0].coverage < 1.0


def test_visits_are_shares_of_the_run(learning: Any) -> None:
    packed, run = learning
    view = network_view.look(packed, LANE, run)
    assert view is not None
    for joint in view.joints:
        assert joint.visits.sum() == pytest.approx(1.0)
        assert joint.low <= joint.high


def test_as_many_nodes_act_however_faint_they_are() -> None:
    hidden = np.random.default_rng(1).uniform(size=(50, NODES))
    nodes = network_view.effective_nodes(hidden)
    assert 1.0 < nodes < NODES
    for scale in (1e-40, 1e-90, 1e-150):
        assert network_view.effective_nodes(scale * hidden) == pytest.approx(nodes)
    assert network_view.effective_nodes(0.0 * hidden) == 0.0


def test_an_input_that_moves_by_a_rounding_error_stands_still(learning: Any) -> None:
    packed, run = learning
    angles = np.full_like(run.q, 0.3)
    angles[::2] = np.nextafter(0.3, 1.0)
    patch = {"lanes": {LANE: {"network_input": "angle"}}}
    still = replace(run, q=angles)
    view = network_view.look(pack(packed.experiment.patched(patch)), LANE, still)
    assert view is not None
    assert all(joint.visits.tolist() == [1.0] for joint in view.joints)


def test_a_law_without_a_network_has_nothing_to_show() -> None:
    packed, run = ran(experiment({"law": "nftsm"}, simulation={"horizon": 0.1}))
    assert network_view.look(packed, LANE, run) is None
