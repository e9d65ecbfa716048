"""Imports run one way, and no file grows past what one can read at once."""

from __future__ import annotations

import ast
import importlib
import pkgutil
import re
from collections import Counter
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
JS_ADDRESS = re.compile(r"""["'`]/api/""")
JS_COMMENT = re.compile(r"/\*.*?\*/|^\s*//.*?$", re.DOTALL | re.MULTILINE)
JS_NEIGHBOUR = re.compile(r"(\./|\.\./)([a-z0-9_]+/)*[a-z0-9_]+\.js")
MOST_FILES = 16
"""Most files of code of one folder."""
CODE = (".py", ".js", ".css", ".html")


def modules(package: str) -> list[Path]:
    return sorted((ROOT / package).rglob("*.py"))


def scripts() -> list[Path]:
    return sorted((ROOT / "web").rglob("*.js"))


def short(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def module_name(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(["slidetune", *(parts[:-1] if parts[-1] == "__init__" else parts)])


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
    """Imports of modules whose name begins with one of these."""
    return [
        f"{short(path)} imports {name}"
        for path in modules(package)
        for name in imports(path)
        if any(name == root or name.startswith(f"{root}.") for root in roots)
    ]


def folder_order(package: str) -> list[str]:
    """Folders of a package as CONTRIBUTING.md lists them: each imports only what stands above."""
    guide = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    tree = re.search(rf"^{package}/\n((?:  [a-z_/]+/ +\S.*\n)+)", guide, re.MULTILINE)
    assert tree
    return [line.split()[0].rstrip("/") for line in tree[1].splitlines()]


def folder(path: Path, package: str) -> str:
    """The folder of a file within its package; empty for the package's own."""
    inside = path.parent.relative_to(ROOT / package).as_posix()
    return "" if inside == "." else inside


def against_the_order(package: str, edges: Iterator[tuple[Path, Path]]) -> list[str]:
    """Imports that go down, or aside, in the list of the package's folders."""
    listed = folder_order(package)
    order = ["", *listed] if package == "robot" else [*listed, ""]
    return [
        f"{short(user)} imports {short(used)}"
        for user, used in edges
        if folder(user, package) != folder(used, package)
        and order.index(folder(used, package)) > order.index(folder(user, package))
    ]


def python_edges(package: str) -> Iterator[tuple[Path, Path]]:
    files = {module_name(path): path for path in modules(package)}
    for user in files.values():
        # What a package hands on from its own modules is no import against the order.
        if user != ROOT / package / "__init__.py":
            yield from ((user, files[name]) for name in imports(user) if name in files)


def script_edges() -> Iterator[tuple[Path, Path]]:
    for user in scripts():
        yield from ((user, (user.parent / name).resolve()) for name in script_imports(user))


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
    assert imports_of("robot", {"slidetune.server", "tests"}) == []


def test_server_never_imports_tests() -> None:
    assert imports_of("server", {"tests"}) == []


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


def test_there_is_one_import_name() -> None:
    for package in ("robot", "server", "slidetune", "tests"):
        assert imports_of(package, {"robot", "server", "web", "presets"}) == []


@pytest.mark.parametrize("name", ["robot", "server"])
def test_no_module_is_there_twice(name: str) -> None:
    with pytest.raises(ImportError, match=f"import slidetune.{name}"):
        importlib.import_module(name)


@pytest.mark.parametrize("package", ["robot", "server", "web"])
def test_the_guide_lists_every_folder_of_code(package: str) -> None:
    files = [path for path in (ROOT / package).rglob("*") if path.suffix in CODE]
    assert sorted(folder_order(package)) == sorted({folder(path, package) for path in files} - {""})


@pytest.mark.parametrize("package", ["robot", "server"])
def test_folders_import_one_way(package: str) -> None:
    assert against_the_order(package, python_edges(package)) == []


def test_folders_of_scripts_import_one_way() -> None:
    assert against_the_order("web", script_edges()) == []


def test_no_folder_holds_more_than_one_can_overlook() -> None:
    code = (path for top in ("robot", "server", "web", "tests") for path in (ROOT / top).rglob("*"))
    count = Counter(short(path.parent) for path in code if path.suffix in CODE)
    assert {name: files for name, files in count.items() if files > MOST_FILES} == {}


def test_scripts_import_only_their_neighbours() -> None:
    for script in scripts():
        for target in script_imports(script):
            assert JS_NEIGHBOUR.fullmatch(target), f"{short(script)} imports {target}"
            assert (script.parent / target).is_file(), f"{short(script)} imports {target}"


def test_one_folder_of_scripts_knows_the_addresses_of_the_server() -> None:
    knowing = [path for path in scripts() if JS_ADDRESS.search(code_of(path))]
    assert {short(path.parent) for path in knowing} == {"web/api", "web/api/requests"}


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


def test_every_module_that_a_comment_names_is_there() -> None:
    texts = [*modules("robot"), *modules("server"), *(ROOT / "robot").rglob("*.md")]
    lost = []
    for path in texts:
        for name in re.findall(r"`((?:robot|server)\.[\w.]+)`", path.read_text(encoding="utf-8")):
            try:
                pkgutil.resolve_name(f"slidetune.{name}")
            except (ImportError, AttributeError):
                lost.append(f"{short(path)} names {name}")
    assert lost == []
