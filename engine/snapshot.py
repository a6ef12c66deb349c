"""The arrays of one component at a moment of its run, read and written by block: what stands between diagram and slots.

Nothing outside ``engine`` knows where in the two arrays a number lives; it asks a snapshot by the number of a block
or of a signal.  A snapshot is a view: what is written into it is in the run.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from stickslip.engine import layout as at
from stickslip.engine.flat import Floats, Ints
from stickslip.engine.status import Statistics
from stickslip.engine.table import Component

COUNTERS = {
    "steps": at.STEPS, "rejected": at.REJECTED, "rhs": at.RHS, "jacobians": at.JACOBIANS, "events": at.EVENTS,
}  # fmt: skip
_COUNTED = np.array(list(COUNTERS.values()))


class Snapshot(NamedTuple):
    """A component with its integers ``I`` and floats ``W``; ``Snapshot(component, component.I, component.W)`` at rest.

    Blocks and signals go by their numbers in the diagram; ``n`` says how many values a block has.
    """

    component: Component
    I: Ints
    W: Floats

    @property
    def t(self) -> float:
        """The time reached [s]."""
        return float(self.W[at.T])

    # --- blocks ---------------------------------------------------------------------------------------------
    def states(self, b: int, n: int) -> Floats:
        """Return the states of a block, shape (n,)."""
        start = self.component.states[b]
        return self.W[start : start + n]

    def memory(self, b: int, n: int) -> Floats:
        """Return modes and memories of a block, shape (n,)."""
        start = self.component.memory[b]
        return self.W[start : start + n]

    def params(self, b: int, n: int) -> Floats:
        """Return the parameters of a block, shape (n,)."""
        start = self.component.params[b]
        return self.W[start : start + n]

    def outputs(self, signal: int, n: int) -> Floats:
        """Return the values of ``n`` signals from ``signal`` on, the outputs of one block."""
        start = self.component.signals[signal]
        return self.W[start : start + n]

    def put(self, places: NDArray[np.intp], values: Floats) -> None:
        """Write values to ``places``, as ``offset`` counts them."""
        self.W[places] = values

    def point_to(self, b: int, timetable: Floats) -> None:
        """Let a block read this timetable (rows, numbers in a row), which must stay where it is during the run."""
        row = at.H + self.component.blocks.index(b) * at.R
        self.I[row + at.TABLE], self.I[row + at.TABLE_ROWS] = timetable.ctypes.data, len(timetable)

    # --- what is under way ----------------------------------------------------------------------------------
    def delays(self) -> Iterator[tuple[int, float, Floats]]:
        """Yield the dead times: number, length [s], records (n, values of a record) from the oldest on."""
        for f, row in self._rows(at.DEAD_TIME):
            ring = self.W[self.I[row + at.DELAY] :][: self.I[row + at.CAPACITY] * at.D_SIZE].reshape(-1, at.D_SIZE)
            kept = np.arange(self.I[row + at.TAIL], self.I[row + at.HEAD]) % len(ring)
            yield f, float(self.W[self.component.params[f]]), ring[kept]

    def fill_delays(self, records: Mapping[int, Floats]) -> None:
        """Let the dead times begin with records as ``delays`` gives them, by number."""
        for f, row in self._rows(at.DEAD_TIME):
            self.W[self.I[row + at.DELAY] :][: records[f].size] = records[f].ravel()
            self.I[row + at.HEAD] = len(records[f])

    def sample_first(self, blocks: Collection[int]) -> None:
        """Let the compiled ones of some blocks that take samples take one as the run begins: they took none before."""
        for number, f in enumerate(self.component.blocks):
            row = at.H + number * at.R
            if self.I[row + at.TAKES] and f in blocks:
                self.I[row + at.COUNT] = -1

    # --- cost -----------------------------------------------------------------------------------------------
    @property
    def counts(self) -> NDArray[np.int64]:
        """The cost of the run so far, in the order of ``COUNTERS``."""
        counts: NDArray[np.int64] = self.I[_COUNTED]
        return counts

    def _rows(self, kind: int) -> Iterator[tuple[int, int]]:
        for number, f in enumerate(self.component.blocks):
            row = at.H + number * at.R
            if self.I[row + at.KIND] == kind:
                yield f, row


def offset(component: Component, kind: str, b: int, index: int) -> int:
    """Return the place of one parameter ("p"), start state ("x0") or memory ("d0") of a block, for ``Snapshot.put``."""
    starts = {"p": component.params, "x0": component.states, "d0": component.memory}
    return starts[kind][b] + index


def logging_only(component: Component, kept: Sequence[int]) -> Component:
    """Return a copy of a component that logs only some of its columns, by their present places."""
    I, W = component.I.copy(), component.W.copy()
    first = int(I[at.L_WIRES])
    I[first : first + len(kept)] = component.I[[first + k for k in kept]]
    I[at.N_LOG] = len(kept)
    return replace(component, I=I, W=W, columns=tuple(component.columns[k] for k in kept))


def total(counts: Sequence[NDArray[np.int64]]) -> Statistics:
    """Add up what components cost, given the ``counts`` of each.

    >>> total([np.array([10, 1, 60, 0, 2]), np.array([5, 0, 30, 0, 0])])
    Statistics(steps=15, rejected=1, rhs=90, jacobians=0, events=2, components=2)
    """
    columns = zip(*(one.tolist() for one in counts), strict=True)
    return Statistics(**dict(zip(COUNTERS, map(sum, columns), strict=True)), components=len(counts))
