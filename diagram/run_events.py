"""Events of a run: changes of mode, in order of time and with names."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stickslip.diagram.diagram import Diagram

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Event:
    """A change of mode: time [s], block, mode before, mode after."""

    t: float
    block: str
    before: str
    after: str


def in_order(events: Sequence[Floats]) -> Floats:
    """Return the changes of mode of several components in order of time, (events, 4), read-only."""
    rows = events[0] if len(events) == 1 else np.concatenate(events)
    if len(events) > 1:
        rows = rows[np.argsort(rows[:, 0], kind="stable")]
    rows.flags.writeable = False
    return rows


def named_events(diagram: Diagram, rows: Iterable[Sequence[float]]) -> tuple[Event, ...]:
    """Return changes of mode with names for the numbers of ``rows``: t, block, before, after."""
    modes: dict[int, dict[float, str]] = {}
    events = []
    for t, block, before, after in rows:
        b = int(block)
        if b not in modes:
            modes[b] = {value: name for name, value in diagram.blocks[b].modes.items()}
        names = modes[b]
        events.append(Event(t, diagram.blocks[b].name, names.get(before, str(before)), names.get(after, str(after))))
    return tuple(events)
