"""What a cluster is handed: a call by its content, made by workers of the same build alone."""

from __future__ import annotations

import hashlib
import json
import pickle
from collections.abc import Callable
from typing import Any

from slidetune.robot.arm.arm_document import arm_from, document_of
from slidetune.robot.arm.known import add_arm, arm_named
from slidetune.robot.arm.known_arm import is_own_name
from slidetune.robot.errors import FieldError, InvalidExperimentError, SlidetuneError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.laws import own_versions
from slidetune.server.compute.build import BUILD, Build, difference


class ClusterError(SlidetuneError):
    """What a study can't go on without is gone from its cluster, or isn't what it must be."""


class WrongBuildError(ClusterError):
    """A worker's results would not be those of the coordinator."""


def run_task(
    wanted: Build,
    arms: tuple[dict[str, Any], ...],
    function: Callable[..., Any],
    arguments: tuple[Any, ...],
) -> Any:
    """Call a function on a worker.

    Args:
        wanted: the build of the coordinator.
        arms: documents of the user's own arms that the experiments are about.
        function: what to call.
        arguments: its arguments.

    Raises:
        DamagedArmError: for an arm that isn't the one of its name.
        WrongBuildError: naming the worker, what it has and what is wanted.
    """
    if words := difference(BUILD, wanted):
        from distributed import get_worker

        raise WrongBuildError(f"worker {get_worker().address} has another build: {words}")
    for arm in arms:
        add_arm(arm_from(arm))
    return function(*arguments)


class _Call:
    """A call that is made where its pickle is loaded.

    So the scheduler, which loads what it is told of a task, passes on bytes and needs no Slidetune.
    """

    def __init__(self, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
        self._function, self._arguments = function, arguments

    def __reduce__(self) -> tuple[Any, ...]:
        return run_task, (BUILD, _own_arms(self._arguments), self._function, self._arguments)


def _own_arms(arguments: tuple[Any, ...]) -> tuple[dict[str, Any], ...]:
    """Return the documents of the user's own arms, without looks.

    They are numbers, not programs as a law is, and each is checked against the digest in its name:
    a worker may take them as it takes an experiment.
    """
    models = {one.robot.model for one in arguments if isinstance(one, Experiment)}
    return tuple(document_of(arm_named(name)) for name in sorted(models) if is_own_name(name))


def packed_call(function: Callable[..., Any], arguments: tuple[Any, ...]) -> bytes:
    """Return a call as bytes; ``pickle.loads`` makes it and returns what it returns."""
    return pickle.dumps(_Call(function, arguments))


def refuse_own_laws(arguments: tuple[Any, ...]) -> None:
    """Refuse what has a law from a file: the workers don't have it, and none is sent to them.

    Raises:
        InvalidExperimentError: naming the field ``scheduler`` and the laws.
    """
    experiments = [one for one in arguments if isinstance(one, Experiment)]
    own = sorted({name for one in experiments for name in own_versions(one.lanes)})
    if own:
        text = (
            f"the workers of a cluster don't know {', '.join(own)}, which is a law from a file of "
            "this machine: make the runs here, without --scheduler"
        )
        raise InvalidExperimentError([FieldError("scheduler", text)])


def content_key(function: Callable[..., Any], arguments: tuple[Any, ...]) -> str:
    """Return a name of a call that is the same in every process, and of no other call.

    Args:
        function: one of a module.
        arguments: experiments and plain JSON values.

    Raises:
        TypeError: for any other argument.
    """
    name = function.__qualname__
    content = json.dumps([BUILD, function.__module__, name, arguments], default=_plain)
    return f"{name}-{hashlib.sha256(content.encode()).hexdigest()[:32]}"


def _plain(value: object) -> Any:
    if isinstance(value, Experiment):
        return [value.document(), own_versions(value.lanes)]
    raise TypeError(f"{type(value).__name__} has no content key")
