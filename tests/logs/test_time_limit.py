"""A limit of time ends its own block, and leaves an outer limit what is left of it."""

import signal
import threading
import time

import pytest
from stickslip.logs.time_limit import time_limit

pytestmark = pytest.mark.skipif(not hasattr(signal, "SIGALRM"), reason="no alarms on this system")


def test_the_inner_limit_ends_its_block_only():
    with time_limit(5.0, "outer"):
        with pytest.raises(TimeoutError, match="inner"), time_limit(0.02, "inner"):
            time.sleep(2.0)
        time.sleep(0.05)


def test_the_outer_limit_still_holds_behind_an_inner_one():
    begun = time.monotonic()
    with pytest.raises(TimeoutError, match="outer"), time_limit(0.2, "outer"):
        for _ in range(100):
            with time_limit(1.0, "inner"):
                time.sleep(0.05)
    assert 0.15 < time.monotonic() - begun < 2.0


def test_nothing_is_left_behind():
    before = signal.getsignal(signal.SIGALRM)
    with time_limit(5.0, "never"):
        pass
    assert signal.getsignal(signal.SIGALRM) is before and signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def test_in_another_thread_there_is_no_limit():
    done = []

    def work():
        with time_limit(0.01, "never"):
            time.sleep(0.05)
        done.append(True)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert done == [True]
