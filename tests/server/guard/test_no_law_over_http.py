"""A law is a program: nothing that comes over HTTP or the WebSocket makes one run."""

from __future__ import annotations

import ast
import json
from pathlib import Path

from websockets.sync.client import connect

from tests.own_laws import EXAMPLE
from tests.server.conftest import Served

ROOT = Path(__file__).resolve().parents[3]
RUN = {"law_from", "take_law", "take_laws", "try_apart", "LawFile", "LawFiles", "exec"}
"""What runs a law's own file, or leads there."""
MAY = {
    "server/cli.py",
    "server/cli_options.py",
    "server/export_command.py",
    "server/fit_command.py",
    "server/law_files/child.py",
    "server/law_files/law_files.py",
    "server/law_files/trial.py",
    "server/recording_commands.py",
    "server/study_commands.py",
}


def calls(path: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call):
            found = node.func
            names.add(found.id if isinstance(found, ast.Name) else getattr(found, "attr", ""))
    return names


def test_only_the_command_line_and_the_files_that_it_names_lead_to_a_law() -> None:
    using = {
        path.relative_to(ROOT).as_posix(): RUN & calls(path)
        for path in (ROOT / "server").rglob("*.py")
    }
    # The state of a server that is given no files begins with none; the document takes a law that
    # was read already.
    assert using.pop("server/state/app_state.py") == {"LawFiles"}
    assert {path for path, found in using.items() if found} <= MAY


def test_no_route_takes_a_file_of_a_law(served: Served, tmp_path: Path) -> None:
    marker = tmp_path / "ran"
    law = tmp_path / "evil.py"
    code = f"from pathlib import Path\nPath({str(marker)!r}).touch()\n{EXAMPLE}"
    law.write_text(code)
    operations = [
        (method.upper(), path)
        for path, methods in served.http.get("/openapi.json").json()["paths"].items()
        for method in methods
        if method in ("post", "put", "patch")
    ]
    assert len(operations) > 15
    for named in (str(law), code, "pd_gravity", f"file://{law}"):
        lanes = {"A": {"law": named}}
        body = {
            **dict.fromkeys(("law", "laws", "law_file", "file", "path", "name", "lane"), named),
            "law_files": [named],
            "experiment": {"lanes": lanes},
            "patch": {"lanes": lanes},
            "lanes": lanes,
        }
        for method, path in operations:
            filled = path.replace("{name}", "evil").replace("{number}", "1").replace("{id}", "1")
            for content, kind in (
                (json.dumps(body), "application/json"),
                (f"law: {json.dumps(named)}\nlanes: {json.dumps(lanes)}\n", "application/yaml"),
                (code, "text/x-python"),
            ):
                headers = {"content-type": kind}
                query = {"law": named, "file": named}
                answer = served.http.request(
                    method, filled, content=content, headers=headers, params=query
                )
                assert answer.status_code != 500, (method, filled, kind)
        with connect(served.live) as socket:
            for message in (
                {"type": "patch", "patch": {"lanes": lanes}, "id": 1},
                {"type": "laws", "law_files": [named], "id": 2},
                {"type": "law", "file": named, "id": 3},
            ):
                socket.send(json.dumps(message))
    assert "pd_gravity" not in {
        law["name"] for law in served.http.get("/api/schema").json()["x-laws"]
    }
    assert not marker.exists()
