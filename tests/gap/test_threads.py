"""Work on all cores: the same answer as on one, in the same order, and errors as they are."""

import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.threads import go_on, in_threads

from tests.gap.root_tank import logged, tank

# a worker of the tests keeps to one core, what started it does not
CORES = sorted(os.sched_getaffinity(os.getppid())) if hasattr(os, "sched_setaffinity") else []
several = pytest.mark.skipif(len(CORES) < 2, reason="needs two cores, and a say in which")


@contextmanager
def on(count: int) -> Iterator[None]:
    """Let this process use so many cores."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, CORES[:count])
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


@several
def test_two_pieces_of_work_run_at_once_and_come_in_order():
    meet = threading.Barrier(2, timeout=20.0)  # passes only where both are there

    def work(k):
        meet.wait()
        time.sleep(0.02 * (2 - k))
        return k

    with on(2):
        assert in_threads(work, [0, 1]) == [0, 1]


@several
def test_work_inside_work_stays_in_its_thread():
    def work(k):
        return {threading.get_ident()} == set(in_threads(lambda _: threading.get_ident(), range(4)))

    with on(2):
        assert all(in_threads(work, range(4)))


@several
@pytest.mark.parametrize("count", [1, 2])
def test_an_error_is_raised_and_progress_says_what_is_done(count):
    said = []
    with on(count):
        assert in_threads(str, [4, 5], lambda done, total: said.append((done, total))) == ["4", "5"]
        with pytest.raises(ZeroDivisionError):
            in_threads(lambda x: 1 / x, [1, 0, 2])
    assert said == [(0, 2), (1, 2), (2, 2)]


@several
def test_work_that_nobody_waits_for_ends():
    def work(k):
        if k == 0:
            time.sleep(0.1)
            raise ZeroDivisionError
        began = time.monotonic()
        while time.monotonic() - began < 60.0:
            go_on()
            time.sleep(0.01)

    began = time.monotonic()
    with on(2), pytest.raises(ZeroDivisionError):
        in_threads(work, range(2))
    assert time.monotonic() - began < 30.0


@several
def test_a_report_is_the_same_on_one_core_and_on_two():
    log = logged(effect("controller_gain").insert(tank(True), "controller", factor=1.15), 12, duration=1800.0)
    known = [effect(name) for name in ("controller_gain", "controller_integral_time", "process_gain", "stiction")]

    def report():
        return diagnose(tank(True), log, catalogue=known, limits=False).to_dict()

    with on(1):
        alone = report()
    with on(2):
        assert report() == alone
    assert [cause["effect"] for cause in alone["causes"]] == ["controller_gain"]
