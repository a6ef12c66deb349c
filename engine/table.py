"""From a list of blocks to the two arrays of ``engine.layout``."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engine import layout as at
from engine.call import Kernel, address

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class FlatBlock:
    """One block as the engine sees it: kernels, sizes, start values, and which signals it reads.

    ``wires`` and ``first_signal`` are indices into the signals of the whole diagram.  ``host`` runs a hosted
    block in Python: ``init(p) -> state`` and ``step(t, state, u, p) -> (state, y)``.
    """

    name: str
    kind: int
    p: Floats
    x0: Floats
    d0: Floats
    y0: Floats
    wires: tuple[int, ...]
    first_signal: int
    out: Kernel | None = None
    der: Kernel | None = None
    zc: Kernel | None = None
    jump: Kernel | None = None
    step: Kernel | None = None
    next_time: Kernel | None = None
    n_events: int = 0
    rates: bool = False
    feeds: bool = True
    logged: bool = False
    period_at: int = -1  # where the sampling period stands in p
    offset_at: int = -1  # where the first sampling instant stands in p
    capacity: int = 0  # of the delay ring
    host: Any = None


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


def _reach(rows: Sequence[FlatBlock]) -> list[tuple[list[int], list[int]]]:
    """Return for each block whose outputs and whose rates its states reach without passing another state."""
    driver = {block.first_signal + j: i for i, block in enumerate(rows) for j in range(len(block.y0))}
    found: list[tuple[list[int], list[int]]] = []
    for number, block in enumerate(rows):
        if not len(block.x0):
            found.append(([], []))
            continue
        outs = [number]
        for i, other in enumerate(rows):  # in flow order, so one pass is enough
            follows = i != number and other.kind == at.CONTINUOUS and other.feeds
            if follows and any(driver[w] in outs for w in other.wires):
                outs.append(i)
        ders = [i for i, b in enumerate(rows) if len(b.x0) and (i == number or any(driver[w] in outs for w in b.wires))]
        found.append((outs, ders))
    return found


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

    def stretch(length: int) -> int:
        nonlocal size
        start = size
        size += length
        return start

    header = np.zeros(at.H, dtype=np.int64)
    header[at.N_BLOCKS], header[at.N_STATES] = len(rows), n
    header[at.N_SIGNALS], header[at.N_EVENTS], header[at.N_D] = ns, ng, nd
    lengths = {
        at.O_X: n, at.O_F: n, at.O_Y0: n, at.O_Y1: 2 * n, at.O_K: 16 * n, at.O_CONT: 8 * n, at.O_TMP: n,
        at.O_JAC: n * n, at.O_LU: n * n, at.O_PIVOT: n * (2 * n + 4) + 2, at.O_DFDT: n,
        at.O_S: ns, at.O_S0: ns, at.O_RATE: ns,
        at.O_G: 3 * ng, at.O_G0: ng, at.O_RESTART: at.RESTARTS, at.O_CX: at.CHUNK * n,
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
    for number, (outs, ders) in enumerate(_reach(rows)):
        for lists, start, length in ((outs, at.J_OUT, at.N_J_OUT), (ders, at.J_DER, at.N_J_DER)):
            table[number, start], table[number, length] = wires_start + len(wires), len(lists)
            wires += [at.H + other * at.R for other in lists]
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
