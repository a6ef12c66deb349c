"""From a diagram to the engine's components: independent parts, each with its own arrays and step size.

Static functions of time (sources and what only they feed) are copied into every part that reads them, so a
common set point does not tie loops together.  Dead times become ring buffers in front of the block they delay.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from stickslip.blocks.block import Block
from stickslip.diagram.cells import cut, driver_of, smooth_outputs, watched
from stickslip.diagram.wired import Wired
from stickslip.engine.call import reached_by
from stickslip.engine.cells import Link
from stickslip.engine.flat import CONTINUOUS, DEAD_TIME, HOSTED, SAMPLED, FlatBlock, Floats
from stickslip.engine.snapshot import Snapshot
from stickslip.engine.table import Component, build
from stickslip.engine.watched import Watched

DELAY_RECORDS = 2048
Ends = tuple[Snapshot, ...]  # the components of a diagram at the end of a run


@dataclass(frozen=True)
class Plan:
    """A diagram laid out for the engine; parameters and start values are filled in per run by ``fill``.

    ``places[b]`` lists the components that hold block ``b``; ``delays[b]`` the flat delays in front of it.
    With ``links`` the components are cells, to be advanced together (``stickslip.engine.cells``).
    """

    flat: tuple[FlatBlock, ...]
    components: tuple[Component, ...]
    places: Mapping[int, tuple[int, ...]]
    delays: Mapping[int, tuple[int, ...]]
    shape: tuple[bool, ...]
    records: int = field(default=DELAY_RECORDS)
    links: tuple[Link, ...] = ()
    reached: Watched = field(default_factory=Watched)  # by all kernels, when they were compiled

    def fill(self, run: Snapshot, blocks: tuple[Block, ...]) -> None:
        """Write parameters, start states, modes, memories and held outputs of the blocks into the arrays of a run.

        Of timetables only the addresses are written: the blocks have to outlive the run.
        """
        for b in run.component.blocks:
            if b < len(blocks):
                block = blocks[b]
                run.params(b, len(block.p))[:] = block.p
                run.states(b, len(block.x0))[:] = block.x0
                run.memory(b, len(block.d0))[:] = block.d0
                if block.timetable is not None:
                    run.point_to(b, block.timetable)
                if len(block.y0):
                    run.outputs(self.flat[b].first_signal, len(block.y0))[:] = block.y0
        for b, flats in self.delays.items():
            for f in flats:
                if f in run.component.params:
                    run.params(f, 2)[:] = _delay_params(blocks[b])


def plan(diagram: Wired, records: int = DELAY_RECORDS, known: Plan | None = None) -> Plan:
    """Return the plan of a diagram: ``known`` if that still serves, else a new one.

    ``Diagram.plan`` keeps it, so that diagrams that differ only in values share one.
    """
    return known if known is not None and _fits(known, diagram, records) else _make(diagram, records, in_cells=False)


def plan_in_cells(diagram: Wired, records: int = DELAY_RECORDS, known: Plan | None = None) -> Plan:
    """Return the plan of a diagram cut into cells where that pays; it has links then.

    ``Diagram.plan_in_cells`` keeps it.
    """
    return known if known is not None and _fits(known, diagram, records) else _make(diagram, records, in_cells=True)


def _shape(diagram: Wired) -> tuple[bool, ...]:
    return tuple(block.dead_time > 0.0 for block in diagram.blocks)


def _fits(known: Plan, diagram: Wired, records: int) -> bool:
    return known.shape == _shape(diagram) and known.records >= records and not known.reached.changed()


def _make(diagram: Wired, records: int, in_cells: bool) -> Plan:
    blocks, shape = diagram.blocks, _shape(diagram)
    index = {signal: i for i, signal in enumerate(diagram.signals)}
    flat: list[FlatBlock] = []
    first = 0
    for block in blocks:
        flat.append(_flat(block, tuple(index[s] for s in block.input_labels), first))
        first += len(block.output_labels)
    order: list[int] = []
    delays: dict[int, tuple[int, ...]] = {}
    for b in diagram.order:
        if shape[b]:
            made = []
            wires = flat[b].wires
            for wire in wires:
                flat.append(_delay(f"{blocks[b].name}:delay", blocks[b], wire, first, records))
                made.append(len(flat) - 1)
                first += 1
            flat[b] = _flat(blocks[b], tuple(flat[f].first_signal for f in made), flat[b].first_signal)
            delays[b] = tuple(made)
            order += made
        order.append(b)
    groups = _groups(flat, order)
    pairs: tuple[tuple[int, int], ...] = ()
    if in_cells:
        apart_at = smooth_outputs(flat)
        apart = _groups(flat, order, apart_at)
        while tied := apart_at & watched(flat, apart):
            apart_at -= tied
            apart = _groups(flat, order, apart_at)
        made_cells = cut(flat, apart, first)
        if made_cells is not None:
            flat, groups, pairs = [*made_cells.flat], [[*cell] for cell in made_cells.cells], made_cells.links
    components: list[Component] = []
    places: dict[int, list[int]] = {}
    taken: set[int] = set()
    for group in groups:
        columns: list[int] = []
        for f in group:
            places.setdefault(f, []).append(len(components))
            if f < len(blocks) and f not in taken:  # a copied source is logged once
                taken.add(f)
                columns += range(flat[f].first_signal, flat[f].first_signal + len(flat[f].y0))
        components.append(build(flat, group, columns))
    row = {f: (c, number) for c, component in enumerate(components) for number, f in enumerate(component.blocks)}
    return Plan(
        flat=tuple(flat),
        components=tuple(components),
        places={b: tuple(c) for b, c in places.items()},
        delays=delays,
        shape=shape,
        records=records,
        links=tuple(Link(*row[out], *row[into]) for out, into in pairs),
        reached=reached_by({kernel for block in flat for kernel in block.kernels}),
    )


def _groups(flat: list[FlatBlock], order: list[int], apart_at: Collection[int] = ()) -> list[list[int]]:
    """Split the blocks (in flow order) into independent groups, copying static functions of time into each.

    The outputs of the blocks ``apart_at`` tie nothing together.
    """
    driver = driver_of(flat)
    static: set[int] = set()
    for f in order:
        block = flat[f]
        alone = block.kind == CONTINUOUS and not len(block.x0) and not len(block.d0) and not block.n_events
        if alone and all(driver[w] in static for w in block.wires):
            static.add(f)
    parent = {f: f for f in order}

    def root(f: int) -> int:
        while parent[f] != f:
            parent[f] = parent[parent[f]]
            f = parent[f]
        return f

    for f in order:
        if f not in static:
            for w in flat[f].wires:
                if driver[w] not in static and driver[w] not in apart_at:
                    parent[root(driver[w])] = root(f)
    joined: dict[int, list[int]] = {}
    for f in order:
        if f not in static:
            joined.setdefault(root(f), []).append(f)
    place = {f: i for i, f in enumerate(order)}
    apart = list(joined.values())
    used = {f for group in apart for f in _upstream(flat, group, driver, static)}
    left = [f for f in order if f in static and f not in used]  # what no other group reads
    apart += [left] if left else []
    return [sorted({*group, *_upstream(flat, group, driver, static)}, key=place.__getitem__) for group in apart]


def _upstream(flat: list[FlatBlock], group: Iterable[int], driver: Mapping[int, int], static: set[int]) -> set[int]:
    found: set[int] = set()
    waiting = list(group)
    while waiting:
        for w in flat[waiting.pop()].wires:
            f = driver[w]
            if f in static and f not in found:
                found.add(f)
                waiting.append(f)
    return found


def _delay_params(block: Block) -> Floats:
    """Return (dead time [s], value before the start) of a block."""
    return np.array([block.dead_time, block.value_before])


def _delay(name: str, block: Block, wire: int, first: int, records: int) -> FlatBlock:
    return FlatBlock(
        name=name,
        kind=DEAD_TIME,
        p=_delay_params(block),
        x0=np.zeros(0),
        d0=np.zeros(0),
        y0=np.zeros(1),
        wires=(wire,),
        first_signal=first,
        feeds=False,
        capacity=records,
    )


def _flat(block: Block, wires: tuple[int, ...], first: int) -> FlatBlock:
    k = block.kernels
    kind = CONTINUOUS
    if block.sampled:
        kind = HOSTED if block.host is not None else SAMPLED
    continuous = kind == CONTINUOUS
    return FlatBlock(
        name=block.name,
        kind=kind,
        p=block.p,
        x0=block.x0,
        d0=block.d0,
        y0=block.y0,
        wires=wires,
        first_signal=first,
        out=k.out if continuous else None,
        der=k.der if continuous and len(block.x0) else None,
        zc=k.zc if continuous else None,
        jump=k.jump if continuous else None,
        step=k.step if kind == SAMPLED or block.timetable is not None else None,
        next_time=k.next_time if continuous else None,
        n_events=k.n_events if continuous else 0,
        rates=k.rates,
        rate_modes=k.rate_modes,
        jumps=continuous and k.jumps,
        shows_modes=continuous and k.shows_modes,
        feeds=k.feeds,
        timed=k.timed,
        linear=k.linear,
        logged=bool(block.modes),
        period_at=block.param_index(block.period_param) if block.period_param else -1,
        offset_at=block.param_index(block.offset_param) if block.offset_param else -1,
        listed=0 if block.timetable is None else block.timetable.shape[1],
        host=block.host,
    )
