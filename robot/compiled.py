"""How the numerical kernels are compiled: once per version of this package, kept on disk.

Numba notices a change in a function's own file but not in the functions that it calls, so the
folder of the cache carries a digest of all kernels: an edited one is never run stale.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import platformdirs

Function = TypeVar("Function", bound=Callable[..., Any])


_CONSTANTS = ("quantity.py", "workspace.py", "compiled.py")
"""Files without kernels whose numbers are compiled into them."""


def _digest() -> str:
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(Path(__file__).parent.rglob("*.py")):
        content = path.read_bytes()
        if b"@kernel" in content or path.name in _CONSTANTS:
            digest.update(content)
    return digest.hexdigest()[:16]




def _folder() -> Path:
    name = _digest()
    cache = Path(platformdirs.user_cache_dir("slidetune")) / "kernels" / name
    try:
        cache.mkdir(parents=True, exist_ok=True)
    except OSError:  # a read-only home: compile into a folder that lives until the next restart
        cache = Path(tempfile.gettempdir()) / f"slidetune-{os.getuid()}" / name
        cache.mkdir(parents=True, exist_ok=True)
    return cache


CACHE = _folder()
"""Folder of the compiled kernels of this very version."""

numba.config.CACHE_DIR = str(CACHE)  # type: ignore[attr-defined]


def kernel(function: Function) -> Function:
    """Compile ``function`` without the interpreter's lock and keep the result on disk."""
    compiled: Any = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    return cast(Function, compiled)


def is_warm() -> bool:
    """Tell whether some kernels of this version are compiled already."""
    return any(CACHE.rglob("*.nbc"))
