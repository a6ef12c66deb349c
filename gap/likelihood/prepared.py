"""A model made ready for a filter: noise as inputs that are held, dead times as scan values, one component."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.block import Block
from stickslip.blocks.sources import Constant
from stickslip.blocks.variable_delay import VariableDelay
from stickslip.diagram import wire
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.inputs import close
from stickslip.engine.restarts import never_paused
from stickslip.engine.run import Settings, prepare
from stickslip.engine.snapshot import Snapshot
from stickslip.engine.table import Component
from stickslip.gap.insertion.scales import time_scale
from stickslip.gap.likelihood.late import Late, LateByASignal
from stickslip.gap.records.model import Nuisance, nuisances, smooth_memories, smoothed
from stickslip.gap.records.record import Record
from stickslip.logs.arrays import Values

Whole = NDArray[np.int64]
TIED = "filter:tied"
TAPS = 25  # values of a dead time, at most: each is a state of the filter
VARYING = 25  # values of one that varies: the largest that it may be is often twice the usual one
FINE = 0.01  # of the time scale of a loop: so far apart these values may be, or a scan


class NoFilter(ValueError):
    """A diagram that the filter cannot follow."""


@dataclass(frozen=True, eq=False)
class Prepared:
    """``diagram`` closed and tied, its ``component``; ``noise`` the sources of random numbers by the block that holds
    them; ``late`` dead-time parameters by their new names.
    """

    diagram: Diagram
    component: Component
    noise: tuple[tuple[Nuisance, str], ...]
    late: Mapping[str, str]

    @cached_property
    def states(self) -> tuple[tuple[str, int, int], ...]:
        """Names of the state, where each is set, and where it is read."""
        found: list[tuple[str, int, int]] = []
        c, d = self.component, self.diagram
        plan = d.plan()
        for b in c.blocks:
            if b >= len(d.blocks):
                raise NoFilter("a dead time is left")
            block = d.blocks[b]
            outputs = [c.signals[plan.flat[b].first_signal + j] for j in range(len(block.output_labels))]
            shown = {s: outputs[[p.name for p in block.ports_out].index(port)] for s, port in block.shown_by.items()}
            own = [(s, c.states[b] + i) for i, s in enumerate(block.state_names)]
            smooth = smooth_memories(block)
            own += [(s, c.memory[b] + i) for i, s in enumerate(block.memory_names) if s in smooth]
            found += [(f"{block.name}.{s}", at, shown.get(s, at)) for s, at in own]
            if block.sampled:
                found += [(f"{block.name}={s}", at, at) for s, at in zip(block.output_labels, outputs, strict=True)]
        for _, holder in self.noise:
            b = d.block_index(holder)
            value = c.params[b] + d.blocks[b].param_index("value")
            found.append((f"{holder}.value", value, value))
        return tuple(found)

    @cached_property
    def modes(self) -> Whole:
        """Where modes and counts of blocks are kept."""
        c = self.component
        found = [
            c.memory[b] + i
            for b in c.blocks
            for i, s in enumerate(self.diagram.blocks[b].memory_names)
            if s in self.diagram.blocks[b].discrete
        ]
        return np.array(found, dtype=np.int64)

    def fresh(self, t0: float, blocks: tuple[Block, ...], most_steps: int) -> tuple[Whole, Values]:
        """Return the arrays of a run that has not begun; ``blocks`` those of the diagram, with other parameters."""
        I, W = prepare(self.component, Settings(max_steps=most_steps), t0)
        self.diagram.plan().fill(Snapshot(self.component, I, W), blocks)
        never_paused(I)
        return I, W


def prepared(
    model: Diagram, record: Record, scan: float, longest: Mapping[str, float] = MappingProxyType({}),
    doubted: Iterable[str] = (),
) -> Prepared:  # fmt: skip
    """Return a model, with its nuisances, ready for a filter of a record.

    ``scan`` [s] of its controllers; ``longest`` block.parameter -> the largest that a dead time [s] may become;
    ``doubted`` inputs that are not exactly as they are logged.
    """
    quiet = smoothed(model)
    noise: list[tuple[Nuisance, str]] = []
    drawing = [(one, str(model[one.block].output_labels[0])) for one in nuisances(model)]
    for one, signal in (*drawing, *((Nuisance(s, 0.0, 0.0), s) for s in doubted)):
        holder = f"{one.block}:drawn"
        quiet = quiet.insert(
            signal, Sum(signal, {signal: 1.0, holder: 1.0}, name=f"{one.block}:noisy"), inputs=[holder]
        )
        quiet = close(quiet, {holder: Constant(holder, 0.0, name=holder)})
        noise.append((one, holder))
    late: dict[str, str] = {}
    for block in list(quiet.blocks):
        if isinstance(block, VariableDelay):
            quiet = quiet.replace(block.name, LateByASignal.of(block, scan, VARYING))
        key = f"{block.name}.{block.dead_time_param}"
        theta = block.dead_time if block.dead_time_param else 0.0
        followed = max(TAPS * max(scan, FINE * time_scale(model, block.name)), 2.0 * theta) if key in longest else theta
        most = max(theta, min(longest.get(key, 0.0), followed))
        if most > 0.0:
            dt = scan * max(1, math.ceil(most / scan / TAPS))
            quiet = quiet.with_params({key: 0.0})
            for j, s in enumerate(block.input_labels):
                name = f"{block.name}:late{j}"
                new = Late(theta, dt=dt, longest=most, held=dt - scan, start=block.value_before, name=name)
                quiet = quiet.insert(str(s), new, readers=block.name)
                late[key] = f"{new.name}.theta"
    given = {s: record.source(s) for s in record.played}
    quiet = close(quiet, given) if given else quiet
    tie = Sum(TIED, dict.fromkeys(record.pinned, 0.0), name=TIED)  # adds nothing, so that units do not matter
    tied = wire([*quiet.blocks, tie], outputs=[TIED])
    component = next(c for c in tied.plan().components if tied.block_index(TIED) in c.blocks)
    if component.hosted:
        raise NoFilter("a block runs in Python")
    inside = {tied.blocks[b].name for b in component.blocks if b < len(tied.blocks)}
    return Prepared(tied, component, tuple(n for n in noise if n[1] in inside), late)
