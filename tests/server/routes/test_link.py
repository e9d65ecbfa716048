"""Links over HTTP."""

from __future__ import annotations

from slidetune.robot.experiment.presets import link_to, load_preset
from tests.server.conftest import Served

CHANGED = {"lanes": {"NFTSM": {"nu": 30}}}


def live(served: Served) -> object:
    return served.http.get("/api/experiment").json()["experiment"]


def test_a_link_opens_what_it_was_made_of_beside_its_preset(served: Served) -> None:
    served.http.post("/api/presets/realistic/load").raise_for_status()
    served.http.patch("/api/experiment", json=CHANGED).raise_for_status()
    link, changed = served.http.get("/api/link").json()["link"], live(served)
    served.http.post("/api/presets/paper/load").raise_for_status()
    answer = served.http.post("/api/link", json={"link": f"http://elsewhere/#x={link}&lane=NFTSM"})
    assert answer.status_code == 200
    assert answer.json()["preset"] == "realistic"
    assert live(served) == changed
    assert served.app_state.document.baseline == load_preset("realistic")


def test_a_refused_link_changes_nothing(served: Served) -> None:
    before = live(served)
    link = link_to(load_preset("paper").patched(CHANGED))
    for damaged in ("", "paper", link[:-1], f"2{link[1:]}", link.replace("paper", "papers")):
        answer = served.http.post("/api/link", json={"link": damaged})
        assert answer.status_code == 422
        assert answer.json()["error"]["fields"][0]["path"] == "link"
    assert live(served) == before
