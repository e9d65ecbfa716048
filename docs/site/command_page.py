"""The command line, as its own help has it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import typer.main

from docs.site.table import code, page, plain, table
from slidetune.server.cli import cli

_KINDS = ("argument", "option")
_KINDS_OF_VALUE = {"int": "INTEGER", "float": "NUMBER"}

# Typer brings classes of its own for commands and parameters: what they hold is asked for by name.


def commands() -> Iterator[tuple[str, Any]]:
    """Yield every command by its words, the program itself first: ``slidetune arm add``."""

    def below(words: str, command: Any) -> Iterator[tuple[str, Any]]:
        yield words, command
        for name, one in getattr(command, "commands", {}).items():
            yield from below(f"{words} {name}", one)

    yield from below("slidetune", typer.main.get_command(cli))


def shown_parameters(command: Any) -> list[Any]:
    """Return what a command is told, but for ``--help``, which all have."""
    return [one for one in command.params if not getattr(one, "hidden", False)]


def _argument(parameter: Any) -> str:
    name = parameter.name.upper()
    several = "..." if parameter.nargs == -1 else ""
    return name + several if parameter.required else f"[{name}]{several}"


def _name(parameter: Any) -> str:
    if parameter.param_type_name == "argument":
        return code(_argument(parameter))
    names = ", ".join(code(name) for name in (*parameter.opts, *parameter.secondary_opts))
    if parameter.is_flag:
        return names
    kind = getattr(parameter.type_descriptor.annotation, "__name__", "")
    return f"{names} {code(parameter.metavar or _KINDS_OF_VALUE.get(kind, 'TEXT'))}"


def _allowed(parameter: Any) -> str:
    low, high = getattr(parameter, "min", None), getattr(parameter, "max", None)
    if low is None and high is None:
        return ""
    if high is None:
        return f"at least {low:g}"
    return f"at most {high:g}" if low is None else f"{low:g} to {high:g}"


def _default(parameter: Any) -> str:
    value = parameter.default
    if not getattr(parameter, "is_flag", False):
        return "" if value in (None, "", ()) else code(value)
    if value is None or not parameter.secondary_opts:
        return ""
    return code((parameter.opts if value else parameter.secondary_opts)[0])


def _rows(parameters: Iterable[Any]) -> Iterator[list[str]]:
    for one in parameters:
        yield [_name(one), plain(one.help or ""), _allowed(one), _default(one)]


def _section(words: str, command: Any) -> str:
    shown = shown_parameters(command)
    kinds = [[one for one in shown if one.param_type_name == kind] for kind in _KINDS]
    below = ["COMMAND"] if getattr(command, "commands", None) else []
    usage = " ".join([words, "[OPTIONS]", *map(_argument, kinds[0]), *below])
    paragraphs = [plain(text) for text in (command.help or "").split("\n\n")]
    return page(
        f"## {words}",
        f"```text\n{usage}\n```",
        *paragraphs,
        *[
            table([kind, "", "allowed", "default"], _rows(some))
            for kind, some in zip(_KINDS, kinds, strict=True)
        ],
    )


def command_page() -> str:
    """Return the page of the command line."""
    return page(
        "# Command line",
        "Every command, argument and option. In a checkout `.venv/bin/python -m slidetune` stands "
        "for `slidetune`; `slidetune COMMAND --help` says the same in a terminal. Several commands "
        "end with a status of their own, which their text names; 2 is a refusal everywhere.",
        *[_section(words, command) for words, command in commands()],
    )
