"""Blocks that run in Python, between two calls of the engine."""

import numpy as np
from stickslip.engine import layout as at
from stickslip.engine.call import pointer_to
from stickslip.engine.delay import happens
from stickslip.engine.events import begin_instant
from stickslip.engine.flat import FlatBlock, Floats, Ints
from stickslip.engine.sampling import publish, turn_tables
from stickslip.engine.sweep import resolution, signals
from stickslip.engine.table import Component
from stickslip.engine.turns import restart_sweep, take_turn
from stickslip.logs.compiled import njit


@njit(cache=True, error_model="numpy")
def open_instant(ints, floats):  # type: ignore[no-untyped-def]
    """Begin an instant and publish, called from Python with the arrays themselves."""
    I, W = pointer_to(ints), pointer_to(floats)
    begin_instant(I, W)
    turn_tables(I, W)
    publish(I, W)


@njit(cache=True, error_model="numpy")
def turn_of(ints, floats, buffer, row):  # type: ignore[no-untyped-def]
    """Let one block take its turn, called from Python with the arrays themselves; the signals need not be current."""
    I, W = pointer_to(ints), pointer_to(floats)
    restart_sweep(I)
    take_turn(I, W, pointer_to(buffer), row)


@njit(cache=True, error_model="numpy")
def output_jumps(ints, row):  # type: ignore[no-untyped-def]
    """Tell the dead times that a block's output may have jumped, called from Python with the array itself."""
    happens(pointer_to(ints), row, 0)


@njit(cache=True, error_model="numpy")
def refresh(ints, floats, t):  # type: ignore[no-untyped-def]
    """Compute every signal at ``t``, called from Python with the arrays themselves."""
    signals(pointer_to(ints), pointer_to(floats), t)


class Hosts:
    """The blocks of one component that run in Python, with the states of this run."""

    def __init__(self, component: Component, blocks: tuple[FlatBlock, ...], W: Floats) -> None:
        self.rows = {b: at.H + component.blocks.index(b) * at.R for b in component.hosted}
        self.blocks = blocks
        self.component = component
        self.taken = dict.fromkeys(component.hosted, 0)
        for b in component.hosted:
            self.taken[b] = _samples_before(float(W[at.T]), self._due(b, W), self._p(b, W)[blocks[b].period_at])
            if self._due(b, W) <= W[at.SEEN] + resolution(W[at.T]):
                self.taken[b] += 1
        self.states = {b: blocks[b].host.init(self._p(b, W)) for b in component.hosted}

    def _p(self, b: int, W: Floats) -> Floats:
        start = self.component.params[b]
        return W[start : start + len(self.blocks[b].p)]

    def _due(self, b: int, W: Floats) -> float:
        block, p = self.blocks[b], self._p(b, W)
        offset = p[block.offset_at] if block.offset_at >= 0 else 0.0
        return float(offset + self.taken[b] * p[block.period_at])

    def next_due(self, W: Floats) -> float:
        return min(self._due(b, W) for b in self.rows)

    def sample(self, I: Ints, W: Floats, buffer: Floats) -> None:
        """Let all blocks take their turns at the present instant, compiled and hosted ones alike.

        Changes of mode are noted in the event ``buffer``.
        """
        now = self.next_due(W)
        open_instant(I, W)
        hosted = {row: b for b, row in self.rows.items()}
        turns = at.L_STARTING if I[at.EVENTS_SEEN] < 0 else at.L_TURNS
        for row in I[I[turns] : I[turns] + I[turns + 1]].tolist():
            if row not in hosted:
                turn_of(I, W, buffer, row)
                continue
            b = hosted[row]
            if self._due(b, W) > now + resolution(now):
                continue
            refresh(I, W, now)
            wires = I[I[row + at.WIRES] : I[row + at.WIRES] + I[row + at.NU]]
            u = W[I[at.O_S] + wires]
            self.states[b], y = self.blocks[b].host.step(now, self.states[b], u, self._p(b, W))
            first = I[at.O_S] + I[row + at.Y]
            W[first : first + I[row + at.NY]] = y
            self.taken[b] += 1
            output_jumps(I, row)
        I[at.FRESH] = 2


def _samples_before(t0: float, offset: float, period: float) -> int:
    """Return how many sampling instants lie before ``t0``."""
    return max(0, int(np.ceil((t0 - offset) / period - 1e-9)))
