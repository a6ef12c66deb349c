"""A record as a filter reads it: values, their digits, scans between rows, which signals controllers give."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.gap.filters.affine import NotAffine
from stickslip.gap.filters.scanned import base_period
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.insertion.paths import made_of
from stickslip.gap.records.given import Held
from stickslip.gap.records.record import RARE, rounding, switch_rows

Floats = NDArray[np.float64]
UNSEEN = 1e9  # variance of a signal that is not there
NEAR = 4  # rows behind a switch of an input that tell of its scan


@dataclass(frozen=True, eq=False)
class Filtering(Held):
    """``given`` a model that starts as the record starts; ``record``; ``leads`` scans by which each switch of an input
    comes before the row that shows it, (inputs, rows); ``apart``: whether rows just behind a switch are left out;
    ``catalogue``: effects of which a little may be beside another; ``loose``: whether noise and loads are fitted, about
    what the model states, or are as it states them.
    """

    leads: NDArray[np.int64]
    apart: bool = False
    catalogue: tuple[Effect, ...] = ()
    loose: bool = False

    @cached_property
    def counted(self) -> NDArray[np.bool_]:
        """Which rows count: those behind the start, and ``apart`` those that no switch of an input is near."""
        found = np.arange(len(self.Y)) >= self.skipped
        if self.apart:
            for s in self.record.played:
                rows = switch_rows(self.record.log, s)
                if len(rows) < RARE * len(self.Y):
                    for k in range(NEAR):
                        found[np.minimum(rows + k, len(found) - 1)] = False
        return found

    @cached_property
    def period(self) -> float:
        """Scan period [s]."""
        return base_period(self.quiet)

    @cached_property
    def every(self) -> int:
        """Scans between two rows."""
        return round(self.record.log.dt / self.period)

    @cached_property
    def controllers(self) -> tuple[str, ...]:
        """The blocks that scan and act, the outer one of a cascade before those whose set points it moves."""
        found = [b for b in self.quiet.blocks if b.role is Role.CONTROLLER and b.sampled]
        if not found:
            raise NotAffine("the diagram has no controller that scans")
        given_by = {str(b.output_labels[0]): b for b in found}

        def depth(block: Block) -> int:
            behind = [given_by[s] for s in made_of(self.quiet, str(block.loop_signal("SP"))) if s in given_by]
            return 1 + max((depth(b) for b in behind), default=0)

        return tuple(b.name for b in sorted(found, key=depth))

    @cached_property
    def ops(self) -> tuple[str, ...]:
        """The outputs of the controllers."""
        return tuple(str(self.quiet[name].output_labels[0]) for name in self.controllers)

    @cached_property
    def acts(self) -> NDArray[np.int64]:
        """Which controller gives each signal, -1 for measurements."""
        return np.array([self.ops.index(s) if s in self.ops else -1 for s in self.signals])

    def op_at(self, place: str) -> str:
        """Return the output of the controller at a place, or of the one that the place follows."""
        block = self.quiet[place]
        behind = [
            str(block.output_labels[0]),
            *(one for s in block.input_labels for one in made_of(self.quiet, str(s))),
        ]
        return next((s for s in behind if s in self.ops), self.ops[-1])

    @property
    def unsure(self) -> dict[str, tuple[float, float]]:
        """Parameters that are fitted with every explanation, whether noise and loads are or not."""
        return self.given.unsure

    @property
    def free(self) -> dict[str, tuple[float, float]]:
        """What is fitted with every explanation, with (low, high): tolerances, and ``loose`` noise and loads."""
        return self.given.free if self.loose else self.given.unsure

    @cached_property
    def stated(self) -> dict[str, float]:
        """What the model states of all that is free."""
        return {key: self.given.stated[key] for key in self.free}

    @cached_property
    def r(self) -> Floats:
        """Variance of the log's rounding of each signal, not quite 0 where it does not round."""
        log = self.record.log
        found = []
        for s in self.signals:
            values = log[s][log.good(s)]
            step = self.record.computed.get(s, 0.0) or rounding(values)
            found.append(max(step**2 / 12.0, 1e-12 * float(np.var(values))) if len(values) else UNSEEN)
        return np.array(found)

    @cached_property
    def scans(self) -> int:
        """Scans of the whole record."""
        return (len(self.Y) - 1) * self.every + 1

    @cached_property
    def time(self) -> Floats:
        """Time of each scan [s]."""
        return np.asarray(float(self.record.log.t[0]) + self.period * np.arange(self.scans))

    @cached_property
    def played(self) -> Floats:
        """Logged inputs at each scan, (scans, inputs)."""
        log = self.record.log
        found = np.empty((self.scans, len(self.record.played)))
        for j, s in enumerate(self.record.played):
            found[:, j] = np.repeat(log[s], self.every)[: self.scans]
            for row in np.flatnonzero(self.leads[j, 1:] * np.diff(log[s])) + 1:
                found[row * self.every - self.leads[j, row] : row * self.every, j] = log[s][row]
        return found

    @cached_property
    def seen(self) -> dict[str, float]:
        """Mean of each logged signal."""
        return {s: float(np.nanmean(self.record.log[s])) for s in (*self.record.played, *self.record.pinned)}

    def with_leads(self, leads: NDArray[np.int64]) -> "Filtering":
        """Return the same record with other scans at which its inputs switch."""
        return replace(self, leads=leads)

    def head(self, rows: int) -> "Filtering":
        """Return the first rows of the record."""
        log = self.record.log.samples(0, rows)
        return replace(self, record=replace(self.record, log=log), leads=self.leads[:, :rows])
