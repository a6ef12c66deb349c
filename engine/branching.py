"""Branches: from one sample the next interval is run in several modes of a block, and the one that fits best is kept.

What a log does not show, the mode of a stem above all, a diagram pinned to it may have wrong.  The next sample tells:
its pins have to move further than noise lets them.  Then the interval is run again from the sample before, once for
every mode, let free at once or held in it, and if a mode explains the sample much better the run goes on from there.
Everything else, log rows and events included, is as if no other branch had been tried.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from stickslip.engine import layout as at
from stickslip.engine.advance import CHATTERING, OK, PAUSED
from stickslip.engine.call import pointer_to
from stickslip.engine.callback import raise_kept
from stickslip.engine.entry import advance_to
from stickslip.engine.events import fire, note, watch_rates
from stickslip.engine.flat import Floats, Ints
from stickslip.engine.floats import copy
from stickslip.engine.layout import (
    EV_COUNT,
    FRESH,
    HAS_RATES,
    N_BLOCKS,
    N_STATES,
    NG,
    O_G,
    O_G0,
    O_X,
    O_Y0,
    P_EVENTS,
    PAUSE_AT,
    SAVED,
    SKIPPED,
    D,
    G,
    H,
    R,
    T,
)
from stickslip.engine.run import EVENT_BUFFER, Outcome
from stickslip.engine.status import Status
from stickslip.engine.sweep import gather_with_rates, rates, signal_rates, signals
from stickslip.engine.table import Component
from stickslip.logs.compiled import njit

FOR_EVER = np.iinfo(np.int64).max
# The run's own branch; no literal, for which numba would compile what takes it once more.
OWN: int = np.int64(-1)  # type: ignore[assignment]


@dataclass(frozen=True)
class Branching:
    """When to try which modes of a block (number in the diagram), and what tells that one of them is right.

    ``stops`` (n,): the samples [s] at which a branch may be left, the end of the run among them.  ``pins``: the blocks
    whose memory ``d[0]`` is watched at each stop, ``limits`` [their unit] what it may be, or, where ``change`` says so,
    by how much it may change from one stop to the next.  Beyond that ``modes`` are tried, and one is kept if it brings
    the worst of them below ``share`` of what it was.  After tries in vain, stop after stop, 1, 2, 4, ... and at most
    ``patience`` stops go by until the next.  ``back``: how many stops further back a mode may have been wrong, where
    what it drives comes late to the pins; the block is then left free again behind that stop.
    """

    block: int
    modes: tuple[float, ...]
    stops: Floats
    pins: tuple[int, ...]
    limits: tuple[float, ...]
    change: tuple[bool, ...]
    share: float
    patience: int = 1
    back: int = 0


@dataclass(frozen=True)
class Kept:
    """What was kept (n,) at each stop: ``mode`` (NaN: the run's own), whether it was ``held``, the measures (n, 2).

    A measure is the worst pin in shares of its limit: on the run's own branch, and on the one kept.
    """

    mode: Floats
    held: Ints
    measures: Floats


@njit(cache=True, error_model="numpy", inner=True)
def put_in_mode(I, W, EV, row, mode):  # type: ignore[no-untyped-def]
    """Put a block into a mode at the present instant, by a transition of its own first: so it stays where it is."""
    d = I[row + D]
    if W[d] == mode:
        return
    copy(W, I[O_Y0], I[O_X], I[N_STATES])
    signals(I, W, W[T])
    if I[HAS_RATES]:
        rates(I, W, W[T])
        signal_rates(I, W, W[T])
    gather_with_rates(I, W, row)
    fire(I, W, EV, row, 0)
    if W[d] != mode:
        before, W[d] = W[d], mode
        note(I, W, EV, row, before)
    copy(W, I[O_X], I[O_Y0], I[N_STATES])
    watch_rates(I, W)
    I[FRESH] = 2


@njit(cache=True, error_model="numpy", inner=True)
def event_call(I, row):  # type: ignore[no-untyped-def]
    """Return where in the program of event functions the call of a block stands."""
    place = I[P_EVENTS]
    for _ in range(I[P_EVENTS + 1]):
        if I[place + 5] == I[O_G] + I[row + G]:
            break
        place += 7 + I[place + 6]
    return place


@njit(cache=True, error_model="numpy", inner=True)
def run_branch(ints, floats, buffer, grid, rows, row, modes, which, t_end, last):  # type: ignore[no-untyped-def]
    """Advance on one branch: ``OWN``, or twice the number of a mode, and one more to hold the block in it."""
    I, W = pointer_to(ints), pointer_to(floats)
    if which == OWN:
        return advance_to(ints, floats, buffer, grid, rows, t_end, last)
    put_in_mode(I, W, pointer_to(buffer), row, modes[which // 2])
    if which % 2 == 0:
        return advance_to(ints, floats, buffer, grid, rows, t_end, last)
    place, count = event_call(I, row), I[row + NG]
    kernel = I[place]
    I[place], I[row + NG] = SKIPPED, 0  # its event functions stand still, and none of them fires
    for i in range(count):
        W[I[O_G] + I[row + G] + i] = W[I[O_G0] + I[row + G] + i] = -1.0
    watch_rates(I, W)
    status = advance_to(ints, floats, buffer, grid, rows, t_end, last)
    I[place], I[row + NG] = kernel, count
    watch_rates(I, W)
    I[FRESH] = 2  # what has waited may happen now
    return status


@njit(cache=True, error_model="numpy")
def measure(floats, before, places, limits, change):  # type: ignore[no-untyped-def]
    """Return the worst of what is watched, in shares of its limit."""
    worst = 0.0
    for i in range(len(places)):
        moved = floats[places[i]] - (before[places[i]] if change[i] else 0.0)
        worst = max(worst, abs(moved) / limits[i])
    return worst


@njit(cache=True, error_model="numpy", inner=True)
def run_from(  # type: ignore[no-untyped-def]
    ints,
    floats,
    buffer,
    grid,
    rows,
    row,
    modes,
    which,
    stops,
    first,
    k,
    past_I,
    past_W,
    places,
    limits,
    change,
    measures,
):
    """Advance on one branch from the stop before ``first`` to stop ``k``; return its status and its worst pin there.

    ``past_I``, ``past_W``: what was there before each of the last stops, that of stop k in row k modulo their number;
    those behind ``first`` are written anew.  The worst pin is infinite if a stop on the way fits worse than before.
    """
    ring, size, saved = len(past_I), past_I.shape[1], past_W.shape[1]
    ints[:size] = past_I[first % ring]
    floats[:saved] = past_W[first % ring]
    there = 0.0
    for i in range(first, k + 1):
        slot = i % ring
        if i > first:
            past_I[slot] = ints[:size]
            past_W[slot] = floats[:saved]
        last = i == len(stops) - 1
        status = run_branch(ints, floats, buffer, grid, rows, row, modes, which if i == first else OWN, stops[i], last)
        if status != OK:
            return status, np.inf
        there = measure(floats, past_W[slot], places, limits, change)
        if i < k and there > max(1.0, measures[i, 1]):
            return status, np.inf
    return OK, there


@njit(cache=True, nogil=True, error_model="numpy")
def advance_branching(  # type: ignore[no-untyped-def]
    ints,
    floats,
    buffer,
    grid,
    rows,
    stops,
    row,
    modes,
    places,
    limits,
    change,
    share,
    patience,
    back,
    mode,
    held,
    measures,
    state,
):
    """Advance from stop to stop.  Resumable like ``advance.advance``.

    ``state``: the number of the next stop, how many stops are let go by after the next try in vain, and the first stop
    at which modes are tried again.
    """
    I = pointer_to(ints)
    size, saved, ring = H + I[N_BLOCKS] * R, I[SAVED], back + 1
    past_I, past_W = np.empty((ring, size), dtype=np.int64), np.empty((ring, saved))
    other_I, other_W = np.empty((ring, size), dtype=np.int64), np.empty((ring, saved))
    begin = state[0]  # what was before it is not known any more
    while state[0] < len(stops):
        k = state[0]
        if I[EV_COUNT] > buffer.shape[0] // 2:
            return PAUSED
        I[PAUSE_AT] = FOR_EVER
        past_I[k % ring] = ints[:size]
        past_W[k % ring] = floats[:saved]
        status = advance_to(ints, floats, buffer, grid, rows, stops[k], k == len(stops) - 1)
        if status != OK:
            return CHATTERING if status == PAUSED else status  # more events than there is room for
        own = measure(floats, past_W[k % ring], places, limits, change)
        measures[k, 0] = measures[k, 1] = own
        if own <= 1.0:
            state[1], state[2] = 1, 0
        elif k > 0 and k >= state[2]:  # nothing has been compared before the first stop
            best, kept, since = share * own, OWN, k
            other_I[:] = past_I
            other_W[:] = past_W
            for first in range(k, max(begin, 1, k - back) - 1, -1):
                if not np.isnan(mode[first]):
                    break  # it has been set right before
                d = past_I[first % ring, row + D]
                for tried in range(2 * len(modes)):
                    if tried % 2 == 0 and modes[tried // 2] == past_W[first % ring, d]:
                        continue  # the run's own branch
                    status, found = run_from(
                        ints, floats, buffer, grid, rows, row, modes, tried, stops, first, k, other_I, other_W,
                        places, limits, change, measures,
                    )  # fmt: skip
                    if status == OK and found < best:
                        best, kept, since = found, tried, first
            run_from(
                ints, floats, buffer, grid, rows, row, modes, kept, stops, since, k, past_I, past_W,
                places, limits, change, measures,
            )  # fmt: skip
            if kept != OWN:
                mode[since], held[since], measures[k, 1] = modes[kept // 2], kept % 2, best
                state[1] = 1
            else:
                state[2] = k + state[1]
                state[1] = min(2 * state[1], patience)
        state[0] += 1
    return OK


def run_branching(
    component: Component,
    I: Ints,
    W: Floats,
    times: Floats,
    t_end: float,
    given: Branching,
    on_progress: Callable[[float], None] | None = None,
) -> tuple[Outcome, Kept]:
    """Advance a prepared component to ``t_end`` as ``run.run`` does, with branches; return what was kept, too."""
    row = at.H + component.blocks.index(given.block) * at.R
    places = np.array([component.memory[b] for b in given.pins], dtype=np.int64)
    limits, change = np.array(given.limits), np.array(given.change)
    log = np.empty((len(component.columns), len(times)))
    buffer = np.empty((EVENT_BUFFER + 2 * int(I[at.MAX_CHAIN] + I[at.N_EVENTS]), 4))
    n = len(given.stops)
    mode, held, measures = np.full(n, np.nan), np.zeros(n, dtype=np.int64), np.full((n, 2), np.nan)
    state, events = np.array([0, 1, 0]), []
    try:
        while True:
            status = Status(
                advance_branching(
                    I, W, buffer, times, log, given.stops, row, np.array(given.modes), places, limits, change,
                    given.share, given.patience, given.back, mode, held, measures, state,
                )
            )  # fmt: skip
            events.append(buffer[: I[at.EV_COUNT]].copy())
            I[at.EV_COUNT] = 0
            raise_kept()
            if on_progress is not None:
                on_progress(float(W[at.T]))
            if status is not Status.PAUSED:
                break
    except KeyboardInterrupt:
        status = Status.INTERRUPTED
    log[:, int(I[at.ROW]) :] = np.nan
    outcome = Outcome(log, np.concatenate(events), status, float(W[at.T]), int(I[at.ROW]), I, W)
    return outcome, Kept(mode, held, measures)
