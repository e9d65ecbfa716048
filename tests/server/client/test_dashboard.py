"""A running dashboard from Python."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import slidetune
from slidetune.robot.errors import InvalidExperimentError
from slidetune.server.client.dashboard import Dashboard
from slidetune.server.client.refusal import DashboardError
from slidetune.server.client.telemetry import joined
from tests.server.conftest import Served, free_socket, serving
from tests.server.scene.viser_client import until

OWN = {"e", "de", "tau", "S", "f", "weights"}


@pytest.fixture
def dashboard(served: Served) -> Iterator[Dashboard]:
    with slidetune.connect(served.url) as dashboard:
        yield dashboard


def test_a_patch_does_what_a_slider_does_and_a_bad_one_names_its_fields(
    dashboard: Dashboard, served: Served
) -> None:
    (name, *_) = dashboard.experiment.lanes
    changed = dashboard.patch({"simulation": {"horizon": 3.5}})
    assert changed.simulation.horizon == 3.5
    assert served.app_state.document.experiment == changed == dashboard.experiment
    with pytest.raises(InvalidExperimentError) as caught:
        dashboard.patch({"lanes": {name: {"k1": -1}}, "simulation": {"horizon": "long"}})
    refused = {field.path for field in caught.value.fields}
    assert refused == {f"lanes.{name}.k1", "simulation.horizon"}
    assert dashboard.experiment == changed


def test_presets_and_experiments_begin_at_time_0(dashboard: Dashboard, served: Served) -> None:
    assert dashboard.load("realistic") == slidetune.load_preset("realistic")
    paper = slidetune.load_preset("paper")
    assert dashboard.replace(paper) == paper
    dashboard.pause()
    dashboard.reset()
    until(lambda: served.http.get("/api/session").json()["time"] == 0)
    with pytest.raises(DashboardError, match="no preset 'papers'") as caught:
        dashboard.load("papers")
    assert caught.value.status == 404


def test_telemetry_comes_as_arrays_of_one_row_a_period(dashboard: Dashboard) -> None:
    experiment = dashboard.experiment
    dashboard.play()
    rows = dashboard.record(0.5)
    dashboard.pause()
    count = len(rows.time)
    period = experiment.simulation.row_period
    assert np.allclose(np.diff(rows.time), period)
    assert rows.time[-1] - rows.time[0] >= 0.5
    assert rows.lanes.keys() == experiment.lanes.keys()
    for lane in rows.lanes.values():
        assert lane.keys() >= OWN
        assert lane["e"].shape == lane["tau"].shape == (count, 6)
        assert lane["flange"].shape == (count, 3)
        assert np.isfinite(lane["e"]).all()
    # e = q_d - q, and its derivative.
    assert rows.shared["q_d"].shape == (count, 6)
    drift = np.gradient(rows.shared["q_d"], period, axis=0)[5:-5] - rows.shared["v_d"][5:-5]
    assert np.abs(drift).max() < 1e-2
    with pytest.raises(ValueError, match="no rows"):
        joined([])


def test_a_whole_response_is_that_of_a_run_here(dashboard: Dashboard) -> None:
    patch = {"simulation": {"horizon": 1.0}}
    run = slidetune.simulate(dashboard.experiment.patched(patch))
    response = dashboard.preview(patch)
    assert response.horizon == 1.0
    for name, lane in response.lanes.items():
        own = run.lanes[name]
        assert np.allclose(lane.metrics["mae"], own.metrics.mae, rtol=1e-9)
        assert lane.columns["e"].shape == (len(lane.time), 6)
        for quantity, rows in (("e", own.e), ("tau", own.tau), ("S", own.S)):
            for extreme in (np.min, np.max):
                thinned = extreme(lane.columns[quantity], axis=0)
                assert np.allclose(thinned, extreme(rows, axis=0), rtol=1e-6)
    assert dashboard.metrics()["lanes"].keys() == response.lanes.keys()


def test_the_token_is_that_of_the_address(tmp_path_factory: pytest.TempPathFactory) -> None:
    with serving(tmp_path_factory.mktemp("presets"), token=True) as served:
        with slidetune.connect(f"{served.url}?token={served.policy.token}") as owner:
            owner.patch({"simulation": {"horizon": 2}})
            owner.play()
            assert len(owner.record(0.01).time)
        with slidetune.connect(served.url, served.policy.viewer_token) as viewer:
            assert viewer.experiment.simulation.horizon == 2
            with pytest.raises(DashboardError, match="You are watching") as caught:
                viewer.patch({"simulation": {"horizon": 3}})
            assert caught.value.code == "watch_only"
        with pytest.raises(DashboardError) as caught:
            slidetune.connect(served.url)
        assert caught.value.status == 401


def test_what_is_no_dashboard_is_said() -> None:
    closed = free_socket("127.0.0.1", 0)
    port = closed.getsockname()[1]
    closed.close()
    with pytest.raises(DashboardError, match="no Slidetune answers"):
        slidetune.connect(f"http://127.0.0.1:{port}")
    for address in ("", "ftp://127.0.0.1", "http://"):
        with pytest.raises(DashboardError, match="is no address"):
            slidetune.connect(address)
