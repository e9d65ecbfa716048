"""The budget clock, on a clock that the test turns itself."""

from __future__ import annotations

import pytest

from slidetune.server.live.pacing import LONGEST, TICK, Pacer

STEP = 0.001


class Clock:
    """A clock that stands until it is turned."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def run(pacer: Pacer, clock: Clock, ticks: int, cost: float = 0.0) -> int:
    """Tick and step as the session does; return how many steps were made."""
    steps = 0
    for _ in range(ticks):
        clock.now += TICK
        deadline = pacer.begin()
        while pacer.affords(STEP) and not pacer.overdue(deadline):
            pacer.spend(STEP)
            clock.now += cost
            steps += 1
        pacer.end(STEP)
    return steps


@pytest.mark.parametrize("speed", [0.1, 0.5, 1.0, 3.0, 10.0])
def test_simulated_time_follows_the_wall_at_every_speed(speed: float) -> None:
    clock = Clock()
    pacer = Pacer(clock)
    pacer.speed = speed
    steps = run(pacer, clock, 300)
    assert steps == pytest.approx(300 * TICK * speed / STEP, abs=max(2.0, 10 * speed))
    assert pacer.real_time_factor == pytest.approx(speed, rel=0.02)
    assert not pacer.capped


def test_steps_too_slow_for_the_speed_are_capped_and_said_so() -> None:
    clock = Clock()
    pacer = Pacer(clock)
    run(pacer, clock, 100, cost=4 * STEP)
    assert pacer.capped
    assert pacer.real_time_factor < 0.5


def test_debt_is_dropped_not_caught_up() -> None:
    clock = Clock()
    pacer = Pacer(clock)
    run(pacer, clock, 100, cost=4 * STEP)
    quick = run(pacer, clock, 10)
    assert quick <= (12 * TICK + LONGEST) / STEP


def test_a_short_shortage_is_made_up_for() -> None:
    clock = Clock()
    pacer = Pacer(clock)
    run(pacer, clock, 100)
    clock.now += 0.1
    run(pacer, clock, 50)
    assert not pacer.capped
    assert pacer.real_time_factor == pytest.approx(1.0, abs=0.03)


def test_a_suspended_process_makes_no_burst() -> None:
    clock = Clock()
    pacer = Pacer(clock)
    run(pacer, clock, 10)
    clock.now += 10.0
    assert run(pacer, clock, 1) <= (LONGEST + TICK) / STEP
    assert pacer.capped


def test_a_stall_is_told_once_and_a_hiccup_is_not() -> None:
    clock = Clock()
    pacer = Pacer(clock)
    run(pacer, clock, 10)
    told = []
    for pause in (0.3, 7.0, 0.0, 0.0):
        clock.now += pause
        run(pacer, clock, 1)
        told.append(pacer.stalled)
    assert told == pytest.approx([0.0, 7.0 + TICK, 0.0, 0.0])
    clock.now += 7.0
    pacer.restart()
    run(pacer, clock, 1)
    assert pacer.stalled == 0.0


def test_a_restart_forgets_the_pause() -> None:
    clock = Clock()
    pacer = Pacer(clock)
    run(pacer, clock, 10)
    clock.now += 5.0
    pacer.restart()
    assert run(pacer, clock, 1) <= TICK / STEP + 1
    assert not pacer.capped


def test_rest_never_sleeps_past_the_next_tick() -> None:
    clock = Clock()
    pacer = Pacer(clock)
    pacer.begin()
    clock.now += 0.3 * TICK
    assert pacer.rest() == pytest.approx(0.7 * TICK)
    clock.now += TICK
    assert pacer.rest() == 0.0
