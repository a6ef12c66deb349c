"""Where a large diagram is cut into cells that advance with steps of their own, see ``stickslip.engine.windows``.

A cut is possible at a signal that is smooth whatever happens: the output of an integrating block without events, whose
output follows its input later only.  Everything else, e.g. a valve's position or a controller's output, keeps the
blocks that it joins in one cell.  It pays if there are many cells, most of them with events or samples.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from stickslip.engine.flat import CONTINUOUS, HOSTED, LINK_IN, LINK_OUT, SAMPLED, FlatBlock

MANY = 32  # cells; with fewer, one step size for all is cheaper
RING = 64  # steps of a cell in one window
MOST_READ = 8  # links into a cell, on average; with more, replaying them costs more than it saves


@dataclass(frozen=True)
class Cut:
    """The flat blocks, joined by links where they were wired, cell by cell; ``links``: what records, what replays."""

    flat: tuple[FlatBlock, ...]
    cells: tuple[tuple[int, ...], ...]
    links: tuple[tuple[int, int], ...]


def driver_of(flat: Sequence[FlatBlock]) -> dict[int, int]:
    """Return which block drives each signal."""
    return {block.first_signal + j: f for f, block in enumerate(flat) for j in range(len(block.y0))}


def smooth_outputs(flat: Sequence[FlatBlock]) -> set[int]:
    """Return the blocks at whose outputs a diagram can be cut."""
    return {
        f
        for f, block in enumerate(flat)
        if block.kind == CONTINUOUS and len(block.x0) and not block.feeds and not block.n_events
    }


def watched(flat: Sequence[FlatBlock], groups: Sequence[Sequence[int]]) -> set[int]:
    """Return the blocks whose outputs reach at once, in another group, a block that watches rates.

    It would see a jump in the least difference between one window and the next: no cut there.
    """
    driver = driver_of(flat)
    found: set[int] = set()
    for group in groups:
        inside = set(group)
        waiting = [f for f in group if flat[f].rates]
        sees = set(waiting)
        while waiting:
            for origin in {driver[w] for w in flat[waiting.pop()].wires} - sees:
                if origin not in inside:
                    found.add(origin)
                elif flat[origin].kind == CONTINUOUS and flat[origin].feeds:
                    sees.add(origin)
                    waiting.append(origin)
    return found


def cut(flat: Sequence[FlatBlock], groups: Sequence[Sequence[int]], signals: int) -> Cut | None:
    """Cut a diagram into ``groups`` of blocks that only smooth signals join; return None if that saves no time."""
    if any(block.kind == HOSTED for block in flat) or len(groups) < MANY:
        return None
    driver = driver_of(flat)
    shared = {f for f, count in _counts(groups).items() if count > 1}  # static sources, copied into each
    group_of = {f: g for g, group in enumerate(groups) for f in group if f not in shared}
    crossing = sorted(
        {
            (w, g)
            for g, group in enumerate(groups)
            for f in group
            for w in flat[f].wires
            if driver[w] not in shared and group_of[driver[w]] != g
        }
    )
    busy = sum(any(flat[f].n_events or flat[f].listed or flat[f].kind == SAMPLED for f in group) for group in groups)
    if not crossing or 2 * busy < len(groups) or len(crossing) > MOST_READ * len(groups):
        return None
    blocks, cells, links = [*flat], [[*group] for group in groups], []
    recorders: dict[int, int] = {}
    replaced: dict[tuple[int, int], int] = {}
    for w, g in crossing:
        origin = group_of[driver[w]]
        if w not in recorders:
            recorders[w] = len(blocks)
            blocks.append(_link(f"{flat[driver[w]].name}:leaves", LINK_OUT, (w,), signals, np.inf))
            cells[origin].append(recorders[w])
        replaced[w, g] = signals
        links.append((recorders[w], len(blocks)))
        cells[g].insert(0, len(blocks))
        blocks.append(_link(f"{flat[driver[w]].name}:arrives", LINK_IN, (), signals, 0.0))
        signals += 1
    for f, g in group_of.items():
        wires = tuple(replaced.get((w, g), w) for w in flat[f].wires)
        if wires != flat[f].wires:
            blocks[f] = replace(flat[f], wires=wires)
    return Cut(tuple(blocks), tuple(tuple(cell) for cell in cells), tuple(links))


def _counts(groups: Sequence[Sequence[int]]) -> Mapping[int, int]:
    counts: dict[int, int] = {}
    for group in groups:
        for f in group:
            counts[f] = counts.get(f, 0) + 1
    return counts


def _link(name: str, kind: int, wires: tuple[int, ...], first: int, theta: float) -> FlatBlock:
    return FlatBlock(
        name=name,
        kind=kind,
        p=np.array([theta, 0.0]),
        x0=np.zeros(0),
        d0=np.zeros(0),
        y0=np.zeros(1 if kind == LINK_IN else 0),
        wires=wires,
        first_signal=first,
        feeds=False,
        capacity=RING,
    )
