"""How tests run: random examples alike in continuous integration, no clock.

A shell that starts the tests in the background lets them and all they start ignore Ctrl-C; those that press it need it
heard.
"""

import gc
import os
import signal
import sys

import pytest
from hypothesis import settings

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
settings.register_profile("stickslip", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("stickslip")

COMPILED = pytest.StashKey[list[str]]()


def pytest_collection_finish(session):
    """Note which functions numba has compiled, or loaded from its cache, while tests were collected.

    What collecting has made, some million objects, stays to the end: the search for garbage need not look at it.
    """
    gc.freeze()
    numba = sys.modules.get("numba.core.dispatcher")
    session.config.stash[COMPILED] = [
        f"{name}.{key}"
        for name, module in list(sys.modules.items())
        for key, thing in list(vars(module).items())
        if numba and isinstance(thing, numba.Dispatcher) and thing.signatures and thing.__module__ == name
    ]


@pytest.fixture(autouse=True, scope="module")
def own_cache(tmp_path_factory):
    """Keep calibrations in a folder of each module: what another has counted changes no probability here."""
    patch = pytest.MonkeyPatch()
    patch.setenv("STICKSLIP_CACHE", str(tmp_path_factory.mktemp("calibrations")))
    yield
    patch.undo()


@pytest.fixture(scope="module")
def cluster():
    """A Dask cluster of two workers on this machine, anew for every file, because tests kill workers."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None, silence_logs=50
    ) as started:
        yield started


@pytest.fixture
def hidden_valve(tmp_path):
    """A file of two levels: the inflow hides LC1's valve, and the flow behind it jumps; all by formulas."""
    import numpy as np
    from stickslip.detect.stem.stick import stick
    from stickslip.logs import Log, LoopSignals

    t = np.arange(3000.0)
    u = 50 + 4 * np.sin(t / 50) + 2 * np.sin(t / 31)
    signals = {"u": u, "p": np.cos(t / 90), "v": u[::-1], "q": np.sin(t / 70), "f": stick(u, 4.0, 1.5)}
    loops = {"LC1": LoopSignals("p", "u"), "LC2": LoopSignals("q", "v")}
    Log(t, signals, spans={"u": (0, 100), "v": (0, 100)}, loops=loops).to_csv(tmp_path / "unit.csv")
    return tmp_path / "unit.csv"
