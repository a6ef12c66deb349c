"""Instants at which pins set signals right: each sees what the blocks before it, events included, make of the instant.

A pin is a block that moves continuously and takes samples at listed times.  It follows the flow of signals like any
sampled block.  But what is sampled may let a massless stem slip at the same instant, and a pin behind that stem has to
see where it has slipped to, as a log does.  So all that is not behind such a block comes first (else a stem would see
an OP that is half set right), then the transitions, then what is ``late``.
"""

from collections.abc import Sequence

from numba import njit

from engine import layout as at
from engine.events import settle
from engine.flat import FlatBlock
from engine.layout import CURRENT, L_INSTANTS, LATE, N_EVENTS, N_INSTANTS, T
from engine.sampling import due, publish, take_all, take_swept, turn_tables
from engine.sweep import clock, signals


def late(rows: Sequence[FlatBlock]) -> list[bool]:
    """Return for each block, in signal-flow order, whether what it reads may jump at events of the same instant."""
    jumping: set[int] = set()  # signals
    found = []
    for block in rows:
        behind = not jumping.isdisjoint(block.wires)
        found.append(behind)
        if block.jumps or (behind and block.feeds and block.kind != at.DEAD_TIME):
            jumping.update(range(block.first_signal, block.first_signal + len(block.y0)))
    return found


@njit(cache=True, error_model="numpy")
def sample_and_pin(I, W, EV):  # type: ignore[no-untyped-def]
    """Run the sampled blocks and pins that are due now; return False if transitions never end."""
    turn_tables(I, W)
    publish(I, W)
    take_all(I, W)
    for k in range(I[N_INSTANTS]):
        row = I[I[L_INSTANTS] + k]
        if I[row + LATE] and due(I, W, row) <= W[T] + clock(W):
            if not settled(I, W, EV):
                return False
            take_swept(I, W, row)
            I[CURRENT] = 0
    return True


@njit(cache=True, error_model="numpy")
def settled(I, W, EV):  # type: ignore[no-untyped-def]
    """Carry out all transitions so far; return False if they never end."""
    if not I[CURRENT]:
        signals(I, W, W[T])
    I[CURRENT] = 1
    return I[N_EVENTS] == 0 or settle(I, W, EV)
