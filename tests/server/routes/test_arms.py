"""Arms over HTTP: brought, examined, begun with, forgotten."""

from __future__ import annotations

import io
import json
import tempfile
import zipfile
from pathlib import Path

import numpy as np
import pytest
from websockets.sync.client import connect

from slidetune.robot.arm.teaching import TWO_LINKS
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.simulate import simulate
from slidetune.server.compute.arm_kernels import load_kernels
from tests.server.conftest import Served
from tests.server.scene.viser_client import until

BOX = '<visual><geometry><mesh filename="package://gone/box.stl"/></geometry></visual>'


@pytest.fixture(scope="module", autouse=True)
def compiled() -> None:
    """Have the kernels compiled before a request waits for them."""
    load_kernels("pendulum")
    load_kernels("two_links")


def sent(*files: tuple[str, bytes]) -> list[tuple[str, tuple[str, bytes]]]:
    return [("files", file) for file in files]


def arm_text(name: str, extra: str = "") -> bytes:
    """Return the shipped two links under another name, with another mass."""
    text = TWO_LINKS.read_text()
    text = text.replace('name="two_links"', f'name="{name}"').replace('value="1.5"', 'value="1.7"')
    return text.replace('<link name="tip"/>', f'<link name="tip">{extra}</link>').encode()


def names(served: Served) -> list[str]:
    return [arm["name"] for arm in served.http.get("/api/arms").json()["arms"]]


def test_shipped_arms_come_first(served: Served) -> None:
    answer = served.http.get("/api/arms").json()
    assert [arm["name"] for arm in answer["arms"]][:3] == ["jaka_zu5", "pendulum", "two_links"]
    assert answer["live"] == "jaka_zu5"
    assert all(arm["shipped"] for arm in answer["arms"][:3])


def test_an_arm_is_brought_begun_with_stepped_and_forgotten(served: Served) -> None:
    files = sent(("mine/arm.urdf", arm_text("My arm", BOX)))
    report = served.http.post("/api/arms", files=files).json()
    name = report["name"]
    assert name.startswith("my-arm-")
    assert report["joints"] == ["shoulder", "elbow"]
    (missing,) = [one for one in report["findings"] if "isn't found" in one["text"]]
    assert missing["kind"] == "assumed"
    assert "/tmp" not in json.dumps(report)
    assert name in names(served)

    answer = served.http.post(f"/api/arms/{name}/begin").json()
    assert answer["experiment"]["robot"]["model"] == name
    schema = served.http.get("/api/schema").json()
    assert [joint["name"] for joint in schema["x-arm"]["joints"]] == ["shoulder", "elbow"]
    with connect(served.live, compression=None, max_size=None) as client:
        hello = json.loads(client.recv(timeout=20.0))
        errors = [one["joint"] for one in hello["channels"] if one["group"] == "e"]
        assert set(errors) == {1, 2}
        while not isinstance(client.recv(timeout=20.0), bytes):
            continue
    metrics = served.http.get("/api/metrics").json()
    assert all(len(lane["recent"]["mae"]) == 2 for lane in metrics["lanes"].values())
    assert served.http.post("/api/session/kick").status_code == 202
    refused = served.http.post("/api/session/kick", json={"torque": [1.0] * 6})
    assert "each of the arm's 2 joints" in refused.json()["error"]["message"]

    in_use = served.http.delete(f"/api/arms/{name}")
    assert in_use.status_code == 422
    served.http.post("/api/arms/jaka_zu5/begin")
    assert served.http.get("/api/experiment").json()["preset"] == "paper"
    assert served.http.delete(f"/api/arms/{name}").status_code == 204
    assert name not in names(served)
    assert served.http.post(f"/api/arms/{name}/begin").status_code == 404


def test_a_patch_of_the_arm_begins_anew_with_its_joints(served: Served) -> None:
    document = {"robot": {"model": "two_links"}, "lanes": {"A": {"law": "smc", "k1": 5, "k2": 1}}}
    assert served.http.put("/api/experiment", json=document).status_code == 200
    epoch = served.http.get("/api/session").json()["epoch"]
    changed = served.http.patch("/api/experiment", json={"robot": {"model": "pendulum"}})
    assert changed.status_code == 200
    until(lambda: served.http.get("/api/session").json()["epoch"] > epoch)
    until(lambda: served.app_state.session.loop.packed.joints == 1)


def test_an_arm_that_is_refused_is_not_kept(served: Served) -> None:
    before = names(served)
    text = arm_text("heavy").replace(b'value="1.7"', b'value="-1"')
    report = served.http.post("/api/arms", files=sent(("arm.urdf", text))).json()
    assert report["name"] == ""
    assert [one["kind"] for one in report["findings"]][:1] == ["refused"]
    assert names(served) == before


def test_tip_and_mass_are_taken(served: Served) -> None:
    text = arm_text("bare").replace(b"<inertial>", b"<!--").replace(b"</inertial>", b"-->")
    bare = served.http.post("/api/arms", files=sent(("arm.urdf", text))).json()
    assert bare["name"] == ""
    said = {"total_mass": 3.0, "tip": "lower_rod"}
    massive = served.http.post("/api/arms", params=said, files=sent(("arm.urdf", text))).json()
    assert massive["tip"] == "lower_rod"
    assert massive["name"]
    served.http.delete(f"/api/arms/{massive['name']}")


def test_a_zip_with_two_descriptions_asks_which(served: Served) -> None:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        archive.writestr("a/one.urdf", arm_text("one"))
        archive.writestr("a/two.urdf", arm_text("two"))
    files = sent(("arms.zip", content.getvalue()))
    refused = served.http.post("/api/arms", files=files)
    assert refused.status_code == 422
    (field,) = refused.json()["error"]["fields"]
    assert (field["path"], field["allowed"]) == ("urdf", "a/one.urdf\na/two.urdf")
    report = served.http.post("/api/arms", params={"urdf": "a/two.urdf"}, files=files).json()
    assert report["robot"] == "two"
    served.http.delete(f"/api/arms/{report['name']}")


@pytest.mark.parametrize(
    ("files", "words"),
    [
        ([], "multipart/form-data"),
        (sent(("notes.txt", b"hello")), "no URDF among the files"),
        (sent(("../arm.urdf", b"<robot/>")), "no path of a file"),
        (sent(("arm.zip", b"no zip")), "no ZIP that can be read"),
    ],
)
def test_wrong_files_are_refused_in_words(
    served: Served, files: list[tuple[str, tuple[str, bytes]]], words: str
) -> None:
    answer = served.http.post("/api/arms", files=files)
    assert answer.status_code == 422, answer.text
    assert words in answer.json()["error"]["message"]


def test_nothing_of_what_was_sent_stays_behind(
    served: Served, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    report = served.http.post("/api/arms", files=sent(("arm.urdf", arm_text("brief")))).json()
    assert not list(tmp_path.glob("slidetune-arm-*"))
    served.http.delete(f"/api/arms/{report['name']}")


def test_a_new_lane_of_every_law_tracks_beside_those_of_the_first_experiment(
    served: Served,
) -> None:
    begun = served.http.post("/api/arms/two_links/begin").json()["experiment"]
    amplitude = np.array(begun["trajectory"]["amplitude"])
    for law in LAWS:
        lane = served.http.get("/api/arms/lane", params={"law": law}).json()["lane"]
        assert lane["law"] == law
        experiment = Experiment.from_document({**begun, "lanes": {"new": lane}})
        run = simulate(experiment.patched({"simulation": {"horizon": 6}})).lanes["new"]
        assert run.freeze is None
        late = run.time > 2.0
        assert (np.abs(run.e[late]).max(axis=0) < 0.1 * amplitude).all()
    served.http.post("/api/presets/paper/load").raise_for_status()
    answer = served.http.get("/api/arms/lane?law=smc")
    assert answer.json()["lane"] == {"law": "smc"}
    refused = served.http.get("/api/arms/lane?law=magic")
    assert refused.status_code == 422
    assert refused.json()["error"]["fields"][0]["path"] == "law"
