"""From a list of blocks to the two arrays of ``engine.layout``."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from engine import layout as at
from engine.call import address
from engine.elimination import eliminate
from engine.flat import FlatBlock, Floats, Ints
from engine.program import Programs
from engine.structure import analyse


@dataclass(frozen=True)
class Component:
    """The arrays of one independent part of a diagram, at the start of a run.

    ``params[b]`` and ``states[b]`` are the offsets in ``W`` of block ``b``'s parameters and initial states;
    ``memory[b]`` those of its modes; ``columns`` the diagram signals in the order of the component's log.
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


def build(
    blocks: Sequence[FlatBlock], members: Sequence[int], columns: Sequence[int], capacity: int = 2048
) -> Component:
    """Lay out the given blocks (indices in signal-flow order) as one component that logs ``columns``."""
    rows = [blocks[b] for b in members]
    local: dict[int, int] = {}  # diagram signal -> component signal
    for block in sorted(rows, key=lambda block: block.kind == at.HOSTED):
        for j in range(len(block.y0)):
            local[block.first_signal + j] = len(local)
    n = sum(len(b.x0) for b in rows)
    ng = sum(b.n_events for b in rows)
    ns = len(local)
    nd = sum(len(b.d0) for b in rows)
    size = at.HF
    shape = analyse(rows)
    order = eliminate(n, shape.entries)

    def stretch(length: int) -> int:
        nonlocal size
        start = size
        size += length
        return start

    header = np.zeros(at.H, dtype=np.int64)
    header[at.N_BLOCKS], header[at.N_STATES] = len(rows), n
    header[at.N_SIGNALS], header[at.N_EVENTS] = ns, ng
    lengths = {
        at.O_X: n, at.O_F: n, at.O_Y0: n, at.O_Y1: 2 * n, at.O_K: 16 * n, at.O_CONT: 8 * n, at.O_TMP: n,
        at.O_JAC: len(shape.entries), at.O_LU: order.size, at.O_DFDT: n,
        at.O_S: ns, at.O_S0: ns, at.O_RATE: ns,
        at.O_G: 3 * ng, at.O_G0: ng, at.O_RESTART: 2 * at.RESTARTS, at.O_CX: at.CHUNK * n,
        at.O_CS: at.CHUNK * ns, at.O_D: nd, at.O_SCRATCH: max([len(b.d0) for b in rows] or [0]),
    }  # fmt: skip
    for slot, length in lengths.items():
        header[slot] = stretch(length)

    table = np.zeros((len(rows), at.R), dtype=np.int64)
    wires: list[int] = []
    wires_start = at.H + table.size
    params: dict[int, int] = {}
    states: dict[int, int] = {}
    memory: dict[int, int] = {}
    x_next, d_next, g_next = 0, int(header[at.O_D]), 0
    values: list[tuple[int, Floats]] = []
    for number, (b, block) in enumerate(zip(members, rows, strict=True)):
        row = table[number]
        row[at.KIND], row[at.GLOBAL] = block.kind, b
        row[at.A_OUT], row[at.A_DER] = address(block.out), address(block.der)
        row[at.A_ZC], row[at.A_JUMP] = address(block.zc), address(block.jump)
        row[at.A_STEP], row[at.A_NEXT] = address(block.step), address(block.next_time)
        row[at.NU], row[at.NY], row[at.NX] = len(block.wires), len(block.y0), len(block.x0)
        row[at.ND], row[at.NG] = len(block.d0), block.n_events
        row[at.RATES], row[at.FEEDS], row[at.LOGGED] = block.rates, block.feeds, block.logged
        row[at.STILL] = shape.still[number]
        direct = len(block.wires) == 1 and not block.rates
        row[at.U] = header[at.O_S] + local[block.wires[0]] if direct else stretch(2 * len(block.wires))
        row[at.GATHER] = 0 if direct else len(block.wires)
        row[at.P] = params[b] = stretch(len(block.p))
        row[at.D], row[at.X], row[at.G] = d_next, x_next, g_next
        row[at.Y] = local[block.first_signal] if len(block.y0) else 0
        row[at.WIRES] = wires_start + len(wires)
        row[at.NEXT_TIME] = stretch(2)
        zero = stretch(1)
        row[at.PERIOD] = params[b] + block.period_at if block.period_at >= 0 else zero
        row[at.OFFSET] = params[b] + block.offset_at if block.offset_at >= 0 else zero
        if block.kind == at.DEAD_TIME:
            row[at.SHARP] = _meets_dead_time(rows, block.first_signal)
            row[at.CAPACITY] = max(block.capacity, capacity)
            row[at.DELAY] = stretch(int(row[at.CAPACITY]) * at.D_SIZE)
        wires += [local[w] for w in block.wires]
        states[b], memory[b] = int(header[at.O_Y0]) + x_next, d_next
        values += [
            (params[b], block.p),
            (states[b], block.x0),
            (d_next, block.d0),
            (int(header[at.O_S]) + int(row[at.Y]), block.y0),
            (int(row[at.NEXT_TIME]), np.array([np.inf, np.inf])),
        ]
        x_next, d_next, g_next = x_next + len(block.x0), d_next + len(block.d0), g_next + block.n_events

    def keep(numbers: Iterable[int]) -> int:
        """Append integers behind the wires; return where they begin."""
        start = wires_start + len(wires)
        wires.extend(numbers)
        return start

    programs = Programs(rows, header, table, [[local[w] for w in block.wires] for block in rows])

    def program(kernel: int, numbers: Iterable[int]) -> tuple[int, int]:
        """Append a program; return where it begins and how many calls it holds."""
        calls = programs.calls(kernel, numbers)
        return keep(place for call in calls for place in call), len(calls)

    for number, (outs, ders) in enumerate(shape.follows):
        row = table[number]
        row[at.J_OUT : at.J_OUT + 2] = program(at.A_OUT, outs)
        row[at.J_DER : at.J_DER + 2] = program(at.A_DER, ders)
        changed = [int(table[o, at.Y]) + j for o in outs for j in range(int(table[o, at.NY]))]
        row[at.J_BACK : at.J_BACK + 2] = keep(changed), len(changed)
        states_there = [int(table[o, at.X]) + j for o in ders for j in range(int(table[o, at.NX]))]
        row[at.J_ROWS : at.J_ROWS + 2] = keep(states_there), len(states_there)
    everything = [i for i, block in enumerate(rows) if block.kind in (at.CONTINUOUS, at.DEAD_TIME)]
    with_states = [i for i, block in enumerate(rows) if len(block.x0)]
    with_events = [i for i, block in enumerate(rows) if block.n_events]
    for place, kernel, numbers in (
        (at.P_SIGNALS, at.A_OUT, everything),
        (at.P_MOVING, at.A_OUT, shape.for_rates),
        (at.P_EVENT_SIGNALS, at.A_OUT, shape.for_events),
        (at.P_RATES, at.A_DER, with_states),
        (at.P_EVENTS, at.A_ZC, with_events),
    ):
        header[place : place + 2] = program(kernel, numbers)
    header[at.TIMED] = shape.timed
    header[at.L_PLACE], header[at.N_JAC] = keep(order.places), len(order.places)
    header[at.L_DIAGONAL], header[at.N_FACTORS] = keep(order.diagonals), order.size
    header[at.L_FACTOR], header[at.L_FORWARD] = keep(order.factor), keep(order.forward)
    header[at.L_BACKWARD] = keep(order.backward)
    header[at.L_WIRES] = wires_start + len(wires)
    header[at.N_LOG] = len(columns)
    header[at.HAS_RATES] = any(b.rates and b.n_events for b in rows)
    header[at.HAS_DELAYS] = any(b.kind == at.DEAD_TIME for b in rows)
    header[at.N_SAMPLED] = sum(b.kind == at.SAMPLED for b in rows)
    header[at.N_CHECKED] = ns - sum(len(b.y0) for b in rows if b.kind == at.HOSTED)
    sampled = any(b.kind in (at.SAMPLED, at.HOSTED) for b in rows)
    header[at.EXPLICIT] = 0 if sampled else 2  # long steps do not pay between close sampling instants
    header[at.FRESH], header[at.EVENTS_SEEN] = 1, -1
    header[at.MAX_CHAIN] = 20 + 10 * ng
    W = np.zeros(size)
    for start, value in values:
        W[start : start + len(value)] = value
    W[at.T_LEFT] = W[at.MAX_STEP] = W[at.T_STOP] = np.inf
    W[at.SEEN] = -np.inf
    I = np.concatenate([header, table.ravel(), np.array(wires + [local[c] for c in columns], dtype=np.int64)]).astype(
        np.int64
    )
    return Component(
        I=I,
        W=W,
        blocks=tuple(members),
        params=params,
        states=states,
        memory=memory,
        signals={g: int(header[at.O_S]) + l for g, l in local.items()},
        columns=tuple(columns),
        hosted=tuple(b for b in members if blocks[b].kind == at.HOSTED),
    )


def _meets_dead_time(rows: Sequence[FlatBlock], signal: int) -> bool:
    """Return whether ``signal`` reaches a dead time through nothing but blocks that feed through."""
    waiting, seen = [signal], {signal}
    while waiting:
        now = waiting.pop()
        for block in rows:
            if now in block.wires:
                if block.kind == at.DEAD_TIME:
                    return True
                if block.kind == at.CONTINUOUS and block.feeds:
                    new = {block.first_signal + j for j in range(len(block.y0))} - seen
                    waiting += new
                    seen |= new
    return False
