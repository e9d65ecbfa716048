"""What the Dockerfile says: a user without rights, a health check, no junk of the checkout."""

from __future__ import annotations

import importlib.util
import json
import re
import subprocess
from fnmatch import fnmatch
from pathlib import Path
from types import ModuleType

import pytest

from tests.deploy.conftest import ROOT, WARM_UP
from tests.deploy.dockerfile import environment, instructions, of

MADE_OF = {"pyproject.toml", "README.md", "LICENSE", "CHANGELOG.md", "requirements.lock"}
FOLDERS = {"robot", "server", "web", "presets", "slidetune"}


def test_there_are_two_stages_and_only_known_instructions() -> None:
    names = [one.name for one in instructions()]
    assert names.count("FROM") == 2
    assert "ADD" not in names
    known = "FROM WORKDIR COPY RUN ENV USER VOLUME EXPOSE HEALTHCHECK ENTRYPOINT CMD"
    assert set(names) <= set(known.split())


def test_the_image_runs_as_a_numbered_user_without_rights() -> None:
    (user,) = of("USER")
    assert int(user.text) > 999  # a number: Kubernetes can tell that it isn't root
    assert f"--uid {user.text}" in " ".join(one.text for one in of("RUN"))
    after = instructions()[instructions().index(user) :]
    assert {one.name for one in after} & {"RUN", "COPY"} == set()


def test_what_is_copied_is_what_the_wheel_is_made_of() -> None:
    sources = [word for one in of("COPY", 0) for word in one.text.split()[:-1]]
    assert set(sources) == MADE_OF | FOLDERS | {".ci/runtime_lock.py"}
    assert [one.text for one in of("COPY")] == ["--from=build /opt/slidetune /opt/slidetune"]


def test_everything_else_is_kept_out_of_the_build() -> None:
    lines = (ROOT / ".dockerignore").read_text(encoding="utf-8").splitlines()
    rules = [line for line in lines if line and not line.startswith("#")]
    assert rules[0] == "*"
    let_in = {rule.removeprefix("!") for rule in rules if rule.startswith("!")}
    assert let_in == MADE_OF | FOLDERS | {".ci/runtime_lock.py"}
    assert rules[-1] == "**/__pycache__"
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if tracked.returncode:
        pytest.skip("not a git checkout")
    tops = {name.partition("/")[0] for name in tracked.stdout.splitlines()}
    assert let_in - {".ci/runtime_lock.py"} <= tops
    assert not any(fnmatch(top, rule) for top in ("tests", "docs", ".venv") for rule in let_in)


def test_it_serves_all_addresses_with_a_token_and_is_asked_for_its_health() -> None:
    (entry,), (command,), (health,) = of("ENTRYPOINT"), of("CMD"), of("HEALTHCHECK")
    assert entry.command() == ["slidetune"]
    words = command.command()
    assert words[:3] == ["serve", "--host", "0.0.0.0"]  # where a token is asked for
    assert "--no-browser" in words
    port = words[words.index("--port") + 1]
    assert [one.text for one in of("EXPOSE")] == [port]
    program, option, script = health.command()
    assert (program, option) == ("python", "-c")
    assert f"'127.0.0.1', {port}" in script
    compile(script, "health", "exec")


def test_it_writes_to_its_volume_alone() -> None:
    (volume,) = of("VOLUME")
    assert environment()["XDG_DATA_HOME"] == volume.text == "/data"
    assert environment()["XDG_CACHE_HOME"].startswith("/opt/slidetune/")
    warmed = [one.text for one in of("RUN") if "warm_up()" in one.text]
    (text,) = warmed
    script = text.partition('"')[2].rpartition('"')[0]
    compile(script, "warm up", "exec")
    assert WARM_UP.rpartition("; ")[2] in script


@pytest.fixture
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("runtime_lock", ROOT / ".ci" / "runtime_lock.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def report(*names: tuple[str, str], url: str = "https://example.org/x.whl") -> str:
    """What pip would write of these packages."""
    install = [
        {"download_info": {"url": url}, "metadata": {"name": name, "version": version}}
        for name, version in names
    ]
    own = {"download_info": {"url": "file:///x"}, "metadata": {"name": "x", "version": "1"}}
    return json.dumps({"install": [*install, own]})


def test_the_part_of_the_lock_has_the_hashes_of_what_is_needed_and_no_more(
    script: ModuleType,
) -> None:
    lock = (ROOT / "requirements.lock").read_text(encoding="utf-8")
    versions = dict(re.findall(r"^([\w.-]+)==([^\s;\\]+)", lock, re.MULTILINE))
    wanted = [(name, versions[name]) for name in ("numpy", "typing-extensions")]
    part = script.runtime_lock(report(*wanted), lock)
    found = re.findall(r"^([\w.-]+)==(\S+)", part, re.MULTILINE)
    assert found == wanted
    assert all("--hash=sha256:" in entry for entry in re.split(r"\n(?=\S)", part.strip()))
    assert part.count("--hash") == sum(
        entry.count("--hash")
        for entry in re.split(r"\n(?=[^\s#])", lock)
        if entry.startswith(tuple(f"{name}=={version}" for name, version in wanted))
    )
    # Capitals and signs count for nothing in a name.
    assert script.runtime_lock(report(("Typing_Extensions", wanted[1][1])), lock) in part


def test_what_the_lock_lacks_is_refused(script: ModuleType) -> None:
    lock = (ROOT / "requirements.lock").read_text(encoding="utf-8")
    with pytest.raises(ValueError, match=r"numpy==0\.1"):
        script.runtime_lock(report(("numpy", "0.1")), lock)


def test_the_versions_that_the_build_is_held_to_are_all_those_of_the_lock(tmp_path: Path) -> None:
    (line,) = (one.text for one in of("RUN", 0) if one.text.startswith("sed"))
    (tmp_path / "requirements.lock").write_bytes((ROOT / "requirements.lock").read_bytes())
    subprocess.run(["/bin/sh", "-c", line], cwd=tmp_path, check=True)
    made = (tmp_path / "versions.txt").read_text(encoding="utf-8").splitlines()
    lock = (ROOT / "requirements.lock").read_text(encoding="utf-8")
    assert [text.partition(" ")[0] for text in made] == re.findall(
        r"^([\w.-]+==[^\s;\\]+)", lock, re.MULTILINE
    )
    assert not any("hash" in text or "\\" in text for text in made)
