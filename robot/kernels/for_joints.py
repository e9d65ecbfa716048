"""Kernels for an arm with another number of joints than the shipped one.

A kernel counts its joints by the constant JOINTS: so its loops are unrolled, its rows are found by
constants, and an arm of seven joints costs one of six nothing. For another number the same function
is compiled once more, with that number in the place of JOINTS wherever it and the kernels that it
calls name it. No other constant that a kernel reads may depend on JOINTS.
"""

from __future__ import annotations

from threading import RLock
from types import FunctionType
from typing import Any

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import compiler_of

_made: dict[tuple[Any, int], Any] = {}
_globals: dict[tuple[int, int], dict[str, Any]] = {}
_lock = RLock()


def for_joints(function: Any, joints: int) -> Any:
    """Return a kernel as it is for so many joints; compiled when it is first called.

    Args:
        function: a kernel; any other function is returned as it is.
        joints: how many there are.
    """
    compiler = None if joints == JOINTS else compiler_of(function)
    if compiler is None:
        return function
    with _lock:
        key = function, joints
        if key not in _made:
            written: FunctionType = function.py_func
            other = FunctionType(
                written.__code__,
                _globals_of(written, joints),
                written.__name__,
                written.__defaults__,
                written.__closure__,
            )
            # By this name numba tells them apart: in its cache, and in the compiled code.
            other.__qualname__ = f"{written.__qualname__}_{joints}"
            other.__module__ = written.__module__
            _made[key] = compiler(other)
        return _made[key]


def _globals_of(function: FunctionType, joints: int) -> dict[str, Any]:
    """Return the globals of a function's module as they are for so many joints."""
    key = id(function.__globals__), joints
    if key not in _globals:
        known = _globals[key] = dict(function.__globals__)  # first: its kernels ask for it too
        for name, value in function.__globals__.items():
            known[name] = joints if name == "JOINTS" else for_joints(value, joints)
    return _globals[key]
