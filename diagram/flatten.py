"""From a diagram to the engine's components: independent parts, each with its own arrays and step size.

Static functions of time (sources and what only they feed) are copied into every part that reads them, so a
common set point does not tie loops together.  Dead times become ring buffers in front of the block they delay.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from blocks.block import Block
from diagram.cells import MANY, cut, driver_of, smooth_outputs, watched
from engine import layout as at
from engine.cells import Link
from engine.flat import FlatBlock, Floats, Ints
from engine.table import Component, build

if TYPE_CHECKING:
    from diagram.diagram import Diagram

DELAY_RECORDS = 2048
Ends = tuple[tuple[Component, Ints, Floats], ...]  # the components of a diagram with their arrays at the end of a run


@dataclass(frozen=True)
class Plan:
    """A diagram laid out for the engine; parameters and start values are filled in per run by ``fill``.

    ``places[b]`` lists the components that hold block ``b``; ``delays[b]`` the flat delays in front of it.
    With ``links`` the components are cells, to be advanced together (``engine.cells``).
    """

    flat: tuple[FlatBlock, ...]
    components: tuple[Component, ...]
    places: Mapping[int, tuple[int, ...]]
    delays: Mapping[int, tuple[int, ...]]
    shape: tuple[bool, ...]
    records: int = field(default=DELAY_RECORDS)
    links: tuple[Link, ...] = ()

    def fill(self, component: Component, W: Floats, blocks: tuple[Block, ...]) -> None:
        """Write parameters, start states, modes, memories and held outputs of the blocks into the arrays of a run."""
        for b in component.blocks:
            if b < len(blocks):
                block = blocks[b]
                W[component.params[b] : component.params[b] + len(block.p)] = block.p
                x, d = component.states[b], component.memory[b]
                W[x : x + len(block.x0)] = block.x0
                W[d : d + len(block.d0)] = block.d0
                if len(block.y0):
                    y = component.signals[self.flat[b].first_signal]
                    W[y : y + len(block.y0)] = block.y0
        for b, flats in self.delays.items():
            for f in flats:
                if f in component.params:
                    W[component.params[f] : component.params[f] + 2] = _delay_params(blocks[b])


def plan(diagram: "Diagram", records: int = DELAY_RECORDS) -> Plan:
    """Return the plan of a diagram, made once and shared by all diagrams that differ only in values."""
    if diagram._plan is None or not _fits(diagram._plan, diagram, records):
        diagram._plan = _make(diagram, records, in_cells=False)
    return diagram._plan


def plan_in_cells(diagram: "Diagram", records: int = DELAY_RECORDS) -> Plan:
    """Return the plan of a diagram cut into cells where that pays (it has links then), or else its ``plan``."""
    if len(diagram.blocks) < MANY:
        return plan(diagram, records)
    if diagram._cells is None or not _fits(diagram._cells, diagram, records):
        diagram._cells = _make(diagram, records, in_cells=True)
        if not diagram._cells.links:
            diagram._plan = diagram._cells
    return diagram._cells


def _shape(diagram: "Diagram") -> tuple[bool, ...]:
    return tuple(block.dead_time > 0.0 for block in diagram.blocks)


def _fits(known: Plan, diagram: "Diagram", records: int) -> bool:
    return known.shape == _shape(diagram) and known.records >= records


def _make(diagram: "Diagram", records: int, in_cells: bool) -> Plan:
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
    for members in groups:
        columns: list[int] = []
        for f in members:
            places.setdefault(f, []).append(len(components))
            if f < len(blocks) and f not in taken:  # a copied source is logged once
                taken.add(f)
                columns += range(flat[f].first_signal, flat[f].first_signal + len(flat[f].y0))
        components.append(build(flat, members, columns))
    row = {f: (c, number) for c, component in enumerate(components) for number, f in enumerate(component.blocks)}
    return Plan(
        flat=tuple(flat),
        components=tuple(components),
        places={b: tuple(c) for b, c in places.items()},
        delays=delays,
        shape=shape,
        records=records,
        links=tuple(Link(*row[out], *row[into]) for out, into in pairs),
    )


def _groups(flat: list[FlatBlock], order: list[int], apart_at: Collection[int] = ()) -> list[list[int]]:
    """Split the blocks (in flow order) into independent groups, copying static functions of time into each.

    The outputs of the blocks ``apart_at`` tie nothing together.
    """
    driver = driver_of(flat)
    static: set[int] = set()
    for f in order:
        block = flat[f]
        alone = block.kind == at.CONTINUOUS and not len(block.x0) and not len(block.d0) and not block.n_events
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
    members: dict[int, list[int]] = {}
    for f in order:
        if f not in static:
            members.setdefault(root(f), []).append(f)
    place = {f: i for i, f in enumerate(order)}
    apart = list(members.values())
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
    name = block.dead_time_param or ""
    before = f"{name}_start"
    value = block.p[block.param_index(before)] if before in block.param_names else 0.0
    return np.array([block.p[block.param_index(name)], value])


def _delay(name: str, block: Block, wire: int, first: int, records: int) -> FlatBlock:
    return FlatBlock(
        name=name,
        kind=at.DEAD_TIME,
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
    kind = at.CONTINUOUS
    if block.sampled:
        kind = at.HOSTED if block.host is not None else at.SAMPLED
    continuous = kind == at.CONTINUOUS
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
        step=k.step if kind == at.SAMPLED else None,
        next_time=k.next_time if continuous else None,
        n_events=k.n_events if continuous else 0,
        rates=k.rates,
        feeds=k.feeds,
        logged=bool(block.modes),
        period_at=block.param_index(block.period_param) if block.period_param else -1,
        offset_at=block.param_index(block.offset_param) if block.offset_param else -1,
        host=block.host,
    )
