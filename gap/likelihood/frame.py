"""What every hypothesis of one record shares: rows and stops, what the log rounds, what is free in every fit."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.recorded import Recorded
from stickslip.blocks.role import Role
from stickslip.blocks.sources import Constant
from stickslip.diagram import simulate
from stickslip.diagram.inputs import close
from stickslip.gap.exact.scans import Scans, scans_of
from stickslip.gap.likelihood.inputs import Doubt
from stickslip.gap.records.given import Held
from stickslip.gap.records.model import Nuisance
from stickslip.gap.records.record import Digits, switch_rows, switches
from stickslip.logs.arrays import Values

NEAR = 4  # rows behind a switch that tell when it was
DRAWS = 20  # of a noise from row to row, at most
FAST = 2.0  # stops in the correlation time of a load that changes between two rows
SAME = 1e-6  # of an interval: stops nearer to each other are one
SAME_STEP = 0.01  # share by which the step that a sensor states may differ from that of the log
SEEN_FINER = 1e-3  # of a step that the controller has seen: so well it is known then
BUDGET = 2_000_000_000  # steps of the engine
FINEST = 1e-5  # of a signal's spread: what a signal that is not rounded is known to, and a run computes it to


@dataclass(frozen=True, eq=False)
class Frame(Held):
    """``given`` a model that starts as the record starts, its logged sources open; ``record`` of its signals;
    ``apart``: whether rows just behind a switch of an input are left out, as long as nobody knows when it switched;
    ``seen`` the share of the rows, from the first, that a fit sees; ``draws`` of a noise from row to row, at most;
    ``doubts`` what the log does not tell of its inputs; ``most_steps`` of the engine in one filter; ``unsure`` by how
    much states of the model may start elsewhere.
    """

    apart: bool = False
    seen: float = 1.0
    draws: int = DRAWS
    doubts: Mapping[str, Doubt] = field(default_factory=dict)
    most_steps: int = BUDGET
    unsure: Mapping[str, float] = field(default_factory=dict)

    @property
    def replays(self) -> bool:
        """Whether hypotheses are replayed, not followed by a filter."""
        return False

    @property
    def free(self) -> dict[str, tuple[float, float]]:
        """What is fitted with every hypothesis."""
        return self.given.free

    @property
    def stated(self) -> dict[str, float]:
        """What the model states of all that is free."""
        return self.given.stated

    @cached_property
    def ops(self) -> tuple[str, ...]:
        """The logged outputs of controllers."""
        given = {str(b.output_labels[0]) for b in self.model.blocks if b.role is Role.CONTROLLER}
        return tuple(s for s in self.record.pinned if s in given)

    @cached_property
    def probed(self) -> NDArray[np.bool_]:
        """Signals that tell whether anything bends within the spread: outputs of controllers, else all."""
        return np.array([s in self.ops or not self.ops for s in self.signals])

    @cached_property
    def first(self) -> dict[str, float]:
        """The first value of every signal: as it is logged, or as the model makes it of those that are."""
        known = {s: v for s, v in self.record.first.items() if math.isfinite(v)}
        given = [b for b in self.quiet.blocks if b.output_labels and {*map(str, b.output_labels)} <= known.keys()]
        rest = self.quiet.without(*(b.name for b in given)) if given else self.quiet
        needed = {s: Constant(s, known[s], name=f"{s}:first") for s in map(str, rest.open_inputs)}
        begun = simulate(close(rest, needed), self.record.log.dt, times=[0.0]).log if rest.blocks else None
        return {s: float(begun[s][0]) for s in begun.names} | known if begun is not None else known

    @cached_property
    def sources(self) -> dict[str, Recorded]:
        """What plays each logged input."""
        return {s: self.record.source(s) for s in self.record.played}

    @cached_property
    def r(self) -> Values:
        """Variance of the log's rounding of each value, (rows, signals).

        Where the model's sensor gives multiples of that step, the log has what the controller saw, as it was.  A step
        that its noise does not make noise stays rounding, for the runs that predict it round as well.
        """
        found, smooth = [], {one.block for one in self.noise if one.rounding > 0.0}
        for j, s in enumerate(self.signals):
            known = self.Y[:, j][np.isfinite(self.Y[:, j])]
            computed = self.record.computed.get(s, 0.0)
            digits = Digits(computed) if computed else Digits.of(known)
            sensor = self.model.blocks[self.model.driven[s][0]]
            stated = sensor.params.get("step", 0.0)
            if sensor.name in smooth and math.isclose(digits.step, stated, rel_tol=SAME_STEP):
                digits = Digits(SEEN_FINER * stated)
            found.append(np.maximum(digits.steps(self.Y[:, j]) ** 2 / 12.0, self.computed[j]))
        return np.stack(found, axis=1)

    @cached_property
    def computed(self) -> Values:
        """Variance to which a run computes each signal, (signals,)."""
        return np.asarray(np.maximum((FINEST * np.nanstd(self.Y, axis=0)) ** 2, 1e-300))

    @cached_property
    def anew(self) -> Values:
        """Logged values, (rows, signals), NaN where the log has an output again that has not been made anew.

        It has the same rounding then, and says nothing new.
        """
        found, t = self.Y.copy(), self.record.log.t
        for j, s in enumerate(self.signals):
            block = self.model.blocks[self.model.driven[s][0]]
            if block.sampled:
                offset = block.params.get(block.offset_param or "", 0.0)
                scans = np.floor((t - offset) / block.period + SAME)
                found[1:][(np.diff(scans) == 0.0) & (np.diff(self.Y[:, j]) == 0.0), j] = np.nan
        return found

    @cached_property
    def limited(self) -> NDArray[np.bool_]:
        """Rows at which, or just before which, an output may have been at a limit where there is an exact filter: what
        is said of them differs from filter to filter.
        """
        if self.scans is None:
            return np.zeros(len(self.Y), dtype=np.bool_)
        return np.asarray(self.scans.unsure.any(axis=0))

    @cached_property
    def counted(self) -> NDArray[np.bool_]:
        """Which rows count."""
        row = np.arange(len(self.Y))
        found = (row >= self.skipped) & (row < self.seen * len(row))
        found &= ~self.limited
        for s in self.record.played if self.apart else ():
            if switches(self.record.log, s):
                for k in range(NEAR):
                    found[np.minimum(switch_rows(self.record.log, s) + k, len(found) - 1)] = False
        return found

    @cached_property
    def scan(self) -> float:
        """The interval in which dead times are followed [s]: that of the fastest scan, or a fifth of a row's.

        Noise counts where nothing scans: in the filter it is held between stops, however often it draws.
        """
        drawn = {one.block for one in self.noise if one.correlation_time > 0.0}
        sampled = [b for b in self.model.blocks if b.sampled and b.role is not Role.HISTORIAN]
        scans = [b.period for b in sampled if b.name not in drawn] or [b.period for b in sampled]
        return min(scans, default=0.2 * self.record.log.dt)

    @cached_property
    def scanned(self) -> float:
        """The scan period of the controllers [s], 0 where one of them does not scan."""
        found = [b for b in self.model.blocks if b.role is Role.CONTROLLER]
        return min((b.period for b in found), default=0.0) if found and all(b.sampled for b in found) else 0.0

    @cached_property
    def stops(self) -> tuple[Values, NDArray[np.int64]]:
        """Times at which the filter stops [s], and the row of the log at each, -1 for none."""
        t = self.record.log.t
        times = [t]
        for one in self.noise:
            block, wanted = self.model[one.block], one.correlation_time / FAST
            if wanted < self.record.log.dt:  # else what is held from row to row hardly changes
                offset = float(block.params.get("offset", 0.0))
                finest = math.ceil(self.record.log.dt / block.period / self.draws)
                every = block.period * max(1, finest, math.floor(wanted / block.period))
                first = offset + every * math.ceil((t[0] - offset) / every - 1e-9)
                times.append(np.arange(first, t[-1] + 1e-9, every))
        if any(one.spread > 0.0 for one in self.doubts.values()):
            every = self.scanned or 0.25 * self.record.log.dt
            every *= max(1, math.ceil(self.record.log.dt / every / self.draws))
            times.append(np.arange(t[0], t[-1], every))
        every_time = np.sort(np.concatenate(times))
        apart = np.concatenate([[True], np.diff(every_time) > SAME * self.record.log.dt])
        stops = every_time[apart]
        row_of = np.full(len(stops), -1)
        near = np.clip(np.searchsorted(stops, t - SAME * self.record.log.dt), 0, len(stops) - 1)
        row_of[near] = np.arange(len(t))
        return stops, row_of

    def switching(self, leads: Mapping[str, Mapping[int, float]]) -> "Frame":
        """Return the same frame with inputs that switch so long before the rows that show it."""
        other = replace(self, record=replace(self.record, leads=leads))
        kept = {
            name: found for name, found in self.__dict__.items() if name not in (*other.__dict__, "sources", "scans")
        }
        other.__dict__.update(kept)
        return other

    @cached_property
    def scans(self) -> Scans | None:
        """The scans of the record, where an exact filter may follow it from one to the next."""
        return None if self.doubts else scans_of(self.smooth, self.record)

    @cached_property
    def doubted(self) -> dict[str, tuple[Values, Values]]:
        """How much of the doubt of an input stays at each stop, and the standard deviation of what is new."""
        log = self.record.log
        return {s: one.drawn(log.t, log[s], *self.stops) for s, one in self.doubts.items()}

    def drawn(self, noise: Nuisance) -> NDArray[np.bool_]:
        """Return at which stops a source of white noise draws."""
        stops, _ = self.stops
        block = self.model[noise.block]
        offset = float(block.params.get("offset", 0.0))
        turns = (stops - offset) / block.period
        at = np.abs(turns - np.round(turns)) * block.period < 1e-6
        at[0] = True
        found: NDArray[np.bool_] = at
        return found
