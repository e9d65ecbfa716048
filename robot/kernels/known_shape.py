"""Arrays of a shape that is known when a kernel is compiled: their rows are found by constants.

They must be one block of that shape, which ``kernel_table`` has made sure of.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.numpy_support import carray

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import inlined
from slidetune.robot.kernels.workspace import WORK_ROWS


def _data(_context: Any, array: Any) -> Any:
    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        made = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.bitcast(made.data, cgutils.voidptr_t)

    return types.voidptr(array), build


_pointer: Any = intrinsic(_data)


@inlined
def as_floats(numbers):  # type: ignore[no-untyped-def]
    """Return the memory of whole numbers as float64: numpy's view takes 2 s to be compiled."""
    return carray(_pointer(numbers), (len(numbers),), np.float64)


@inlined
def workspace(work):  # type: ignore[no-untyped-def]
    """Return a workspace as one of known shape."""
    return carray(_pointer(work), (WORK_ROWS, JOINTS), np.float64)


@inlined
def square(matrix):  # type: ignore[no-untyped-def]
    """Return a matrix over the joints as one of known shape."""
    return carray(_pointer(matrix), (JOINTS, JOINTS), np.float64)
