"""Every block of code of the documentation is run, page by page, in the order of the page."""

from __future__ import annotations

import asyncio
import json
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from typing import Any

import httpx
import pytest
from typer.testing import CliRunner

from docs.site.http_pages import operations
from docs.site.own_documents import own_documents
from slidetune import load_preset
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.plain_yaml import read_plain_yaml
from slidetune.robot.lessons.lesson import lesson_from_yaml
from slidetune.server.cli import cli
from slidetune.server.report.study_file import wanted_fitting, wanted_tuning
from tests.docs.commands import (
    Curl,
    code_commands,
    is_route,
    lines,
    misunderstood,
    options,
    slidetune_words,
    within,
)
from tests.docs.pages import Block, blocks, code_spans, pages
from tests.docs.scenery import SCENERY, plain
from tests.own_laws import own_laws
from tests.server.conftest import serving

ADDRESS = "http://127.0.0.1:8000/"
"""Where the documentation says that a dashboard is."""
FEWER = {
    "tune": ("--trials", "2", "--draws", "2"),
    "robustness": ("--draws", "2", "--worst", "2"),
    "fit": ("--trials", "1"),
    "export": ("--draws", "2"),
}
"""What is added to commands that would take minutes."""
NOT_RUN = {"serve": "serves until it is ended", "bench": "measures for minutes"}
ENDS = {"tune": {0, 4}}
"""Exit statuses of commands that do as they should, where 0 is not the only one."""
COMMANDS = ("", "sh", "text")
"""Languages of blocks of commands."""


def with_code() -> list[Path]:
    return [page for page in pages() if blocks(page)]


@pytest.fixture(scope="module")
def routes() -> set[tuple[str, str]]:
    """Every route of the application."""
    openapi, _ = asyncio.run(own_documents())
    return {(method, path) for method, path, _ in operations(openapi)}


class Page:
    """A page whose blocks are run one after the other, in one folder and one namespace."""

    def __init__(self, folder: Path, address: Callable[[], str]) -> None:
        self.folder = folder
        self._address = address
        self._names: dict[str, Any] = {"__name__": "page"}

    def run(self, block: Block) -> None:
        """Run a block as its language has it."""
        kinds: dict[str, Callable[[Block], None]] = {
            "python": self._python,
            "yaml": self._yaml,
            "json": lambda block: json.loads(block.code),
            "c": self._c,
        }
        if block.language in COMMANDS:
            for line in lines(block.code):
                self._command(line, block)
        else:
            assert block.language in kinds, f"{block}: nothing is known of {block.language}"
            kinds[block.language](block)

    def _python(self, block: Block) -> None:
        code = block.code
        if ADDRESS in code:
            code = code.replace(ADDRESS, self._address())
        sys.path.insert(0, str(self.folder / block.folder))
        try:
            # What is compiled is kept beside its file, where it is one.
            name = str(self.folder / block.file) if block.file else str(block)
            exec(compile(code, name, "exec"), self._names)
        finally:
            sys.path.pop(0)

    def _yaml(self, block: Block) -> None:
        values = read_plain_yaml(block.code.encode()).values
        if "steps" in values:
            assert lesson_from_yaml(block.code, "lesson").lesson.steps
        elif "gains" in values:
            path = self.folder / (block.file or "study.yaml")
            path.write_text(block.code, encoding="utf-8")
            assert wanted_tuning(load_preset("realistic"), str(path), {}).trials
        elif "targets" in values:
            path = self.folder / (block.file or "fit.yaml")
            path.write_text(block.code, encoding="utf-8")
            assert wanted_fitting(str(path), None).trials
        else:
            patched = load_preset("realistic").patched(values).document()
            assert set(values) <= set(patched), f"{block}: is no part of an experiment"

    def _c(self, block: Block) -> None:
        compiler = shutil.which("cc")
        if compiler is None:
            return
        command = [compiler, "-std=c99", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-xc", "-"]
        where = self.folder / block.folder
        done = subprocess.run(
            command, cwd=where, input=block.code, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, f"{block}: {done.stderr}"

    def _command(self, line: str, block: Block) -> None:
        words = slidetune_words(line)
        if block.folder:
            where = self.folder / block.folder
            # Whoever gets it has a Python with NumPy: the present one.
            path = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
            done = subprocess.run(
                shlex.split(line),
                cwd=where,
                env={**os.environ, "PATH": path},
                capture_output=True,
                text=True,
                check=False,
            )
            assert done.returncode == 0, f"{block}: {line}: {done.stderr}"
        elif line.startswith("curl "):
            self._request(Curl.read(line), block)
        elif words and words[0] not in NOT_RUN and "--scheduler" not in words:
            ended = CliRunner().invoke(cli, [*words, *FEWER.get(words[0], ())])
            if ended.exception and not isinstance(ended.exception, SystemExit):
                raise AssertionError(f"{block}: {line}: {ended.exception}") from ended.exception
            expected = ENDS.get(words[0], {0})
            assert ended.exit_code in expected, f"{block}: {line}: {ended.output}"

    def _request(self, asked: Curl, block: Block) -> None:
        assert asked.host == ADDRESS, f"{block}: {asked.host} is no dashboard of the documentation"
        address = self._address().rstrip("/") + asked.path
        content = asked.json.encode() or None
        headers = {"content-type": "application/json"} if content else {}
        with httpx.Client(trust_env=False, timeout=120) as client:
            answer = client.request(asked.method, address, content=content, headers=headers)
        assert answer.status_code < 300, f"{block}: {answer.text}"
        if asked.output:
            (self.folder / asked.output).write_bytes(answer.content)


@pytest.fixture
def address(tmp_path: Path) -> Iterator[Callable[[], str]]:
    """Start a dashboard the first time that a page needs one."""
    with ExitStack() as stack:

        @cache
        def start() -> str:
            return f"{stack.enter_context(serving(tmp_path / 'own')).url}/"

        yield start


@pytest.mark.parametrize("page", with_code(), ids=lambda page: page.name)
def test_every_block_of_a_page_runs(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, address: Callable[[], str]
) -> None:
    folder = tmp_path / "page"
    folder.mkdir()
    monkeypatch.chdir(folder)
    SCENERY.get(page.name, plain)(folder)
    run = Page(folder, address)
    for block in blocks(page):
        if block.file:
            (folder / block.file).write_text(block.code, encoding="utf-8")
    with own_laws():
        for block in blocks(page):
            if not block.not_run:
                run.run(block)


@pytest.mark.parametrize("page", with_code(), ids=lambda page: page.name)
def test_every_line_of_a_block_of_commands_is_understood(
    page: Path, routes: set[tuple[str, str]]
) -> None:
    shown = [
        line
        for block in blocks(page)
        if block.language in COMMANDS and not block.not_run and not block.folder
        for line in lines(block.code)
    ]
    # What is not run may still hold a command of ours, such as a service's.
    unrun = [block for block in blocks(page) if block.not_run]
    shown += filter(None, [within(line) for block in unrun for line in lines(block.code)])
    assert [wrong for line in shown if (wrong := misunderstood(line, routes))] == []


@pytest.mark.parametrize("page", pages(), ids=lambda page: page.name)
def test_every_command_option_and_route_in_the_text_exists(
    page: Path, routes: set[tuple[str, str]]
) -> None:
    assert code_commands(code_spans(page), options(), routes) == []


def test_what_is_not_run_says_why() -> None:
    unrun = [block for page in pages() for block in blocks(page) if block.not_run]
    assert unrun
    assert [str(block) for block in unrun if len(block.not_run.split()) < 3] == []


def test_wrong_blocks_are_found(tmp_path: Path, routes: set[tuple[str, str]]) -> None:
    wrong = "slidetune run paper --cvs x.csv"
    assert "--cvs" in misunderstood(wrong, routes)
    assert "no such target" in misunderstood("make docz", routes)
    assert "no command" in misunderstood("slidetune tuen paper", routes)
    assert "no such route" in misunderstood("GET /api/nothing", routes)
    assert "neither" in misunderstood("rm -rf build", routes)
    assert misunderstood("slidetune run paper --csv x.csv", routes) == ""
    assert within("ExecStart=%h/bin/slidetune serve --tokn") == "slidetune serve --tokn"
    assert within("docker run --name slidetune --rm slidetune") == ""
    assert is_route("GET", "/api/studies/{id}/entries?first=0", routes)
    page = Page(tmp_path, lambda: "")
    block = Block(pages()[0], 1, "yaml", "lanes: {NFTSM: {nu: -1}}", "", "", "")
    with pytest.raises(InvalidExperimentError, match="nu"):
        page.run(block)
    with pytest.raises(NameError):
        page.run(Block(pages()[0], 1, "python", "print(nothing)", "", "", ""))
