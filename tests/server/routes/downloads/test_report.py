"""A report over HTTP, through a real server and a process of its own."""

from __future__ import annotations

import json
import re
import shlex
from html import unescape

from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.law_files.law_file import law_from
from slidetune.robot.law_files.source import Source
from slidetune.robot.laws import register
from slidetune.robot.loop.simulate import simulate
from slidetune.server.guard.limits import MAX_REPORTS
from slidetune.server.report.run_report import json_text, report
from tests.own_laws import EXAMPLE, own_laws
from tests.server.conftest import Served

SHORT = {"simulation": {"horizon": 0.3, "mode": "sampled"}, "title": "Mine"}


def test_it_is_of_the_live_experiment_with_a_command_that_repeats_it(served: Served) -> None:
    served.http.post("/api/presets/paper/load").raise_for_status()
    served.http.patch("/api/experiment", json=SHORT).raise_for_status()
    live = served.app_state.document.experiment
    answer = served.http.post("/api/report", json={"since": 0.1}, timeout=180.0)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    assert answer.headers["content-disposition"] == 'attachment; filename="report.html"'
    assert "<h1>Mine</h1>" in answer.text
    assert 'id="replay-data"' in answer.text
    command = re.search(r'<code id="command">(.*?)</code>', answer.text)
    data = re.search(r'id="report">(.*?)</script>', answer.text, re.DOTALL)
    assert command is not None
    assert data is not None
    words = shlex.split(unescape(command[1]))
    assert words[5:] == ["--since", "0.1", "--report", "report.html"]
    assert load_preset(words[4]) == live
    assert json.loads(data[1]) == json.loads(json_text(report(simulate(live), 0.1)))


def test_a_law_of_one_s_own_is_run_here_and_named_in_the_command(served: Served) -> None:
    with own_laws():
        register(law_from(Source("mine.py", EXAMPLE)))
        patch = {**SHORT, "lanes": {"Mine": {"law": "pd_gravity"}}}
        served.http.patch("/api/experiment", json=patch).raise_for_status()
        answer = served.http.post("/api/report", json={}, timeout=180.0)
        served.http.post("/api/presets/paper/load").raise_for_status()
    assert answer.status_code == 200, answer.text
    assert " --law mine.py --report report.html</code>" in answer.text
    data = re.search(r'id="report">(.*?)</script>', answer.text, re.DOTALL)
    assert data is not None
    assert json.loads(data[1])["lanes"]["Mine"]["metrics"]["mae"]


def test_what_is_wrong_or_takes_too_long_is_refused(served: Served) -> None:
    served.http.patch("/api/experiment", json=SHORT).raise_for_status()
    for wanted, path in (({"since": 0.3}, "since"), ({"since": -1}, "since"), ({"at": 1}, "at")):
        answer = served.http.post("/api/report", json=wanted)
        assert answer.status_code == 422, answer.text
        assert [field["path"] for field in answer.json()["error"]["fields"]] == [path]
    long = {"simulation": {"horizon": 120.0, "plant_substeps": 100, "control_rate": 1000}}
    served.http.patch("/api/experiment", json=long).raise_for_status()
    answer = served.http.post("/api/report", json={})
    assert answer.status_code == 422
    assert "run it separately" in answer.json()["error"]["message"]


def test_so_many_are_made_at_once(served: Served) -> None:
    assert served.http.get("/api/health").json()["limits"]["reports"] == MAX_REPORTS
