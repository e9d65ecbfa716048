"""A law that is called back: what it raises comes out once, where it was raised."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.kernel_arrays import ask
from slidetune.robot.integrator.law_call import RAISED, checked, compiled_law
from slidetune.robot.kernels.workspace import WORK_ROWS
from slidetune.robot.laws import LAWS
from tests.robot.kernel_tables import table_of

Array = np.ndarray


def table_raising(*errors: Exception | None) -> Array:
    """Return the table of a law that raises these, one a call, and nothing where it is ``None``."""
    left = iter(errors)

    def control(*given: Any) -> None:
        error = next(left)
        if error is not None:
            raise error

    gains, work = np.ones((1, JOINTS)), np.zeros((WORK_ROWS, JOINTS))
    return table_of(work, gains=gains, control=control)


@pytest.mark.parametrize("name", LAWS)
def test_every_law_has_compiled_code_and_a_plain_function_has_none(name: str) -> None:
    control = LAWS[name].control
    assert compiled_law(control)
    assert not compiled_law(lambda *given: control(*given))


def test_what_a_law_raises_is_told_once() -> None:
    table = table_raising(ArithmeticError("first"), None)
    code = ask(0, table)
    assert code == RAISED
    with pytest.raises(ArithmeticError, match="first"):
        checked(code)
    assert checked(ask(0, table)) == 0
    # Nothing of it is left for a later one of which nobody knows the reason.
    with pytest.raises(RuntimeError, match="a law raised"):
        checked(RAISED)


def test_an_error_that_nobody_asked_for_is_not_told_for_the_next() -> None:
    table = table_raising(ArithmeticError("first"), ZeroDivisionError("second"))
    ask(0, table)
    with pytest.raises(ZeroDivisionError, match="second"):
        checked(ask(0, table))


def test_a_law_raises_in_the_thread_that_called_it() -> None:
    told: dict[int, str] = {}
    both_raised = threading.Barrier(2, timeout=60.0)

    def run(number: int) -> None:
        code = ask(0, table_raising(ArithmeticError(f"of thread {number}")))
        both_raised.wait()
        try:
            checked(code)
        except ArithmeticError as error:
            told[number] = str(error)

    threads = [threading.Thread(target=run, args=(number,)) for number in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert told == {number: f"of thread {number}" for number in range(2)}
    with pytest.raises(RuntimeError, match="a law raised"):
        checked(RAISED)
