"""How a kernel calls a law that it was not compiled with: through an address in the lane's table.

So the loop is compiled once for all laws. A law of plain Python, or one that numba can't compile,
is called back, much slower; what it raises waits here until the kernel has returned.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from contextvars import ContextVar
from functools import lru_cache
from typing import Any

import numpy as np
from numba import types
from numba.core import cgutils
from numba.core.errors import NumbaError
from numba.extending import intrinsic

from slidetune.robot.kernels.by_address import address_of, called

Array = np.ndarray
Control = Callable[[int, Array, Array, Array, Array], None]
"""``control(state, gains, nominal_M, nominal_nle, work)`` writes a law's torque to TAU [N m]; see
``robot.laws.law.Law``."""
Advance = Callable[[float, int, int, Array, Array, Array, Array], None]
"""``advance(h, state, into, gains, nominal_M, nominal_nle, work)`` moves a law's memory on."""

RAISED = -3
"""What a kernel returns when a law that it called back has raised."""

_block, _line = types.float64[:, ::1], types.float64[::1]
_SIGNATURE = types.none(types.int64, _block, _block, _line, _block)
_ADVANCE = types.none(types.float64, types.int64, types.int64, _block, _block, _line, _block)
_Callback = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)
_AdvanceCallback = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_double, ctypes.c_int64, ctypes.c_int64)
_error: ContextVar[Exception | None] = ContextVar("error", default=None)
_llvm: Any = cgutils


def _compiled(function: Any, signature: Any) -> int:
    if not hasattr(function, "get_compile_result"):
        return 0
    try:
        return address_of(function, signature)
    except NumbaError:
        return 0


@lru_cache(maxsize=64)
def compiled_law(control: Control) -> int:
    """Return the address of a law's compiled code, 0 where there is none."""
    return _compiled(control, _SIGNATURE)


@lru_cache(maxsize=64)
def compiled_advance(advance: Advance) -> int:
    """Return the same of what moves its memory on."""
    return _compiled(advance, _ADVANCE)


def callback(control: Control, gains: Array, inertia: Array, bias: Array, work: Array) -> Any:
    """Return a law with its arrays as a C function; it lives as long as the result is kept."""

    def call(state: int) -> int:
        return _kept_error(lambda: control(state, gains, inertia, bias, work))

    return _Callback(call)


def advance_callback(
    advance: Advance, gains: Array, inertia: Array, bias: Array, work: Array
) -> Any:
    """Return the same of what moves its memory on."""

    def call(h: float, state: int, into: int) -> int:
        return _kept_error(lambda: advance(h, state, into, gains, inertia, bias, work))

    return _AdvanceCallback(call)


def _kept_error(run: Callable[[], None]) -> int:
    try:
        run()
    except Exception as error:
        _error.set(error)
        return RAISED
    return 0


def checked(code: int) -> int:
    """Return what a kernel returned, or raise what its law raised."""
    if code == RAISED:
        error = _error.get() or RuntimeError("a law raised")
        _error.set(None)
        raise error
    return code


def _law(  # numba reads the names and the number of these
    _context: Any, address: Any, state: Any, gains: Any, nominal_M: Any, nominal_nle: Any, work: Any
) -> Any:
    return called(_SIGNATURE)


def _law_advance(
    _context: Any,
    address: Any,
    h: Any,
    state: Any,
    into: Any,
    gains: Any,
    nominal_M: Any,
    nominal_nle: Any,
    work: Any,
) -> Any:
    return called(_ADVANCE)


def _call_c(builder: Any, arguments: Any) -> Any:
    """Call a C function that returns a whole number, at an address."""
    kind = _llvm.ir.FunctionType(cgutils.intp_t, [one.type for one in arguments[1:]])
    return builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), arguments[1:])


def _called_back(_context: Any, address: Any, state: Any) -> Any:
    def build(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return _call_c(builder, arguments)

    return types.int64(types.int64, types.int64), build


def _advance_called_back(_context: Any, address: Any, h: Any, state: Any, into: Any) -> Any:
    def build(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return _call_c(builder, arguments)

    return types.int64(types.int64, types.float64, types.int64, types.int64), build


call_law: Any = intrinsic(_law)
"""Calls a compiled law at an address: ``(address, state, gains, nominal_M, nominal_nle, work)``."""
call_back: Any = intrinsic(_called_back)
"""Calls a law back: ``(address, state)`` returns 0 or RAISED."""
call_advance: Any = intrinsic(_law_advance)
"""Calls at an address what moves a compiled law's memory on, with the arguments of ``Advance``."""
call_advance_back: Any = intrinsic(_advance_called_back)
"""Calls it back: ``(address, h, state, into)`` returns 0 or RAISED."""
