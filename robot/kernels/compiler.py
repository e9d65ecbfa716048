"""How the numerical kernels are compiled: once per version of this package, kept on disk.

Numba notices a change in a function's own file but not in the functions that it calls, so the
folder of the cache carries a digest of all kernels: an edited one is never run stale.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import stat
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import platformdirs

from slidetune.robot.fields.quantity import JOINTS

Function = TypeVar("Function", bound=Callable[..., Any])


KEPT = 6
"""Versions whose compiled kernels are kept, about 3 MB each (*ours*)."""
_HANDED_ON = "SLIDETUNE_KERNELS"
"""Environment variable by which a process tells those that it starts of its temporary folder."""
_OPTIONS: Any = {"error_model": "numpy", "fastmath": {"contract"}}
"""No check of a divisor; and a product may join a sum without being rounded in between, which saves
a step 6 % of its time and changes last digits alone."""
OWN_FILE = "__law_file__"
"""Global of a module that was read from a law's own file."""
_ROBOT = Path(__file__).parents[1]
_CONSTANTS = (
    "environment/layout.py",
    "fields/quantity.py",
    "integrator/law_call.py",
    "kernels/by_address.py",
    "kernels/compiler.py",
    "kernels/workspace.py",
)
"""Files without kernels whose numbers are compiled into them."""


def _digest() -> str:
    # The place counts too: numba keeps what it compiled by the path of the source.
    digest = hashlib.sha256(f"{numba.__version__} {Path(__file__)}".encode())
    for path in sorted(_ROBOT.rglob("*.py")):
        content = path.read_bytes()
        compiled = any(mark in content for mark in (b"@kernel", b"@released", b"@inlined"))
        if compiled or path.relative_to(_ROBOT).as_posix() in _CONSTANTS:
            digest.update(content)
    return digest.hexdigest()[:16]


def _forget_old(cache: Path) -> None:
    """Remove what other versions compiled, but for the last few: several may be in use."""
    cache.touch()
    others = sorted(cache.parent.iterdir(), key=lambda path: path.stat().st_mtime)
    for old in others[:-KEPT]:
        shutil.rmtree(old, ignore_errors=True)


def _folder() -> Path:
    name = _digest()
    cache = Path(platformdirs.user_cache_dir("slidetune")) / "kernels" / name
    try:
        cache.mkdir(parents=True, exist_ok=True)
        _forget_old(cache)
    except OSError:  # a read-only home: a folder that lives until the next restart
        return _begun_with(cache, _temporary() / name)
    return cache


def _begun_with(ready: Path, cache: Path) -> Path:
    """Return a folder that can be written, with what was compiled where nothing can be.

    Numba takes kernels only out of a folder that it could also write to: a container's image has
    them compiled, and its file system is read-only.

    Args:
        ready: the folder that can't be written, if there is one.
        cache: where they are to be.
    """
    if not cache.exists() and ready.is_dir():
        staged = Path(tempfile.mkdtemp(dir=cache.parent, prefix="."))
        shutil.copytree(ready, staged, dirs_exist_ok=True)
        staged.chmod(0o700)  # that of the original can't be written
        with suppress(OSError):  # another process was faster
            staged.rename(cache)
    cache.mkdir(exist_ok=True)
    return cache


def _temporary() -> Path:
    """Return a temporary folder of this user's alone: numba runs what it finds there.

    Where somebody else made the one of the usual name first, it is a new one, which this process
    and those that it starts use.
    """
    usual = Path(tempfile.gettempdir()) / f"slidetune-{os.getuid()}"
    with suppress(OSError):
        usual.mkdir(mode=0o700)
    for folder in (usual, Path(os.environ.get(_HANDED_ON) or usual)):
        if _is_private(folder):
            return folder
    made = tempfile.mkdtemp(prefix="slidetune-")
    os.environ[_HANDED_ON] = made
    atexit.register(shutil.rmtree, made, ignore_errors=True)
    return Path(made)


def _is_private(folder: Path) -> bool:
    """Whether a folder is this user's, and no link, and closed to everybody else."""
    try:
        about = folder.lstat()
    except OSError:
        return False
    return (
        stat.S_ISDIR(about.st_mode)
        and about.st_uid == os.getuid()
        and not stat.S_IMODE(about.st_mode) & 0o077
    )


CACHE = _folder()
"""Folder of the compiled kernels of this very version."""

numba.config.CACHE_DIR = str(CACHE)  # type: ignore[attr-defined]


_compilers: dict[Any, Callable[[Any], Any]] = {}
"""By compiled function, what compiled it."""


def compiler_of(function: Any) -> Callable[[Any], Any] | None:
    """Return what has compiled a function, ``None`` for one that isn't compiled."""
    try:
        return _compilers.get(function)
    except TypeError:  # not to be looked up: no function at all
        return None


def compiled_count() -> tuple[int, int]:
    """Return how many of our kernels are compiled in this process, and how many there are."""
    ours = [one for one, how in list(_compilers.items()) if how is not part and not _is_own(one)]
    return sum(bool(one.signatures) for one in ours), len(ours)


def kernel(function: Function) -> Function:
    """Compile ``function`` and keep the result on disk.

    It keeps the interpreter's lock: it ends long before another thread would be given a turn, and
    a thread that steps in real time would have to ask for the lock again after each call.
    """
    return cast(Function, _compiled(kernel, function, cache=True))


def released(function: Function) -> Function:
    """Do the same for a function that takes long: it lets other threads run meanwhile."""
    return cast(Function, _compiled(released, function, cache=True, nogil=True))


def inlined(function: Function) -> Function:
    """Compile ``function`` into every kernel that calls it: for what is small and called often."""
    return cast(Function, _compiled(inlined, function, forceinline=True))


def part(function: Function) -> Function:
    """Write ``function`` out in the one kernel that calls it: for what is large and has a name."""
    return cast(Function, _compiled(part, function, inline="always"))


def _compiled(how: Callable[[Any], Any], function: Any, **options: Any) -> Any:
    """Compile one function; what a law's own file defines is checked, and counted nowhere.

    A wrong index of ours would fail a test; one of a file that changes while the program runs must
    not end that.
    """
    if OWN_FILE in getattr(function, "__globals__", ()):
        options["boundscheck"] = True
    compiled = numba.njit(**options, **_OPTIONS)(function)
    _compilers[compiled] = how
    return compiled


def _is_own(compiled: Any) -> bool:
    return OWN_FILE in compiled.py_func.__globals__


def is_warm(joints: int = JOINTS) -> bool:
    """Tell whether all kernels of this version have been compiled once for so many joints."""
    return _warm(joints).exists()


def mark_warm(joints: int = JOINTS) -> None:
    """Remember that all kernels have been compiled for so many joints."""
    _warm(joints).touch()


def _warm(joints: int) -> Path:
    return CACHE / f"warm-{joints}"
