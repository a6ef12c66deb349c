"""The Kalman filter of a diagram that is linear and scanned: exact, and quicker than one across its runs.

Whether it is linear is asked of each block over the range that the log visits, not at one point.  What a source does
in time, a planned load, is an input: its mean over each scan.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from stickslip.blocks.block import Block
from stickslip.blocks.integrator import Integrator
from stickslip.blocks.recorded import Recorded
from stickslip.blocks.role import Role
from stickslip.diagram import simulate, wire
from stickslip.diagram.diagram import Diagram
from stickslip.gap.exact.affine import NotAffine, straight_between
from stickslip.gap.exact.kalman import filtered
from stickslip.gap.exact.operating import ONLOOKERS, inside, operating
from stickslip.gap.exact.rows import Rows, by_rows
from stickslip.gap.exact.scanned import Scanned, scanned
from stickslip.gap.exact.scans import Scans
from stickslip.gap.records.model import Nuisance
from stickslip.gap.records.record import Record
from stickslip.logs.arrays import Values

UNSURE, LEAST = 0.02, 1e-3  # of its size: what is not known of a state at the start; size of one that starts at less


def start_spread(start: Values, names: Sequence[str], unsure: Mapping[str, float]) -> Values:
    """Return by how much each state may start elsewhere: what is said of those with ``names``, or a share of its size.

    >>> start_spread(np.array([5.0, 0.0]), ["tank.level"], {"tank.level": 2.0})
    array([2.e+00, 2.e-05])
    """
    said = np.array([unsure.get(name, 0.0) for name in names])
    found = np.maximum(UNSURE * np.maximum(np.abs(start), LEAST), np.pad(said, (0, len(start) - len(said))))
    return np.asarray(found)


@dataclass(frozen=True, eq=False)
class Exact:
    """A silent ``diagram``, its ``noise``, the logged ``signals`` of a ``record``, its ``scans``; ``unsure`` by how
    much its states may start elsewhere; ``known`` the last steps from row to row.
    """

    diagram: Diagram
    noise: tuple[Nuisance, ...]
    signals: tuple[str, ...]
    record: Record
    scans: Scans
    unsure: Mapping[str, float] = field(default_factory=dict)
    known: dict[tuple[object, ...], Rows] = field(default_factory=dict)
    waved: dict[tuple[object, ...], Values] = field(default_factory=dict)

    @cached_property
    def visited(self) -> tuple[dict[str, float], ...]:
        """The value of each signal in the middle of what the log visits, and at both ends."""
        logged = {s: self.record.log[s][self.record.log.good(s)] for s in (*self.record.played, *self.record.pinned)}
        return tuple(
            operating(
                self.diagram, {s: float(f(v)) for s, v in logged.items() if len(v)}, self.record.played,
                self.scans.controllers,
            )
            for f in (np.mean, np.min, np.max)
        )  # fmt: skip

    @cached_property
    def straight(self) -> None:
        """Nothing; raises ``NotAffine`` where a block bends within what the log visits."""
        for block in self.diagram.blocks:
            if block not in self.waves:
                self._ask(block)

    @cached_property
    def waves(self) -> tuple[Block, ...]:
        """The blocks that give something in time, and nothing else."""
        return tuple(
            b for b in self.diagram.blocks
            if b.kernels.timed and not b.input_labels and not b.seen_states() and not isinstance(b, Recorded)
        )  # fmt: skip

    def _ask(self, block: Block) -> None:
        """Raise ``NotAffine`` for a block that bends within what the log visits, or a controller of other limits."""
        if block.role is Role.CONTROLLER and block.limit_params:
            if block.limits != self.diagram[block.name].limits:
                raise NotAffine(f"'{block.name}' may be at a limit that no controller of the model has")
        elif isinstance(block, Recorded):
            raise NotAffine(f"'{block.name}' plays what was recorded, which is no line in time")
        elif block.role not in ONLOOKERS:
            middle, *ends = (np.array([one[str(s)] for s in block.input_labels]) for one in self.visited)
            straight_between(inside(block, self.visited[0]), middle, ends, self.record.log.t)

    def filtered(
        self, params: Mapping[str, float], sizes: Mapping[str, tuple[float, float]], Y: Values, r: Values
    ) -> tuple[Values, Values, Values]:
        """Return innovations of unit variance, their variances, and what the mean showed, (rows, signals) each.

        ``params`` block.parameter -> value; ``sizes`` source of random numbers -> (standard deviation, correlation time
        [s]); ``Y`` (rows, signals), NaN where a signal says nothing, ``r`` (rows, signals) variance of its rounding.
        Raises ``NotAffine`` for a diagram that bends.
        """
        rows = self._rows(params, sizes)
        kind = rows.kinds(len(Y), self.scans.every)
        added = rows.added(self.inputs(params), self.scans.every, kind)
        unknown = np.zeros((len(Y), len(rows.start)))
        for c, limited in enumerate(self.scans.limited):
            low, high = self.diagram[self.scans.controllers[c]].limits
            integral = rows.memory[rows.of == c][:1]  # the rest of a memory follows SP and PV, whatever OP's limits
            unknown[np.ix_(limited, integral)] = (high - low) ** 2
            Y = np.where(np.outer(limited, np.isin(self.signals, self.ops[c])), np.nan, Y)
        e, S, shown = (np.empty(Y.shape) for _ in range(3))
        filtered(
            kind, rows.A, rows.Q, rows.H, added, unknown, Y, r, rows.start.copy(), rows.variance.copy(), e, S, shown
        )
        return e, S, shown

    @cached_property
    def ops(self) -> tuple[str, ...]:
        """The outputs of the controllers."""
        return tuple(str(self.diagram[name].output_labels[0]) for name in self.scans.controllers)

    def _rows(self, params: Mapping[str, float], sizes: Mapping[str, tuple[float, float]]) -> Rows:
        """Return the steps from row to row; the last ones are known still, since a switch of an input changes none."""
        own = tuple(f"{b.name}." for b in self.waves)
        key = (*(v for name, v in params.items() if not name.startswith(own)), *sizes.values())
        if key not in self.known:
            one = self.scanned(params, sizes)
            variance = start_spread(one.start, one.states, self.unsure) ** 2
            variance[one.drawn] = [sizes[n.block][0] ** 2 for n in self.noise]
            self.known.clear()
            self.known[key] = by_rows(one, self.scans.every, np.diag(variance))
        return self.known[key]

    def scanned(self, params: Mapping[str, float], sizes: Mapping[str, tuple[float, float]], cut: str = "") -> Scanned:
        """Return the matrices from scan to scan, ``cut`` at the signal of a stem."""
        noise = tuple(Nuisance(one.block, *sizes[one.block]) for one in self.noise)
        grouped: dict[str, dict[str, float]] = {}
        for name, value in params.items():
            block, _, own = name.rpartition(".")
            grouped.setdefault(block, {})[own] = float(value)
        waves = {b.name: str(s) for b in self.waves for s in b.output_labels}
        blocks = [b.with_params(**grouped[b.name]) if b.name in grouped else b for b in self.diagram.blocks
                  if b.name not in waves]  # fmt: skip
        _ = self.straight
        for block in blocks:
            if block.name in grouped:
                self._ask(block)
        return scanned(blocks, noise, self.scans.controllers, self.signals, (*self.record.played, *waves.values()),
                       self.visited[0], self.scans.period, cut)  # fmt: skip

    def inputs(self, params: Mapping[str, float]) -> Values:
        """Return the inputs at each scan: what is logged, the mean of each wave over the scan, the time, 1."""
        means = [self._means(b, params) for b in self.waves]
        return np.column_stack([self.scans.u[:, :-2], *means, self.scans.u[:, -2:]]) if means else self.scans.u

    def _means(self, block: Block, params: Mapping[str, float]) -> Values:
        """Return the means of a wave over each scan, (scans, outputs)."""
        own = {name: params[f"{block.name}.{name}"] for name in block.param_names if f"{block.name}.{name}" in params}
        t, h = self.scans.u[:, -2], self.scans.period
        key = (block.name, len(t), float(t[0]), *own.values())
        if key not in self.waved:
            sums = [Integrator(1.0, inputs=str(s), outputs=f"sum {s}", name=f"sum {s}") for s in block.output_labels]
            whole = wire([block.with_params(**own), *sums])
            found = simulate(whole, len(t) * h, times=np.append(t, t[-1] + h), t0=float(t[0])).log
            self.waved.clear()
            self.waved[key] = np.column_stack([np.diff(found[f"sum {s}"]) / h for s in block.output_labels])
        return self.waved[key]

    def of(self, record: Record, scans: Scans) -> "Exact":
        """Return the same filter of another record with inputs that switch at other scans, or of other rows."""
        found = replace(self, record=record, scans=scans)
        found.__dict__.update({name: self.__dict__[name] for name in ("visited", "straight") if name in self.__dict__})
        return found
