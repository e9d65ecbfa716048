"""How the numerical kernels are compiled: once per version of this package, kept on disk.

Numba notices a change in a function's own file but not in the functions that it calls, so the
folder of the cache carries a digest of the whole package: an edited kernel is never run stale.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
import platformdirs

Function = TypeVar("Function", bound=Callable[..., Any])


def _digest() -> str:
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(Path(__file__).parent.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


CACHE = Path(platformdirs.user_cache_dir("slidetune")) / "kernels" / _digest()
"""Folder of the compiled kernels of this very version."""

CACHE.mkdir(parents=True, exist_ok=True)
numba.config.CACHE_DIR = str(CACHE)


def kernel(function: Function) -> Function:
    """Compile ``function`` without the interpreter's lock and keep the result on disk."""
    compiled: Function = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    return compiled


def is_warm() -> bool:
    """Tell whether some kernels of this version are compiled already."""
    return any(CACHE.rglob("*.nbc"))
