"""Whatever a law's own file does, it does to another process; and what is wrong is told."""

from __future__ import annotations

import pytest

from slidetune.robot.law_files.refused import LawFileError
from slidetune.robot.law_files.source import Source
from slidetune.robot.laws import LAWS
from slidetune.server.law_files.trial import try_apart
from tests.own_laws import EXAMPLE, before_torque

_ENDS = {
    "import os\nos._exit(3)\n": "exit status 3",
    "import os\nos.abort()\n": "SIGABRT",
    "import time\ntime.sleep(1e9)\n": "did not come back within",
    "print('{}')\nraise OSError('disk')\n": "line 2: OSError: disk",
}


def test_a_good_file_passes_and_nothing_of_it_is_known_here() -> None:
    try_apart(Source("pd.py", EXAMPLE))
    assert "pd_gravity" not in LAWS


@pytest.mark.parametrize("text", _ENDS)
def test_a_file_that_ends_its_process_or_never_comes_back_is_refused(text: str) -> None:
    with pytest.raises(LawFileError) as caught:
        try_apart(Source("bad.py", text), limit=10.0 if "sleep" in text else 300.0)
    assert _ENDS[text] in str(caught.value)


@pytest.mark.parametrize("kernel", ["@kernel\n", ""])
def test_a_law_that_never_returns_is_ended_in_a_real_process(kernel: str) -> None:
    text = before_torque("while True:", "    e += 1.0").replace("@kernel\n", kernel)
    with pytest.raises(LawFileError, match="EndlessLoopError"):
        try_apart(Source("bad.py", text), limit=300.0)


def test_it_has_to_do_in_the_present_experiment() -> None:
    text = before_torque("if kp > 700.0:", "    raise ValueError('stiff')")
    try_apart(Source("pd.py", text))
    lanes = {"A": {"law": "pd_gravity", "kp": 800.0}}
    with pytest.raises(LawFileError, match="stiff"):
        try_apart(Source("pd.py", text), "pd_gravity", {"lanes": lanes})
