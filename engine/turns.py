"""One instant: blocks take their turns, each behind all that decides now what it reads.

At an instant signals jump.  A block with modes is still in the one of before (as a run starts: in the one that it was
built with), and what follows it must not see that mode, but the one that its inputs call for.  So blocks are taken one
after the other, each behind all that its inputs depend on at this instant, blocks that pass signals on only by jumps (a
relay) included: first its transitions, then its sample.  A sample thus sees what the log has there, behind a massless
stem that slips at once too.  In a ring that such blocks close, they come last.  What rings and slopes of signals leave
to be done is for ``settle``.

While a run goes on, that is needed only where something samples or switches behind a block whose outputs follow its
modes.  In all other components samples alone take turns, in the order of signal flow.
"""

from collections.abc import Sequence

from stickslip.engine import layout as at
from stickslip.engine.call import call
from stickslip.engine.events import fire, show_jump, watch_rates
from stickslip.engine.flat import FlatBlock
from stickslip.engine.layout import (
    A_ZC,
    CHAIN,
    CONTINUOUS,
    CURRENT,
    EVENTS_SEEN,
    FEEDS,
    HAS_RATES,
    KIND,
    L_STARTING,
    L_TURNS,
    MAX_CHAIN,
    N_STARTING,
    N_TURNS,
    NG,
    NU,
    O_G,
    O_X,
    P_SIGNALS,
    RATES,
    SWEEP_CALLS,
    SWEEP_PLACE,
    SWEPT,
    SWEPT_CALLS,
    TAKES,
    D,
    G,
    P,
    T,
    U,
    X,
)
from stickslip.engine.sampling import due, take
from stickslip.engine.sweep import clock, gather, play_calls
from stickslip.logs.compiled import njit


def starting_order(rows: Sequence[FlatBlock]) -> list[int]:
    """Return the blocks, numbered in signal-flow order, that have transitions or take samples, as a run starts them.

    What depends on more comes later, as its ancestors hold those of all that it depends on; a ring has them in common.
    """
    above = _above(rows)
    return sorted(_acting(rows), key=lambda i: (above[i].bit_count(), not rows[i].feeds, i))


def turns(rows: Sequence[FlatBlock]) -> list[int]:
    """Return the blocks that take turns while a run goes on: as it starts, or samples alone where that is the same."""
    above = _above(rows)
    switching = sum(1 << i for i, block in enumerate(rows) if block.switches)
    if any(above[i] & switching & ~(1 << i) for i in _acting(rows)):
        return starting_order(rows)
    return [i for i in _acting(rows) if _samples(rows[i])]


def _above(rows: Sequence[FlatBlock]) -> list[int]:
    """Return for each block a bit for each of those that decide at an instant what it reads."""
    driver = {block.first_signal + j: i for i, block in enumerate(rows) for j in range(len(block.y0))}
    passing = [block.kind not in at.RECORDING and (block.feeds or block.switches) for block in rows]
    before = [{driver[w] for w in block.wires if passing[driver[w]]} for block in rows]
    above = [0] * len(rows)
    changed = True
    while changed:
        changed = False
        for i, drivers in enumerate(before):
            found = above[i]
            for j in drivers:
                found |= above[j] | 1 << j
            changed = changed or found != above[i]
            above[i] = found
    return above


def _acting(rows: Sequence[FlatBlock]) -> list[int]:
    return [i for i, block in enumerate(rows) if block.n_events or _samples(block)]


def _samples(block: FlatBlock) -> bool:
    return block.step is not None or block.kind == at.HOSTED


@njit(cache=True, error_model="numpy", inner=True)
def restart_sweep(I):  # type: ignore[no-untyped-def]
    """Begin a sweep over all signals, to be carried on by ``sweep_to``."""
    I[SWEEP_PLACE], I[SWEEP_CALLS] = I[P_SIGNALS], 0


@njit(cache=True, error_model="numpy", inner=True)
def sweep_to(I, W, place, calls):  # type: ignore[no-untyped-def]
    """Carry the sweep on to a place in the program of all signals, unless it is further."""
    if calls > I[SWEEP_CALLS]:
        play_calls(I, W, W[T], I[SWEEP_PLACE], calls - I[SWEEP_CALLS])
        I[SWEEP_PLACE], I[SWEEP_CALLS] = place, calls


@njit(cache=True, error_model="numpy", inner=True)
def end_sweep(I, W):  # type: ignore[no-untyped-def]
    """Carry the sweep on to its end."""
    play_calls(I, W, W[T], I[SWEEP_PLACE], I[P_SIGNALS + 1] - I[SWEEP_CALLS])
    I[CURRENT] = 1


@njit(cache=True, error_model="numpy", inner=True)
def sweep_again(I, row):  # type: ignore[no-untyped-def]
    """Take the sweep back to where the outputs of a block, which may have changed, come in."""
    if not I[row + FEEDS]:
        if I[row + KIND] == CONTINUOUS:
            restart_sweep(I)
    elif I[row + SWEPT_CALLS] < I[SWEEP_CALLS]:
        I[SWEEP_PLACE], I[SWEEP_CALLS] = I[row + SWEPT], I[row + SWEPT_CALLS]


@njit(cache=True, error_model="numpy", inner=True)
def take_turn(I, W, EV, row):  # type: ignore[no-untyped-def]
    """Settle the modes of one block, then take its sample if it is due.

    A block that looks at rates is shown jumps of its inputs; slopes are none here, for what they follow is not settled.
    """
    takes = I[row + TAKES] and due(I, W, row) <= W[T] + clock(W)
    if I[row + NG] == 0 and not takes:
        return
    sweep_to(I, W, I[row + SWEPT], I[row + SWEPT_CALLS])
    jumps = True
    if I[row + RATES] and I[EVENTS_SEEN] >= 0:
        jumps = show_jump(I, W, EV, row)
        sweep_again(I, row)
    g = I[O_G] + I[row + G]
    which = 0
    while jumps and which < I[row + NG] and I[CHAIN] <= I[MAX_CHAIN]:
        sweep_to(I, W, I[row + SWEPT], I[row + SWEPT_CALLS])
        gather(I, W, row)
        if I[row + RATES]:
            for i in range(I[row + NU]):
                W[I[row + U] + I[row + NU] + i] = 0.0
        call(I[row + A_ZC], W[T], W, I[O_X] + I[row + X], I[row + D], I[row + U], I[row + P], g)
        which = 0
        while which < I[row + NG] and not W[g + which] > 0.0:
            which += 1
        if which < I[row + NG]:
            fire(I, W, EV, row, which)
            sweep_again(I, row)
            which = 0
    if takes:
        sweep_to(I, W, I[row + SWEPT], I[row + SWEPT_CALLS])
        take(I, W, row)
        sweep_again(I, row)


@njit(cache=True, error_model="numpy", inner=True)
def take_turns(I, W, EV, begins):  # type: ignore[no-untyped-def]
    """Let all blocks take their turns, as the run ``begins`` or goes on; return False if transitions never end."""
    rows, count = (I[L_STARTING], I[N_STARTING]) if begins else (I[L_TURNS], I[N_TURNS])
    restart_sweep(I)
    for k in range(count):
        take_turn(I, W, EV, I[rows + k])
    end_sweep(I, W)
    if I[HAS_RATES]:
        watch_rates(I, W)
    return I[CHAIN] <= I[MAX_CHAIN]
