"""How a kernel calls compiled code that it was not compiled with: by an address.

What a kernel calls by name becomes part of it, machine code and all, in every kernel once more. So
what is large is compiled once and called by address; and a loop calls laws that come after it.
"""

from __future__ import annotations

from typing import Any

from numba import types
from numba.core import cgutils


def address_of(function: Any, signature: Any) -> int:
    """Return where a kernel's compiled code is, which is there as long as the kernel.

    Args:
        function: a ``kernel``.
        signature: what it returns, and its arguments, as numba types.

    Raises:
        NumbaError: if it can't be compiled so.
    """
    result = function.get_compile_result(signature)
    address: int = result.library.get_pointer_to_function(result.fndesc.llvm_func_name)
    return address


_unlikely: Any = cgutils.if_unlikely


def called(signature: Any) -> Any:
    """Return what builds a call in a kernel: of the address, with the arguments that follow it."""

    def build(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        convention = context.call_conv
        kind = convention.get_function_type(signature.return_type, signature.args)
        function = builder.inttoptr(arguments[0], kind.as_pointer())
        status, value = convention.call_function(
            builder, function, signature.return_type, signature.args, arguments[1:]
        )
        with _unlikely(builder, status.is_error):
            convention.return_status_propagate(builder, status)
        return value

    return signature.return_type(types.int64, *signature.args), build
