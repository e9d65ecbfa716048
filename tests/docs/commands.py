"""Command lines as the documentation shows them, and whether they would be understood."""

from __future__ import annotations

import argparse
import importlib.util
import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from docs.site.command_page import commands
from tests.docs.pages import ROOT

_SLIDETUNE = re.compile(r"(?:(?:\.venv/bin/)?python -m slidetune|slidetune)(?: (.*))?")
_MODULE = re.compile(r"(?:\.venv/bin/)?python -m ([\w.]+)(?: (.*))?")
_REQUEST = re.compile(r"(GET|POST|PUT|PATCH|DELETE) +(/[\w/{}.-]*)")
PROGRAMS = {"pytest", "docs", "tests"}
"""Modules that the documentation runs beside Slidetune."""


@dataclass(frozen=True)
class Curl:
    """A request as curl sends it: ``curl --json JSON --output FILE ADDRESS``."""

    method: str
    host: str
    path: str
    json: str
    output: str

    @classmethod
    def read(cls, line: str) -> Curl:
        """Read a command line.

        Raises:
            SystemExit: for options that the documentation has no need of.
        """
        parser = argparse.ArgumentParser(prog="curl", allow_abbrev=False)
        parser.add_argument("--json", default="")
        parser.add_argument("--output", "-o", default="")
        parser.add_argument("--request", "-X", default="")
        parser.add_argument("address")
        given = parser.parse_args(shlex.split(line)[1:])
        host, _, path = given.address.removeprefix("http://").partition("/")
        method = given.request or ("POST" if given.json else "GET")
        return cls(method, f"http://{host}/", f"/{path}", given.json, given.output)


def within(line: str) -> str:
    """Return the command of Slidetune that stands within one of another program, or nothing."""
    names = "|".join({name.split()[1] for name, _ in commands() if " " in name})
    found = re.search(rf"(?:^|[\s/])(slidetune (?:{names})\b.*)", line)
    return found[1] if found else ""


def lines(code: str) -> Iterator[str]:
    """Yield the commands of a block, without remarks."""
    for line in code.splitlines():
        command = re.sub(r"(^|\s+)# .*", "", line).strip()
        if command:
            yield command


def command_of(words: list[str]) -> tuple[Any, list[str]]:
    """Return the command that words begin with, and the rest of them.

    Raises:
        LookupError: if there is no such command.
    """
    known = dict(commands())
    name = "slidetune"
    while words and f"{name} {words[0]}" in known:
        name = f"{name} {words[0]}"
        words = words[1:]
    if getattr(known[name], "commands", None) and words and not words[0].startswith("-"):
        raise LookupError(f"{name} has no command {words[0]}")
    return known[name], words


def slidetune_words(line: str) -> list[str] | None:
    """Return what a line tells Slidetune; ``None`` where it is another program's."""
    match = _SLIDETUNE.fullmatch(line)
    return None if match is None else shlex.split(match[1] or "")


def misunderstood(line: str, routes: set[tuple[str, str]]) -> str:
    """Say what is wrong with a line of a block; nothing where it is right."""
    if (words := slidetune_words(line)) is not None:
        try:
            command, rest = command_of(words)
            command.make_context("slidetune", list(rest))
        except Exception as error:  # whatever the parser refuses with, by the version of Typer
            return f"{line}: {error}"
        return ""
    if line.startswith("make "):
        targets = [word for word in shlex.split(line)[1:] if "=" not in word]
        makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
        known = set(re.findall(r"^([a-z]+):", makefile, re.MULTILINE))
        return "" if set(targets) <= known else f"{line}: no such target of the Makefile"
    if line.startswith("curl "):
        asked = Curl.read(line)
        found = is_route(asked.method, asked.path, routes)
        return "" if found else f"{line}: there is no such route"
    if match := _REQUEST.match(line):
        return "" if is_route(match[1], match[2], routes) else f"{line}: there is no such route"
    if match := _MODULE.fullmatch(line):
        module = match[1]
        known_one = module.split(".")[0] in PROGRAMS and importlib.util.find_spec(module)
        return "" if known_one else f"{line}: there is no such module"
    return f"{line}: neither Slidetune, make, a module nor a request"


def is_route(method: str, path: str, routes: set[tuple[str, str]]) -> bool:
    """Tell whether a request is one of the application's; names in braces may differ."""

    def shape(text: str) -> str:
        return re.sub(r"\{\w+\}", "{}", text.split("?")[0])

    return any(
        method == one and re.fullmatch(_pattern(route), shape(path).replace("{}", "x"))
        for one, route in routes
    )


def _pattern(route: str) -> str:
    return re.sub(r"\\\{\w+\\\}", "[^/]+", re.escape(route))


def options() -> set[str]:
    """Return every option of every command."""
    return {
        option
        for _, command in commands()
        for one in command.params
        for option in (*one.opts, *one.secondary_opts)
        if option.startswith("--")
    } | {"--help"}


OTHER_OPTIONS = {
    "--record": "the long checks write their results into a page with it",
    "--all": "`tests.reference.make_data` has it",
    "--minutes": "`make soak` has it",
    "--ignore": "pytest has it",
    "--only": "`make faults` has it",
    "--read-only": "of a container",
    "--tmpfs": "of a container",
}
"""Options in the text that are those of other programs."""
OTHERS = "curl|docker|journalctl|pipx|systemctl|uv"
"""Programs of others, whose options are theirs."""
OTHER_TARGETS = {"make verify": "the Makefile of a hand-over has it"}


def code_commands(spans: list[str], known: set[str], routes: set[tuple[str, str]]) -> list[str]:
    """Say what of a page's code within sentences does not exist.

    Args:
        spans: what stands in backquotes.
        known: all options.
        routes: all routes, as method and path.
    """
    wrong = []
    names = {name.removeprefix("slidetune ") for name, _ in commands()} - {"slidetune"}
    for span in spans:
        # What make and other modules are told is theirs.
        theirs = re.match(rf"make|(\.venv/bin/)?python -m (?!slidetune)|({OTHERS}) ", span)
        for option in re.findall(r"(?<![\w-])--[a-z][\w-]*", span):
            if not theirs and option not in known and option not in OTHER_OPTIONS:
                wrong.append(f"{span}: there is no option {option}")
        match = _REQUEST.match(span)
        if match and match[2].startswith("/api/") and not is_route(match[1], match[2], routes):
            wrong.append(f"{span}: there is no such route")
        words = slidetune_words(span)
        if words and not words[0].startswith(("-", "COMMAND")) and words[0] not in names:
            wrong.append(f"{span}: there is no such command")
        if re.match(r"make [a-z]+( ARGS=.*)?$", span) and span not in OTHER_TARGETS:
            wrong += filter(None, [misunderstood(span, routes)])
    return wrong
