"""The first instant of a run: modes are settled before anything samples, latches or lets go of what they choose.

A block with modes starts in the one it was built with.  What follows it must not see that mode, but the one that its
inputs call for.  So blocks are taken one after the other, each behind all that its inputs depend on at this instant,
blocks that pass signals on only by jumps (a relay) included: first its transitions, then its sample.  A sample at the
start thus sees what the log has there, behind a massless stem that slips at once too; later it sees a stem before it
slips at the same instant.  In a ring that such blocks close, they come last: a ring begins with the modes that its
relays start in.
"""

from collections.abc import Sequence

from numba import njit

from engine import layout as at
from engine.call import call
from engine.events import fire
from engine.flat import FlatBlock
from engine.layout import (
    A_ZC,
    CHAIN,
    CURRENT,
    L_STARTING,
    MAX_CHAIN,
    N_STARTING,
    NG,
    O_G,
    O_X,
    TAKES,
    D,
    G,
    P,
    T,
    U,
    X,
)
from engine.sampling import due, publish, take_swept, turn_tables
from engine.sweep import clock, gather_with_rates, signals


def start_order(rows: Sequence[FlatBlock]) -> list[int]:
    """Return the blocks, numbered in signal-flow order, that have transitions or take samples, as a run starts them.

    What depends on more comes later, as its ancestors hold those of all that it depends on; a ring has them in common.
    """
    driver = {block.first_signal + j: i for i, block in enumerate(rows) for j in range(len(block.y0))}
    passing = [block.kind not in at.RECORDING and (block.feeds or block.jumps) for block in rows]
    before = [{driver[w] for w in block.wires if passing[driver[w]]} for block in rows]
    ancestors = [0] * len(rows)  # a bit for each block
    changed = True
    while changed:
        changed = False
        for i, drivers in enumerate(before):
            found = ancestors[i]
            for j in drivers:
                found |= ancestors[j] | 1 << j
            changed = changed or found != ancestors[i]
            ancestors[i] = found
    chosen = [i for i, b in enumerate(rows) if b.n_events or b.step is not None or b.kind == at.HOSTED]
    return sorted(chosen, key=lambda i: (ancestors[i].bit_count(), not rows[i].feeds, i))


@njit(cache=True, error_model="numpy")
def start_block(I, W, EV, row):  # type: ignore[no-untyped-def]
    """Settle the modes of one block, then take its sample if it is due; the signals must be, and are left, current."""
    g = I[O_G] + I[row + G]
    which = 0
    while which < I[row + NG] and I[CHAIN] <= I[MAX_CHAIN]:
        gather_with_rates(I, W, row)
        call(I[row + A_ZC], W[T], W, I[O_X] + I[row + X], I[row + D], I[row + U], I[row + P], g)
        which = 0
        while which < I[row + NG] and not W[g + which] > 0.0:
            which += 1
        if which < I[row + NG]:
            fire(I, W, EV, row, which)
            signals(I, W, W[T])
            which = 0
    if I[row + TAKES] and due(I, W, row) <= W[T] + clock(W):
        take_swept(I, W, row)
        signals(I, W, W[T])


@njit(cache=True, error_model="numpy")
def start(I, W, EV):  # type: ignore[no-untyped-def]
    """Carry out the first instant but for what ``settle`` finds left; return False if transitions never end."""
    turn_tables(I, W)
    publish(I, W)
    signals(I, W, W[T])
    for k in range(I[N_STARTING]):
        start_block(I, W, EV, I[I[L_STARTING] + k])
    I[CURRENT] = 1
    return I[CHAIN] <= I[MAX_CHAIN]
