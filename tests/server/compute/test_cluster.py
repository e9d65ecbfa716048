"""Studies on a real cluster: the same results as one process, and a word about all that is lost."""

from __future__ import annotations

import http.server
import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from distributed import Client

from slidetune.robot.arm.known import add_arm, forget_arm
from slidetune.robot.arm.known_arm import own_arm
from slidetune.robot.arm.teaching import TWO_LINKS
from slidetune.robot.doctor.examine import examine
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.study.outcome import outcomes
from slidetune.robot.study.robustness import robustness
from slidetune.robot.study.tune import tune
from slidetune.robot.study.tuning import Tuning
from slidetune.server.compute.cluster import cluster_executor
from slidetune.server.compute.cluster_task import ClusterError, WrongBuildError, content_key
from slidetune.server.compute.executor import local_executor
from tests.server.compute.dask_cluster import (
    PATIENCE,
    ROOT,
    Cluster,
    begun,
    dask_cluster,
    until,
    wait_for,
)
from tests.server.test_cli import slidetune, strict

LANE = "RBFNN-NFTSM"
GOALS: dict[str, Any] = {
    "near": {"kind": "figure", "figure": "max_error", "bound": 0.01},
    "quiet": {"kind": "figure", "figure": "chattering", "bound": 5000.0, "priority": "hard"},
}
COMMANDS = [
    ("tune", "goal.yaml", "--trials", "24", "--draws", "12", "--out", "tuned.yaml"),
    ("robustness", "goal.yaml", "--draws", "24", "--worst", "12"),
    ("sweep", "goal.yaml", "k1=50:500:5:log", "robot.payload.mass=0:2:3", "--csv", "swept.csv"),
]


def experiment() -> Experiment:
    patch = {"simulation": {"horizon": 0.3}, "goals": GOALS, "uncertainty": {"payload": [0.0, 3.0]}}
    return load_preset("paper").patched(patch)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with an experiment in ``goal.yaml``."""
    (tmp_path / "goal.yaml").write_text(experiment_to_yaml(experiment()), encoding="utf-8")
    return tmp_path


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """A cluster of two workers that nobody kills."""
    with dask_cluster(tmp_path_factory.mktemp("cluster"), 2) as cluster:
        yield cluster


@pytest.fixture
def alone(tmp_path: Path) -> Iterator[Cluster]:
    """A scheduler without a worker as yet."""
    with dask_cluster(tmp_path / "cluster", 0) as cluster:
        yield cluster


@pytest.fixture
def other_source(tmp_path: Path) -> Path:
    """A checkout of the same version that differs in a comment."""
    copy = tmp_path / "other"
    for name in ("robot", "server", "slidetune", "presets"):
        unwanted = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / name, copy / name, symlinks=True, ignore=unwanted)
    with (copy / "robot" / "study" / "outcome.py").open("a", encoding="utf-8") as file:
        file.write("# Another one.\n")
    return copy


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[0])
def test_a_cluster_gives_what_one_process_does(
    pair: Cluster, folder: Path, command: tuple[str, ...]
) -> None:
    made = {}
    for where in (("--workers", "1"), ("--scheduler", pair.address)):
        done = slidetune(*command, *where, "--json", "study.json", folder=folder)
        assert done.returncode == 0, done.stderr
        files = {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}
        made[where[0]] = done.stdout, files
    assert made["--workers"] == made["--scheduler"]
    assert len(strict(files["study.json"].decode())) > 3
    assert "Cluster: 2 workers." in done.stderr


def test_a_task_has_the_same_key_in_every_process_and_no_other_has_it() -> None:
    code = (
        "from tests.server.compute.test_cluster import *;"
        "print(content_key(outcomes, (experiment(), LANE, [{'title': 'A'}], (0, 1))))"
    )
    keys = set()
    for seed in ("1", "2"):
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONHASHSEED": seed}
        command = [sys.executable, "-c", code]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        keys.add(done.stdout.strip())
    arguments = (experiment(), LANE, [{"title": "A"}], (0, 1))
    assert keys == {content_key(outcomes, arguments)}
    changed = experiment().patched({"robot": {"payload": {"mass": 1.0}}})
    others = [(changed, *arguments[1:]), (*arguments[:3], (0, 2)), arguments[:3]]
    assert len(keys | {content_key(outcomes, other) for other in others}) == 4
    assert content_key(robustness, arguments) not in keys
    with pytest.raises(TypeError, match="set has no content key"):
        content_key(outcomes, ({1},))


def test_what_is_fetched_is_forgotten_by_the_cluster(pair: Cluster, tmp_path: Path) -> None:
    gate = tmp_path / "gate"
    with cluster_executor(pair.address, print) as executor:
        twice = [executor.submit(wait_for, str(gate)) for _ in range(2)]
        until(lambda: begun(gate))
        gate.touch()
        assert [one.result(PATIENCE) for one in twice] == [str(gate)] * 2
        assert len(begun(gate)) == 1
        gate = tmp_path / "another"
        twice = [executor.submit(wait_for, str(gate)) for _ in range(2)]
        until(lambda: begun(gate))
        assert twice[0].cancel()
        gate.touch()
        assert twice[1].result(PATIENCE) == str(gate)
        tasks = [executor.submit(outcomes, experiment(), LANE, [{}], (n,)) for n in range(8)]
        assert all(task.result(PATIENCE) for task in tasks)
        with Client(pair.address, set_as_default=False) as client:
            known = lambda: client.run_on_scheduler(  # noqa: E731
                lambda dask_scheduler: len(dask_scheduler.tasks)
            )
            until(lambda: known() == 0)
            loaded = client.run_on_scheduler(lambda: "slidetune" in __import__("sys").modules)
    assert not loaded  # nor does it need to be installed where the scheduler is
    with pytest.raises(ClusterError, match="has ended"):
        executor.submit(wait_for, str(gate))


def test_a_worker_killed_in_the_middle_changes_nothing(alone: Cluster, tmp_path: Path) -> None:
    wanted = Tuning(lane=LANE, trials=16, draws=9)
    with local_executor(1) as executor:
        trials = list(tune(experiment(), wanted, executor))
        draws = list(robustness(experiment(), LANE, 24, executor))
    killed, _ = alone.start_worker(), alone.start_worker()
    told: list[str] = []
    gates = [tmp_path / "one", tmp_path / "two"]
    with cluster_executor(alone.address, told.append) as executor, ThreadPoolExecutor(2) as threads:
        held = [executor.submit(wait_for, str(gate)) for gate in gates]
        until(lambda: all(begun(gate) for gate in gates))
        made = [
            threads.submit(lambda: list(tune(experiment(), wanted, executor))),
            threads.submit(lambda: list(robustness(experiment(), LANE, 24, executor))),
        ]
        killed.kill()
        until(lambda: "Cluster: 1 of 2 workers lost, going on with 1." in told)
        for gate in gates:
            gate.touch()
        assert [one.result(PATIENCE) for one in held] == [str(gate) for gate in gates]
        assert [one.result(PATIENCE) for one in made] == [trials, draws]
        assert sorted(len(begun(gate)) for gate in gates) == [1, 2]
        alone.start_worker()
        until(lambda: told[-1] == "Cluster: 2 workers.")


@pytest.mark.parametrize("whole", [False, True], ids=["workers", "scheduler"])
def test_a_lost_cluster_ends_a_search_and_keeps_what_is_done(
    alone: Cluster, folder: Path, whole: bool
) -> None:
    alone.start_worker()
    alone.start_worker()
    command = ("tune", "goal.yaml", "--scheduler", alone.address, "--json", "lost.json")
    with ThreadPoolExecutor(1) as threads:
        search = threads.submit(
            slidetune, *command, "--trials", "20000", "--draws", "0", folder=folder
        )
        with Client(alone.address, set_as_default=False) as client:
            until(lambda: search.done() or client.run_on_scheduler(_made) > 20)
        assert not search.done(), search.result()
        for process in [alone.scheduler] if whole else alone.workers:
            process.kill()
        done = search.result()
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert "what is done is kept" in done.stderr
    end = "the scheduler at" if whole else "all of its 2 workers are lost"
    assert f"Error: {end}" in done.stderr
    trials = strict((folder / "lost.json").read_text(encoding="utf-8"))["trials"]
    assert len(trials) >= 8
    few = ("tune", "goal.yaml", "--trials", str(len(trials)), "--draws", "0", "--json", "few.json")
    assert slidetune(*few, folder=folder).returncode == 0
    assert strict((folder / "few.json").read_text(encoding="utf-8"))["trials"] == trials


# By value: the scheduler can't load this file.
_made = lambda dask_scheduler: sum(  # noqa: E731
    prefix.state_counts["memory"] for prefix in dask_scheduler.task_prefixes.values()
)


def test_a_scheduler_that_falls_silent_ends_what_waits_for_it(
    alone: Cluster, tmp_path: Path
) -> None:
    alone.start_worker()
    told: list[str] = []
    gate = tmp_path / "gate"
    with cluster_executor(alone.address, told.append) as executor:
        held = executor.submit(wait_for, str(gate))
        until(lambda: begun(gate))
        alone.scheduler.send(signal.SIGSTOP)
        with pytest.raises(ClusterError, match=r"the scheduler at tcp\S+ is lost"):
            held.result(PATIENCE)
        with pytest.raises(ClusterError, match="is lost"):
            executor.submit(wait_for, str(gate))
        assert told[-1] == "Cluster: the scheduler doesn't answer at present."
        gate.touch()


def test_a_task_that_ends_its_workers_is_given_up(tmp_path: Path) -> None:
    impatient = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}
    gate = tmp_path / "gate"
    with (
        dask_cluster(tmp_path, 2, **impatient) as cluster,
        cluster_executor(cluster.address, print) as executor,
    ):
        held = executor.submit(wait_for, str(gate))
        (taker,) = until(lambda: begun(gate))
        next(worker for worker in cluster.workers if worker.pid == taker).kill()
        with pytest.raises(ClusterError, match="a task ended every worker that took it"):
            held.result(PATIENCE)


def test_workers_of_another_build_are_refused_by_name(
    alone: Cluster, other_source: Path, tmp_path: Path
) -> None:
    good, wrong = alone.start_worker(), alone.start_worker(other_source)
    stub = tmp_path / "stub" / "slidetune"
    stub.mkdir(parents=True)
    (stub / "__init__.py").touch()
    none = alone.start_worker(stub.parent)
    with pytest.raises(InvalidExperimentError) as caught, cluster_executor(alone.address, print):
        raise AssertionError("these workers can't be used")
    refused = [str(field) for field in caught.value.fields]
    assert len(refused) == 2
    for worker, words in (
        (none, "can't load this Slidetune: No module named 'slidetune.server'"),
        (wrong, "has another build: sources "),
    ):
        beginning = f"scheduler: worker {worker.address} {words}"
        assert any(one.startswith(beginning) for one in refused)
    assert good.address not in str(caught.value)


def test_a_worker_of_another_build_that_comes_later_makes_no_run(
    alone: Cluster, other_source: Path, tmp_path: Path
) -> None:
    alone.start_worker()
    gate = tmp_path / "gate"
    with cluster_executor(alone.address, print) as executor:
        held = executor.submit(wait_for, str(gate))
        until(lambda: begun(gate))
        wrong = alone.start_worker(other_source)
        with pytest.raises(WrongBuildError, match=f"worker {wrong.address} has another build"):
            executor.submit(outcomes, experiment(), LANE, [{}]).result(PATIENCE)
        gate.touch()
        assert held.result(PATIENCE) == str(gate)


def test_a_worker_that_is_lost_while_it_is_asked_is_refused(alone: Cluster) -> None:
    asked = alone.start_worker()
    alone.start_worker()
    asked.send(signal.SIGSTOP)

    def tell(words: str) -> None:
        if words == f"Waiting for {asked.address} …":
            asked.kill()

    words = f"scheduler: worker {asked.address} is lost"
    with pytest.raises(InvalidExperimentError, match=words), cluster_executor(alone.address, tell):
        raise AssertionError("a worker is lost")


def test_a_scheduler_without_workers_is_refused(alone: Cluster, folder: Path) -> None:
    done = slidetune("tune", "goal.yaml", "--scheduler", alone.address, folder=folder)
    assert done.returncode == 2
    assert f"scheduler: the scheduler at {alone.address} has no worker" in done.stderr


def test_what_is_no_scheduler_is_refused(pair: Cluster) -> None:
    handler = http.server.SimpleHTTPRequestHandler
    with socket.create_server(("127.0.0.1", 0)) as silent, socket.socket() as closed:
        closed.bind(("127.0.0.1", 0))
        page = http.server.HTTPServer(("127.0.0.1", 0), handler)
        threading.Thread(target=page.serve_forever, daemon=True).start()
        there = [silent.getsockname()[1], closed.getsockname()[1], page.server_port]
        for address in [f"127.0.0.1:{port}" for port in there] + ["nowhere.invalid:8786"]:
            words = f"scheduler: .*tcp://{address}"
            with (
                pytest.raises(InvalidExperimentError, match=words),
                cluster_executor(address, print),
            ):
                raise AssertionError(address)
        page.shutdown()
        page.server_close()
    worker = pair.workers[0].address
    with (
        pytest.raises(InvalidExperimentError, match="Dask's worker, not its scheduler"),
        cluster_executor(worker, print),
    ):
        raise AssertionError(worker)


@pytest.mark.parametrize("address", ["", "here", "http://here:8786", "here:70000", "a b:1", "a:1/"])
def test_what_is_no_address_is_refused(address: str) -> None:
    with (
        pytest.raises(InvalidExperimentError, match="scheduler: must be HOST:PORT"),
        cluster_executor(address, print),
    ):
        raise AssertionError(address)


def test_the_command_says_how_to_install_what_a_cluster_needs(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "distributed.py").write_text("raise ImportError('there is none')\n")
    code = "import sys; sys.path.insert(0, '.'); from slidetune.server.cli import main; main()"
    arguments = ("tune", "goal.yaml", "--scheduler", "127.0.0.1:1")
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2
    assert "pip install 'slidetune[cluster]'" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_runs_are_made_here_or_there(folder: Path) -> None:
    both = ("--workers", "2", "--scheduler", "127.0.0.1:1")
    for command in COMMANDS:
        done = slidetune(*command, *both, folder=folder)
        assert done.returncode == 2
        assert "not both" in done.stderr


def test_an_arm_of_one_s_own_goes_with_its_runs(pair: Cluster) -> None:
    found = examine(TWO_LINKS)
    assert found.arm is not None
    arm = own_arm(found.arm, found.name)
    add_arm(arm)
    document = {"robot": {"model": arm.name}, "lanes": {LANE: {"law": "rbfnn_nftsm"}}}
    patch = {"simulation": {"horizon": 0.3}, "goals": GOALS, "uncertainty": {"payload": [0.0, 3.0]}}
    own = Experiment.from_document({**document, **patch})
    with local_executor() as pool:
        here = list(robustness(own, LANE, 6, pool))
    with cluster_executor(pair.address, print) as pool:
        there = list(robustness(own, LANE, 6, pool))
    assert there == here
    forget_arm(arm.name)
