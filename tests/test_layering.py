"""Imports run one way, and no file grows past what one can read at once."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
LONGEST_FILE = 400
"""Most lines of a file."""
VAGUE_NAMES = re.compile(r"(^|_)(utils?|helpers?|common|misc|managers?)(_|$)")
OUTSIDE_WORLD = {
    "_thread",
    "asyncio",
    "datetime",
    "fastapi",
    "http",
    "httpx",
    "queue",
    "requests",
    "sched",
    "selectors",
    "signal",
    "socket",
    "socketserver",
    "ssl",
    "starlette",
    "threading",
    "time",
    "urllib",
    "uvicorn",
    "viser",
    "webbrowser",
    "websockets",
}
"""Modules with a clock, a thread or a network in them, and those of the server and its page."""
JS_IMPORT = re.compile(
    r"""^\s*(?:import|export)\b[^;'"]*?\bfrom\s*["']([^"']+)["']"""
    r"""|^\s*import\s*["']([^"']+)["']|\bimport\(\s*([^)]*)\)""",
    re.MULTILINE,
)
JS_COMMENT = re.compile(r"/\*.*?\*/|^\s*//.*?$", re.DOTALL | re.MULTILINE)
JS_NEIGHBOUR = re.compile(r"\./[a-z0-9_]+\.js")


def modules(package: str) -> list[Path]:
    return sorted((ROOT / package).rglob("*.py"))


def scripts() -> list[Path]:
    return sorted((ROOT / "web").rglob("*.js"))


def short(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def module_name(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports(path: Path) -> Iterator[str]:
    """Yield every module that a file imports; `from a import b` gives a and a.b."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{short(path)} has a relative import"
            assert node.module is not None
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def imports_of(package: str, roots: set[str]) -> list[str]:
    return [
        f"{short(path)} imports {name}"
        for path in modules(package)
        for name in imports(path)
        if name.partition(".")[0] in roots
    ]


def code_of(script: Path) -> str:
    return JS_COMMENT.sub("", script.read_text(encoding="utf-8"))


def script_imports(script: Path) -> list[str]:
    found = JS_IMPORT.finditer(code_of(script))
    return [match[1] or match[2] or match[3].strip("\"' ") for match in found]


def test_each_package_has_modules() -> None:
    assert modules("robot")
    assert modules("server")
    assert scripts()


def test_robot_has_no_clock_no_thread_and_no_network() -> None:
    assert imports_of("robot", OUTSIDE_WORLD) == []
    thread_pools = [
        short(path) for path in modules("robot") if "ThreadPool" in path.read_text(encoding="utf-8")
    ]
    assert thread_pools == []


def test_robot_never_imports_server() -> None:
    assert imports_of("robot", {"server", "tests", "web"}) == []


def test_server_never_imports_tests() -> None:
    assert imports_of("server", {"tests", "web"}) == []


@pytest.mark.parametrize("package", ["robot", "server"])
def test_no_import_goes_in_a_circle(package: str) -> None:
    names = {module_name(path): path for path in modules(package)}
    graph = {
        name: {target for target in imports(path) if target in names and target != name}
        for name, path in names.items()
        # What a package hands on from its own modules is no circle.
        if path.name != "__init__.py"
    }
    while True:
        imported = set().union(*graph.values())
        ends = {name for name in graph if name not in imported or not graph[name] & graph.keys()}
        if not ends:
            break
        graph = {name: targets - ends for name, targets in graph.items() if name not in ends}
    assert graph == {}


def test_scripts_import_only_their_neighbours() -> None:
    for script in scripts():
        for target in script_imports(script):
            assert JS_NEIGHBOUR.fullmatch(target), f"{short(script)} imports {target}"
            assert (script.parent / target).is_file(), f"{short(script)} imports {target}"


def test_one_script_knows_the_addresses_of_the_server() -> None:
    knowing = [short(path) for path in scripts() if "/api/" in code_of(path)]
    assert knowing == ["web/api.js"]


def test_no_file_is_longer_than_400_lines() -> None:
    files = [
        path
        for folder in ("robot", "server", "web", "tests")
        for path in (ROOT / folder).rglob("*")
        if path.suffix in (".py", ".js", ".css")
    ]
    lines = {short(path): len(path.read_text(encoding="utf-8").splitlines()) for path in files}
    assert {name: count for name, count in lines.items() if count > LONGEST_FILE} == {}


def test_every_module_name_says_what_it_is() -> None:
    files = [*modules("robot"), *modules("server"), *modules("tests"), *scripts()]
    assert [short(path) for path in files if VAGUE_NAMES.search(path.stem)] == []
