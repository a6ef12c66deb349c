"""How tests run: one thread of linear algebra a worker, random examples alike in continuous integration, no clock.

The threads of small matrix products cost more than they save, and the workers take all cores already.  A shell that
starts the tests in the background lets them and all they start ignore Ctrl-C; those that press it need it heard.
"""

import os
import signal

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read when numpy is first imported

import pytest
from hypothesis import settings

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
settings.register_profile("stickslip", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("stickslip")


@pytest.fixture(scope="module")
def cluster():
    """A Dask cluster of two workers on this machine, anew for every file, because tests kill workers."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None, silence_logs=50
    ) as started:
        yield started
