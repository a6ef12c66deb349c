"""What takes long computes on one core; processes are not ended by Ctrl-C, and begin nothing once the block is left."""

import os
import signal
import subprocess
import sys
import time
from multiprocessing import get_all_start_methods
from pathlib import Path

import numpy as np
import pytest
from stickslip.logs.processes import one_thread, processes
from threadpoolctl import threadpool_info, threadpool_limits

from stickslip import calibration, detect, gap


def threads() -> list[int]:
    assert np.linalg.norm(np.eye(2)) > 1.0  # loads the library
    return [one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"]


def hit_by_ctrl_c() -> int:
    os.kill(os.getpid(), signal.SIGINT)
    return os.getpid()


def slow(marker: Path) -> None:
    time.sleep(0.3)
    marker.touch()


def test_each_process_computes_with_one_thread_and_so_does_the_one_that_asks_meanwhile() -> None:
    if not threads():
        pytest.skip("this numpy has no library of linear algebra that says how many threads it uses")
    with threadpool_limits(2):
        before = threads()
        with processes(1) as pool:
            there, here = pool.submit(threads).result(), threads()
        after = threads()
    assert set(there) == set(here) == {1}
    assert after == before


def test_ctrl_c_does_not_reach_them() -> None:
    with processes(1) as pool:
        first = pool.submit(hit_by_ctrl_c).result()
        assert pool.submit(os.getpid).result() == first != os.getpid()


def test_what_waits_is_not_begun_when_the_block_is_left_by_an_error(tmp_path) -> None:
    with pytest.raises(KeyboardInterrupt), processes(1) as pool:
        for number in range(20):
            pool.submit(slow, tmp_path / str(number))
        raise KeyboardInterrupt
    assert len(list(tmp_path.iterdir())) < 6


@pytest.mark.parametrize("start", ["forkserver", "spawn"])
def test_a_script_without_a_main_guard_runs_once(start, tmp_path) -> None:
    if start not in get_all_start_methods():
        pytest.skip(f"no {start} on this system")
    script = tmp_path / "script.py"
    script.write_text(f"""
import os, sys
from stickslip.logs import processes
print("begun")
processes.get_all_start_methods = lambda: ["{start}"]
with processes.processes(2) as pool:
    print(set(pool.map(os.path.basename, ["a", "b", "c"])), sys.modules["__main__"].__file__ == __file__)
""")
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("begun") == 1 and done.stdout.endswith("} True\n")


@pytest.mark.parametrize("threads", [None, "2"])
def test_the_command_computes_with_one_thread_unless_told_otherwise(threads) -> None:
    code = "import os, sys; sys.argv = ['stickslip', '--help']; import stickslip.__main__ as m\n"
    code += "try:\n    m.main()\nexcept SystemExit:\n    print('threads', os.environ['OPENBLAS_NUM_THREADS'])"
    given = {k: v for k, v in os.environ.items() if k != "OPENBLAS_NUM_THREADS"}
    given |= {} if threads is None else {"OPENBLAS_NUM_THREADS": threads}
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=given, check=True)
    assert run.stdout.splitlines()[-1] == f"threads {threads or 1}"


@one_thread
def threads_alone() -> list[int]:
    return threads()


def test_a_function_computes_with_one_thread_and_leaves_the_number_as_it_was() -> None:
    with threadpool_limits(2):
        before = threads()
        assert set(threads_alone()) <= {1}
        assert threads() == before


def test_what_takes_long_computes_with_one_thread() -> None:
    alone = one_thread(max).__code__
    for asked in (gap.diagnose, gap.calibrated, detect.diagnose, detect.compare, detect.survey, calibration.at_record):
        assert asked.__code__ is alone, f"{asked.__qualname__} computes with as many threads as there are cores"
