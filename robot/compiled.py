"""How the numerical kernels are compiled: once per version of this package, kept on disk.

Numba notices a change in a function's own file but not in the functions that it calls, so the
folder of the cache carries a digest of all kernels: an edited one is never run stale.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import platformdirs

Function = TypeVar("Function", bound=Callable[..., Any])


KEPT = 6
"""Versions whose compiled kernels are kept, about 3 MB each (*ours*)."""
_CONSTANTS = ("quantity.py", "workspace.py", "compiled.py")
"""Files without kernels whose numbers are compiled into them."""


def _digest() -> str:
    # The place counts too: numba keeps what it compiled by the path of the source.
    digest = hashlib.sha256(f"{numba.__version__} {Path(__file__)}".encode())
    for path in sorted(Path(__file__).parent.rglob("*.py")):
        content = path.read_bytes()
        if b"@kernel" in content or path.name in _CONSTANTS:
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
    except OSError:  # a read-only home: compile into a folder that lives until the next restart
        cache = Path(tempfile.gettempdir()) / f"slidetune-{os.getuid()}" / name
        cache.mkdir(parents=True, exist_ok=True)
    return cache


CACHE = _folder()
"""Folder of the compiled kernels of this very version."""

_WARM = CACHE / "warm"

numba.config.CACHE_DIR = str(CACHE)  # type: ignore[attr-defined]


def kernel(function: Function) -> Function:
    """Compile ``function`` and keep the result on disk.

    It keeps the interpreter's lock: it ends long before another thread would be given a turn, and
    a thread that steps in real time would have to ask for the lock again after each call.
    """
    compiled: Any = numba.njit(cache=True, error_model="numpy")(function)
    return cast(Function, compiled)


def is_warm() -> bool:
    """Tell whether all kernels of this version have been compiled once."""
    return _WARM.exists()


def mark_warm() -> None:
    """Remember that all kernels have been compiled."""
    _WARM.touch()
