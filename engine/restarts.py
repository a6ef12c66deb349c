"""Runs of one component that leave the same instant in states of their own, for filters that spread a state.

Each is given by the numbers that stand in certain ``places`` of the floats: states, memories, held outputs, and
parameters that hold a noise in force.  Everything else, clocks and counters included, is that of the run it leaves.
"""

import numpy as np
from stickslip.engine.call import pointer_to
from stickslip.engine.entry import call_advance
from stickslip.engine.events import keep_inputs, watch_rates
from stickslip.engine.flat import Floats, Ints
from stickslip.engine.floats import copy
from stickslip.engine.layout import (
    CURRENT,
    ENGINE,
    EV_COUNT,
    EVENTS_SEEN,
    FRESH,
    HOLD,
    N_BLOCKS,
    N_STATES,
    O_X,
    O_Y0,
    PAUSE_AT,
    SAVED,
    STEPS,
    H,
    R,
    T,
)
from stickslip.engine.sweep import signals
from stickslip.logs.compiled import njit


@njit(cache=True, error_model="numpy", inner=True)
def restore(ints, floats, kept_ints, kept_floats):  # type: ignore[no-untyped-def]
    """Set a run back to what was kept of it: its first integers, and its first floats."""
    for i in range(len(kept_ints)):
        ints[i] = kept_ints[i]
    for i in range(len(kept_floats)):
        floats[i] = kept_floats[i]


@njit(cache=True, error_model="numpy", inner=True)
def keep(ints, floats, kept_ints, kept_floats):  # type: ignore[no-untyped-def]
    """Keep of a run what it takes to set it back.

    Loops like this one stand in place of slices, which take several times as long to compile, and no less to run.
    """
    for i in range(len(kept_ints)):
        kept_ints[i] = ints[i]
    for i in range(len(kept_floats)):
        kept_floats[i] = floats[i]


@njit(cache=True, error_model="numpy", inner=True)
def write(source, target):  # type: ignore[no-untyped-def]
    """Write what stands in ``source`` to the beginning of ``target``."""
    for i in range(len(source)):
        target[i] = source[i]


@njit(cache=True, error_model="numpy", inner=True)
def begin(source, target):  # type: ignore[no-untyped-def]
    """Write what stands in ``source`` to the beginning of ``target``, and 0 behind it."""
    write(source, target)
    for i in range(len(source), len(target)):
        target[i] = 0.0


@njit(cache=True, error_model="numpy", inner=True)
def add(source, first, target):  # type: ignore[no-untyped-def]
    """Add what stands in ``source`` from ``first`` on to ``target``."""
    for i in range(len(target)):
        target[i] += source[first + i]


@njit(cache=True, error_model="numpy")
def put(ints, floats, places, z):  # type: ignore[no-untyped-def]
    """Let a run stand at ``z``.  What changes so is a better guess of the present, no jump that a block could see."""
    I, W = pointer_to(ints), pointer_to(floats)
    for i in range(len(places)):
        W[places[i]] = z[i]
    if I[EVENTS_SEEN] == -1:  # the run has not begun
        return
    if I[FRESH] == 1:  # samples of this instant are still to be taken
        return
    copy(W, I[O_Y0], I[O_X], I[N_STATES])
    signals(I, W, W[T])
    keep_inputs(I, W)
    watch_rates(I, W)
    I[CURRENT], I[FRESH] = 1, 2


@njit(cache=True, error_model="numpy")
def read(floats, places, z):  # type: ignore[no-untyped-def]
    """Write to ``z`` where a run stands."""
    for i in range(len(places)):
        z[i] = floats[places[i]]


@njit(cache=True, error_model="numpy", inner=True)
def arrive(ints, floats, buffer, t):  # type: ignore[no-untyped-def]
    """Advance a run to an instant, before anything happens there; return a status."""
    ints[HOLD] = 1
    return unlogged(ints, floats, buffer, t)


@njit(cache=True, error_model="numpy", inner=True)
def pass_instant(ints, floats, buffer):  # type: ignore[no-untyped-def]
    """Let everything happen that is due at the present instant; return a status."""
    ints[HOLD] = 0
    return unlogged(ints, floats, buffer, floats[T])


@njit(cache=True, error_model="numpy", inner=True)
def unlogged(ints, floats, buffer, t):  # type: ignore[no-untyped-def]
    """Advance a run of which nobody reads events or rows of a log."""
    ints[EV_COUNT] = 0
    I, W = pointer_to(ints), pointer_to(floats)
    return call_advance(I[ENGINE], I, W, pointer_to(buffer), len(buffer), W, 0, W, t, False)


def kept_sizes(I: Ints) -> tuple[int, int]:
    """Return how many integers and floats of a run have to be kept to go back to it."""
    return H + int(I[N_BLOCKS]) * R, int(I[SAVED])  # plans behind the rows of blocks stay


def never_paused(I: Ints) -> None:
    """Let a run go on without coming back to Python after some steps."""
    I[PAUSE_AT] = np.iinfo(np.int64).max


def steps_taken(I: Ints) -> int:
    """Return how many steps a run has taken."""
    return int(I[STEPS])


def standing(W: Floats, places: Ints) -> Floats:
    """Return where a run stands, (places,)."""
    found: Floats = W[places].copy()
    return found
