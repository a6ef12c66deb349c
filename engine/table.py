"""From a list of blocks to the two arrays of ``stickslip.engine.layout``."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import chain

import numpy as np
from stickslip.engine import layout as at
from stickslip.engine.call import KernelError, address
from stickslip.engine.delay import SMOOTH
from stickslip.engine.elimination import eliminate
from stickslip.engine.flat import FlatBlock, Floats, Ints
from stickslip.engine.program import Programs
from stickslip.engine.series import again_size, model_size
from stickslip.engine.structure import analyse
from stickslip.engine.turns import starting_order, turns


@dataclass(frozen=True)
class Component:
    """The arrays of one independent part of a diagram, at the start of a run.

    ``params[b]`` and ``states[b]`` are the offsets in ``W`` of block ``b``'s parameters and initial states;
    ``memory[b]`` those of its modes; ``columns`` the diagram signals in the order of the component's log;
    ``unforeseen`` the blocks that follow the time and announce no steps, with how many parameters they have.
    """

    I: Ints
    W: Floats
    blocks: tuple[int, ...]
    params: dict[int, int]
    states: dict[int, int]
    memory: dict[int, int]
    signals: dict[int, int]
    columns: tuple[int, ...]
    hosted: tuple[int, ...] = field(default=())
    unforeseen: dict[int, int] = field(default_factory=dict)


def build(
    blocks: Sequence[FlatBlock], chosen: Sequence[int], columns: Sequence[int], capacity: int = 2048
) -> Component:
    """Lay out the given blocks (indices in signal-flow order) as one component that logs ``columns``."""
    table = _Table([blocks[b] for b in chosen])
    for number, b in enumerate(chosen):
        table.place(number, b, capacity)
    table.write_programs()
    table.write_facts()
    table.write_rings()
    return Component(
        I=table.integers([table.local[c] for c in columns]),
        W=table.floats(),
        blocks=tuple(chosen),
        params={b: int(table.rows[i, at.P]) for i, b in enumerate(chosen)},
        states={b: int(table.header[at.O_Y0] + table.rows[i, at.X]) for i, b in enumerate(chosen)},
        memory={b: int(table.rows[i, at.D]) for i, b in enumerate(chosen)},
        signals={signal: int(table.header[at.O_S]) + place for signal, place in table.local.items()},
        columns=tuple(columns),
        hosted=tuple(b for b in chosen if blocks[b].kind == at.HOSTED),
        unforeseen={b: len(blocks[b].p) for b in chosen if blocks[b].unforeseen},
    )


class _Table:
    """The two arrays in the making: integer header, one row of integers per block, and what comes behind them."""

    def __init__(self, blocks: Sequence[FlatBlock]) -> None:
        self.blocks = blocks
        self.local: dict[int, int] = {}  # diagram signal -> component signal, those of hosted blocks last
        for block in sorted(blocks, key=lambda block: block.kind == at.HOSTED):
            for j in range(len(block.y0)):
                self.local[block.first_signal + j] = len(self.local)
        self.shape = analyse(blocks)
        states = sum(len(b.x0) for b in blocks)
        self.linear = self.shape.linear and states <= at.MOST_STATES
        self.order = eliminate(states, self.shape.entries)
        self.header = np.zeros(at.H, dtype=np.int64)
        self.rows = np.zeros((len(blocks), at.R), dtype=np.int64)
        self.behind: list[int] = []  # integers behind header and rows
        self.size = at.HF  # floats so far
        self.values: list[tuple[int, Floats]] = []  # what they start with
        self._write_stretches()
        self._next_x, self._next_d, self._next_g = 0, int(self.header[at.O_D]), 0

    def _write_stretches(self) -> None:
        """Write how much there is of everything, and where its floats stand."""
        n = sum(len(b.x0) for b in self.blocks)
        ng = sum(b.n_events for b in self.blocks)
        ns, nd = len(self.local), sum(len(b.d0) for b in self.blocks)
        self.header[at.N_BLOCKS], self.header[at.N_STATES] = len(self.blocks), n
        self.header[at.N_SIGNALS], self.header[at.N_EVENTS] = ns, ng
        lengths = {
            at.O_X: n, at.O_F: n, at.O_Y0: n, at.O_Y1: 2 * n, at.O_K: 16 * n, at.O_CONT: at.SERIES * n, at.O_TMP: n,
            at.O_MODEL: at.RESTARTS * model_size(n) if self.linear else 0,
            at.O_AGAIN: again_size(n) if self.linear else 0,
            at.O_AFFINE: 1 + ns * (n + 1) if self.linear else 0,
            at.O_JAC: len(self.shape.entries), at.O_LU: self.order.size, at.O_DFDT: n,
            at.O_S: ns, at.O_RATE: ns,
            at.O_G: 3 * ng, at.O_G0: ng, at.O_RESTART: 2 * at.RESTARTS, at.O_CX: at.CHUNK * (n + 1) + at.SERIES,
            at.O_CS: at.CHUNK * ns, at.O_D: nd, at.O_SCRATCH: max([len(b.d0) for b in self.blocks] or [0]),
        }  # fmt: skip
        for slot, length in lengths.items():
            self.header[slot] = self.stretch(length)

    def stretch(self, length: int) -> int:
        """Reserve floats; return where they begin."""
        start = self.size
        self.size += length
        return start

    def keep(self, numbers: Iterable[int]) -> int:
        """Append integers; return where they begin."""
        start = at.H + self.rows.size + len(self.behind)
        self.behind.extend(numbers)
        return start

    def wires(self, block: FlatBlock) -> list[int]:
        """Return the component signals that a block reads."""
        return [self.local[w] for w in block.wires]

    def place(self, number: int, index: int, capacity: int) -> None:
        """Write the row of one block, ``index`` in the diagram, and reserve its parameters and memories."""
        block, row, header = self.blocks[number], self.rows[number], self.header
        row[at.KIND], row[at.GLOBAL] = block.kind, index
        try:
            row[at.A_OUT], row[at.A_DER] = address(block.out), address(block.der)
            row[at.A_ZC], row[at.A_JUMP] = address(block.zc), address(block.jump)
            row[at.A_STEP], row[at.A_NEXT] = address(block.step), address(block.next_time)
        except KernelError as error:
            raise KernelError(f"block '{block.name}': {error}") from error
        row[at.NU], row[at.NY], row[at.NX] = len(block.wires), len(block.y0), len(block.x0)
        row[at.ND], row[at.NG] = len(block.d0), block.n_events
        row[at.RATES], row[at.FEEDS], row[at.LOGGED] = block.rates, block.feeds is True, block.logged
        row[at.STILL] = self.shape.still[number]
        row[at.RATE_MODES] = self.keep([len(block.rate_modes), *map(int, block.rate_modes)])
        wires = self.wires(block)
        direct = len(wires) == 1 and not block.rates
        row[at.U] = header[at.O_S] + wires[0] if direct else self.stretch(2 * len(wires))
        row[at.GATHER] = 0 if direct else len(wires)
        row[at.P] = self.stretch(len(block.p))
        row[at.D], row[at.X], row[at.G] = self._next_d, self._next_x, self._next_g
        row[at.Y] = self.local[block.first_signal] if len(block.y0) else 0
        row[at.WIRES] = self.keep(wires)
        reached = [(at.H + delay * at.R, passes) for delay, passes in self.shape.reach[number]]
        row[at.REACH] = self.keep([len(reached), *chain.from_iterable(reached)]) if reached else 0
        row[at.NEXT_TIME] = self.stretch(2)
        zero = self.stretch(1)
        row[at.PERIOD] = row[at.P] + block.period_at if block.period_at >= 0 else zero
        row[at.OFFSET] = row[at.P] + block.offset_at if block.offset_at >= 0 else zero
        row[at.TAKES] = block.step is not None
        row[at.SHOWN] = self.stretch(len(wires)) if block.rates and block.n_events else 0
        row[at.TABLE_WIDTH], row[at.TABLE_VALUES] = block.listed, row[at.P] + len(block.p) - max(0, block.listed - 1)
        if block.kind == at.DEAD_TIME:
            needed = {*self.shape.for_rates, *self.shape.for_events, *self.shape.entering}
            row[at.NEEDED] = number in needed
            row[at.RESTS] = self.shape.rests[number]
            row[at.CAPACITY] = max(block.capacity, capacity)
            row[at.DELAY] = self.stretch(int(row[at.CAPACITY]) * at.D_SIZE)
        if block.kind == at.LINK_IN:
            row[at.NEEDED] = row[at.RESTS] = 1
            row[at.ENTERS] = SMOOTH
        self.values += [
            (int(row[at.P]), block.p),
            (int(header[at.O_Y0] + row[at.X]), block.x0),
            (int(row[at.D]), block.d0),
            (int(header[at.O_S] + row[at.Y]), block.y0),
            (int(row[at.NEXT_TIME]), np.array([np.inf, np.inf])),
        ]
        self._next_x += len(block.x0)
        self._next_d += len(block.d0)
        self._next_g += block.n_events

    def write_programs(self) -> None:
        """Write what is evaluated in which order: for a sweep, for rates, for events, for a column of the Jacobian."""
        blocks, rows = self.blocks, self.rows
        programs = Programs(blocks, self.header, rows, [self.wires(block) for block in blocks])

        def program(kernel: int, numbers: Iterable[int]) -> tuple[int, int]:
            """Append a program; return where it begins and how many calls it holds."""
            calls = programs.calls(kernel, numbers)
            return self.keep(place for call in calls for place in call), len(calls)

        for row, (outs, ders) in zip(rows, self.shape.follows, strict=True):
            row[at.J_OUT : at.J_OUT + 2] = program(at.A_OUT, outs)
            row[at.J_DER : at.J_DER + 2] = program(at.A_DER, ders)
            changed = [int(rows[o, at.Y]) + j for o in outs for j in range(int(rows[o, at.NY]))]
            row[at.J_BACK : at.J_BACK + 2] = self.keep(changed), len(changed)
            states_there = [int(rows[o, at.X]) + j for o in ders for j in range(int(rows[o, at.NX]))]
            row[at.J_ROWS : at.J_ROWS + 2] = self.keep(states_there), len(states_there)
        for place, kernel, numbers in (
            (at.P_SIGNALS, at.A_OUT, [i for i, b in enumerate(blocks) if b.kind in (at.CONTINUOUS, *at.REPLAYING)]),
            (at.P_MOVING, at.A_OUT, self.shape.for_rates),
            (at.P_EVENT_SIGNALS, at.A_OUT, self.shape.for_events),
            (at.P_ENTERING, at.A_OUT, self.shape.entering),
            (at.P_RATES, at.A_DER, [i for i, b in enumerate(blocks) if len(b.x0)]),
            (at.P_EVENTS, at.A_ZC, [i for i, b in enumerate(blocks) if b.n_events]),
        ):
            self.header[place : place + 2] = program(kernel, numbers)
        self.write_sweep(programs)
        self.header[at.L_PLACE], self.header[at.N_JAC] = self.keep(self.order.places), len(self.order.places)
        self.header[at.L_DIAGONAL], self.header[at.N_FACTORS] = self.keep(self.order.diagonals), self.order.size
        self.header[at.L_FACTOR], self.header[at.L_FORWARD] = (
            self.keep(self.order.factor),
            self.keep(self.order.forward),
        )
        self.header[at.L_BACKWARD] = self.keep(self.order.backward)

    def write_sweep(self, programs: Programs) -> None:
        """Write for each block how far a sweep over all signals has to be for what it reads."""
        place, calls = int(self.header[at.P_SIGNALS]), 0
        behind = {}  # signal -> where the sweep stands behind the block that drives it
        for number, (block, row) in enumerate(zip(self.blocks, self.rows, strict=True)):
            row[at.SWEPT], row[at.SWEPT_CALLS] = place, calls
            if block.kind in (at.CONTINUOUS, *at.REPLAYING):
                place += sum(len(call) for call in programs.calls(at.A_OUT, [number]))
                calls += 1
            behind.update(dict.fromkeys(range(block.first_signal, block.first_signal + len(block.y0)), (place, calls)))
        for block, row in zip(self.blocks, self.rows, strict=True):
            if block.feeds is not True and block.wires:  # what it reads may come behind it in the flow
                row[at.SWEPT], row[at.SWEPT_CALLS] = max(behind[w] for w in block.wires)

    def write_facts(self) -> None:
        """Write what kind of component it is, and that its run has not begun."""
        header, blocks = self.header, self.blocks
        header[at.TIMED] = self.shape.timed
        instants = [i for i, b in enumerate(blocks) if b.step is not None or b.listed or b.next_time is not None]
        for place, numbers in (
            (at.L_INSTANTS, instants),
            (at.L_WATCHING, [i for i, b in enumerate(blocks) if b.rates and b.n_events]),
            (at.L_STARTING, starting_order(blocks)),
            (at.L_TURNS, turns(blocks)),
        ):
            header[place : place + 2] = self.keep(at.H + i * at.R for i in numbers), len(numbers)
        header[at.HAS_RATES] = header[at.N_WATCHING] > 0
        leaving, delays, entering = (
            [at.H + i * at.R for i, b in enumerate(blocks) if b.kind == kind]
            for kind in (at.LINK_OUT, at.DEAD_TIME, at.LINK_IN)
        )
        header[at.L_DELAYS] = self.keep([*leaving, *delays, *entering])
        header[at.N_DELAYS] = len(leaving) + len(delays)
        header[at.L_REPLAYED], header[at.N_REPLAYED] = header[at.L_DELAYS] + len(leaving), len(delays) + len(entering)
        header[at.HAS_DELAYS], header[at.LINKED] = bool(leaving or delays or entering), bool(entering)
        header[at.N_SAMPLED] = sum(b.kind == at.SAMPLED or b.listed > 0 for b in blocks)
        header[at.N_CHECKED] = len(self.local) - sum(len(b.y0) for b in blocks if b.kind == at.HOSTED)
        sampled = any(b.step is not None or b.kind == at.HOSTED for b in blocks)
        # long steps do not pay between close sampling instants, nor between the breakpoints of several dead times
        many = sum(b.kind == at.DEAD_TIME and row[at.NEEDED] for b, row in zip(blocks, self.rows, strict=True)) > 2
        header[at.OTHERWISE] = 0 if sampled or many else 2
        header[at.EXPLICIT] = 3 if self.linear else header[at.OTHERWISE]
        header[at.AFFINE] = self.linear and self.shape.affine
        header[at.FRESH], header[at.EVENTS_SEEN] = 1, -1
        header[at.MAX_CHAIN] = 20 + 10 * header[at.N_EVENTS]

    def write_rings(self) -> None:
        """Reserve the rings of the links behind all that a run can be set back with."""
        self.header[at.SAVED] = self.size
        for block, row in zip(self.blocks, self.rows, strict=True):
            if block.kind in (at.LINK_OUT, at.LINK_IN):
                row[at.CAPACITY], row[at.DELAY] = block.capacity, self.stretch(block.capacity * at.D_SIZE)

    def integers(self, logged: Sequence[int]) -> Ints:
        """Return ``I``, with the signals to log at its end."""
        self.header[at.L_WIRES], self.header[at.N_LOG] = self.keep(logged), len(logged)
        return np.concatenate([self.header, self.rows.ravel(), np.array(self.behind, dtype=np.int64)])

    def floats(self) -> Floats:
        """Return ``W`` at the start of a run."""
        W = np.zeros(self.size)
        for start, value in self.values:
            W[start : start + len(value)] = value
        W[at.T_LEFT] = W[at.MAX_STEP] = W[at.T_STOP] = W[at.LONGEST] = np.inf
        W[at.SEEN] = -np.inf
        return W
