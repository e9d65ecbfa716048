"""Kernels for an arm with another number of joints than the shipped one.

A kernel counts its joints by the constant JOINTS: so its loops are unrolled, its rows are found by
constants, and an arm of seven joints costs one of six nothing. For another number the same function
is compiled once more, with that number in the place of JOINTS wherever it and the kernels that it
calls name it. No other constant that a kernel reads may depend on JOINTS.
"""

from __future__ import annotations

from collections.abc import Callable
from types import FunctionType
from typing import Any

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import OWN_FILE, compiler_of

_made: dict[tuple[Any, int], Any] = {}


def for_joints(function: Any, joints: int) -> Any:
    """Return a kernel as it is for so many joints; compiled when it is first called.

    Args:
        function: a kernel, or a plain function of a law's own file; any other function is returned
            as it is.
        joints: how many there are.
    """
    if joints == JOINTS or _writer_of(function) is None:
        return function
    if (function, joints) not in _made:
        # Whole before anybody else sees it: a kernel is not to call one for another number.
        for key, kernel in _Rewriting(joints).all_of(function).items():
            _made.setdefault(key, kernel)
    return _made[function, joints]


def _writer_of(function: Any) -> Callable[[Any], Any] | None:
    """Return what makes a function out of the one written for it, ``None`` where it stays."""
    if isinstance(function, FunctionType):
        return _plain if OWN_FILE in function.__globals__ else None
    return compiler_of(function)


def _plain(function: FunctionType) -> FunctionType:
    return function


class _Rewriting:
    """A kernel and all those that it calls, written anew for another number of joints."""

    def __init__(self, joints: int) -> None:
        self._joints = joints
        self._globals: dict[int, dict[str, Any]] = {}
        self._kernels: dict[tuple[Any, int], Any] = {}

    def all_of(self, function: Any) -> dict[tuple[Any, int], Any]:
        """Return a kernel and those that it can call, by what they were written from."""
        self._written(function)
        return self._kernels

    def _written(self, function: Any) -> Any:
        compiler, key = _writer_of(function), (function, self._joints)
        if compiler is None:
            return function
        if key not in self._kernels:
            source: FunctionType = getattr(function, "py_func", function)
            other = FunctionType(
                source.__code__,
                self._globals_of(source),
                source.__name__,
                source.__defaults__,
                source.__closure__,
            )
            # By this name numba tells them apart: in its cache, and in the compiled code.
            other.__qualname__ = f"{source.__qualname__}_{self._joints}"
            other.__module__ = source.__module__
            self._kernels.setdefault(key, compiler(other))
        return self._kernels[key]

    def _globals_of(self, function: FunctionType) -> dict[str, Any]:
        """Return the globals of a function's module, with JOINTS and all kernels replaced."""
        key = id(function.__globals__)
        if key not in self._globals:
            known = self._globals[key] = dict(function.__globals__)  # its kernels ask for it too
            for name, value in function.__globals__.items():
                known[name] = self._joints if name == "JOINTS" else self._written(value)
        return self._globals[key]
