"""Facts that follow from the wiring of a component alone, before any number is known.

Which blocks follow which state at once, which stand still between two instants, which must be evaluated for the
state rates or for the event functions only, and where the Jacobian can be other than zero.  All of it is worked out
once per diagram, in plain Python.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from stickslip.engine import layout as at
from stickslip.engine.flat import FlatBlock

Pair = tuple[int, int]  # (row, column) of the Jacobian
Reached = tuple[int, int]  # (dead time, integrators on the way)
FAR = 9  # integrators: smooth


@dataclass(frozen=True)
class Structure:
    """Numbers of blocks (in signal-flow order) and of states.

    ``follows[b]``: the blocks whose outputs and those whose rates follow the states of block ``b`` at once.
    ``still[b]``: the outputs of block ``b`` change at instants only.  ``for_rates``, ``for_events``: the moving blocks
    needed there; ``entering``: those needed for what enters the dead times.  ``reach[b]``: which dead times the outputs
    of block ``b`` reach, if it does anything at an instant, and how many integrators lie at least on the way (fewer
    than ``FAR``: more do not matter).  ``rests[b]``: what block ``b`` reads stands still between instants.
    ``timed``: the rates depend on time directly; ``linear``: they are affine in states and time in each mode, between
    instants; ``affine``: all signals that move are, too.  ``entries``: (row, column) of the Jacobian, in the order in
    which it is filled.
    """

    follows: tuple[tuple[list[int], list[int]], ...]
    still: tuple[bool, ...]
    for_rates: tuple[int, ...]
    for_events: tuple[int, ...]
    entering: tuple[int, ...]
    reach: tuple[list[Reached], ...]
    rests: tuple[bool, ...]
    timed: bool
    linear: bool
    affine: bool
    entries: tuple[Pair, ...]


def analyse(rows: Sequence[FlatBlock]) -> Structure:
    """Return the structure of a component of these blocks, in signal-flow order."""
    driver = {block.first_signal + j: i for i, block in enumerate(rows) for j in range(len(block.y0))}
    readers = _readers(rows, driver)
    follows = tuple(_follows(rows, readers, number) for number in range(len(rows)))
    still = _still(rows, driver)
    has_events = [number for number, block in enumerate(rows) if block.n_events]
    delays = [number for number, block in enumerate(rows) if block.kind in at.RECORDING]
    has_states = [number for number, block in enumerate(rows) if len(block.x0)]
    first, total = [], 0
    for block in rows:
        first.append(total)
        total += len(block.x0)
    entries = []
    for number in has_states:
        for column in range(first[number], first[number] + len(rows[number].x0)):
            for other in follows[number][1]:
                entries += [(row, column) for row in range(first[other], first[other] + len(rows[other].x0))]
    return Structure(
        follows=follows,
        still=still,
        for_rates=_needed(rows, driver, still, has_states + has_events),
        for_events=_needed(rows, driver, still, has_events),
        entering=_needed(rows, driver, still, delays),
        reach=_reach(rows, readers, delays),
        rests=tuple(all(still[driver[w]] for w in block.wires) for block in rows),
        timed=any(_timed(block) for block in rows),
        linear=not delays and all(_linear(rows[i]) for i in {*has_states, *_needed(rows, driver, still, has_states)}),
        affine=all(still[i] or _linear(block) for i, block in enumerate(rows)),
        entries=tuple(entries),
    )


def _readers(rows: Sequence[FlatBlock], driver: dict[int, int]) -> list[list[int]]:
    """Return for each block those that read its outputs."""
    readers: list[list[int]] = [[] for _ in rows]
    for number, block in enumerate(rows):
        for origin in {driver[w] for w in block.wires}:
            readers[origin].append(number)
    return readers


def _follows(rows: Sequence[FlatBlock], readers: Sequence[list[int]], number: int) -> tuple[list[int], list[int]]:
    if not len(rows[number].x0):
        return [], []
    at_once, waiting = {number}, [number]
    while waiting:
        for i in readers[waiting.pop()]:
            if i not in at_once and _passes_on(rows[i]):
                at_once.add(i)
                waiting.append(i)
    ders = {number, *(i for out in at_once for i in readers[out] if len(rows[i].x0))}
    return [number, *sorted(at_once - {number})], sorted(ders)


def _passes_on(block: FlatBlock) -> bool:
    """Return whether the outputs follow the inputs at the same instant."""
    return block.kind == at.CONTINUOUS and block.feeds is not False


def _still(rows: Sequence[FlatBlock], driver: dict[int, int]) -> tuple[bool, ...]:
    """Return for each block whether its outputs stay as they are between two instants."""
    still = [
        block.kind in (at.SAMPLED, at.HOSTED, at.LINK_OUT) for block in rows
    ]  # also where they come behind their readers
    for number, block in enumerate(rows):
        if block.kind == at.CONTINUOUS and not (len(block.x0) or block.n_events or block.timed):
            still[number] = not block.feeds or all(still[driver[w]] for w in block.wires)
    return tuple(still)


def _needed(
    rows: Sequence[FlatBlock], driver: dict[int, int], still: Sequence[bool], readers: Sequence[int]
) -> tuple[int, ...]:
    """Return the moving blocks whose outputs reach the readers at the same instant, in flow order."""
    wanted = {w for number in readers for w in rows[number].wires}
    found = []
    for number in range(len(rows) - 1, -1, -1):
        block = rows[number]
        if not still[number] and any(block.first_signal + j in wanted for j in range(len(block.y0))):
            found.append(number)
            if _passes_on(block):
                wanted.update(block.wires)
    return tuple(reversed(found))


def _reach(rows: Sequence[FlatBlock], readers: Sequence[list[int]], delays: Sequence[int]) -> tuple[list[Reached], ...]:
    """Return ``Structure.reach``."""
    if not delays:
        return tuple([] for _ in rows)
    return tuple(_passes(rows, readers, number) if _does_something(block) else [] for number, block in enumerate(rows))


def _does_something(block: FlatBlock) -> bool:
    """Return whether a block's outputs can jump, or let out a jump, at an instant of its own."""
    return block.kind != at.CONTINUOUS or block.n_events > 0 or block.next_time is not None or block.listed > 0


def _passes(rows: Sequence[FlatBlock], readers: Sequence[list[int]], origin: int) -> list[Reached]:
    """Return the dead times that the outputs of one block reach, and through how many integrators at least."""
    best = {origin: 0}
    entered: dict[int, int] = {}
    waiting = deque([origin])
    while waiting:
        here = waiting.popleft()
        for number in readers[here]:
            block = rows[number]
            if block.kind in at.RECORDING:
                entered[number] = min(entered.get(number, FAR), best[here])
            elif block.kind == at.CONTINUOUS and (block.feeds or len(block.x0)):
                passes = best[here] + (not block.feeds)
                if passes < best.get(number, FAR):
                    best[number] = passes
                    waiting.append(number)
    return sorted(entered.items())


def _linear(block: FlatBlock) -> bool:
    return block.kind == at.CONTINUOUS and block.linear


def _timed(block: FlatBlock) -> bool:
    return block.kind in at.REPLAYING or (block.kind == at.CONTINUOUS and block.timed)
