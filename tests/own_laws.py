"""Laws of one's own for tests: those of the documentation, and the registry put back after them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from slidetune.robot import laws

_BLOCKS = re.findall(
    r"```python\n(.*?)```",
    (Path(__file__).parents[1] / "docs/own-law.md").read_text(encoding="utf-8"),
    re.DOTALL,
)
EXAMPLE: str = _BLOCKS[0]
"""The worked example of docs/own-law.md."""
PLAIN: str = re.sub(r"@kernel\ndef control.*?(?=\n\n\nLAW)", _BLOCKS[1], EXAMPLE, flags=re.DOTALL)
"""The same with the plain ``control`` that stands there."""
_LAST = "        work[TAU, j] = work[REACH, j] + nominal_nle[j]\n"


def before_torque(*lines: str) -> str:
    """Return the example with lines before the one that writes a joint's torque."""
    assert EXAMPLE.count(_LAST) == 1
    inserted = "".join(f"        {line}\n" for line in lines)
    return EXAMPLE.replace(_LAST, inserted + _LAST)


@contextmanager
def own_laws() -> Iterator[None]:
    """Forget every law of one's own at the end of a block."""
    shipped = {name: laws.LAWS[name] for name in laws.LAWS if name in laws.SHIPPED}
    try:
        yield
    finally:
        laws.LAWS.clear()
        laws.LAWS.update(shipped)
