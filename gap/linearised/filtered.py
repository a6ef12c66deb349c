"""Residuals of a diagram too large, or with too many integrators, to be replayed freely between the rows of a log.

What drives a process is logged (``parts``), so a log takes it apart:

    controllers and what a log drives alone    replayed as they are, pinned to the log: the change of each offset
    valves and planned sources                 simulated as they are, with whatever sticks in them, driven by the log
    the process behind them                    by its own equations from row to row, set right at each by the gain of
                                               a Kalman filter (``observer``): innovations

The gain is that of the model with its nuisances, linear about the middle of the record; an effect changes the
prediction, not the gain.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from stickslip.blocks.role import Role
from stickslip.diagram.changes import part
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.linear.slopes import Slopes
from stickslip.diagram.pins import replays
from stickslip.gap.linearised.behind import NOTHING, Behind, behind
from stickslip.gap.linearised.between import jumps
from stickslip.gap.linearised.driving import as_inputs, driven
from stickslip.gap.linearised.gains import Gains, Linear, gains
from stickslip.gap.linearised.local import back, linear, near
from stickslip.gap.linearised.observer import Observer, observer
from stickslip.gap.linearised.parts import Parts, ancestors, parts
from stickslip.gap.records.model import nuisances
from stickslip.gap.records.record import Record
from stickslip.logs import Log
from stickslip.logs.arrays import Values

FINEST = 1e-6  # of a signal's size: what a signal that is not rounded is known to
UNSURE = 0.5  # share by which the curve of an output between two rows may be another behind a jump
UNSURE_AT_FIRST = 0.15  # share of its first move by which it may be off that curve
BENT = 15  # rows behind a jump for which an output is bent
LOST = 1e4  # innovation of a row that a process which has run away cannot foretell
KEPT = 400  # results that are remembered


@dataclass(frozen=True, eq=False)
class Filter:
    """The filter of a model for records of one kind: its ``parts``, its ``process`` near the record's middle.

    ``quiet`` the model; ``loads`` those that nobody measures, signal -> (standard deviation, correlation time [s]);
    ``back`` state -> how far it moves for what is measured to move by one; ``dt`` [s] between rows; ``expected`` (rows,
    signals) what is left on average without a gap behind jumps of set points, between whose rows the outputs of
    controllers are not quite known; ``held`` what every diagram does there, None for its own run.
    """

    parts: Parts
    loads: Mapping[str, tuple[float, float]]
    dt: float
    quiet: Diagram
    process: Linear
    back: Mapping[str, Values]
    expected: Values | None = None
    held: Behind | None = None
    known: dict[object, Any] = field(default_factory=dict, repr=False)

    def residuals(
        self, diagram: Diagram, record: Record, params: Mapping[str, ArrayLike] | None, logs: Sequence[Log] | None
    ) -> Values:
        """Return (runs, rows, pinned signals) of a silent diagram: see ``stickslip.gap.records.offsets.offsets``."""
        given = {key: np.atleast_1d(np.asarray(v, dtype=float)) for key, v in (params or {}).items()}
        each = [record.log] if logs is None else list(logs)
        many = max([len(each), *map(len, given.values())])
        found = parts(diagram, replace(record, pinned=(*self.parts.known, *self.parts.measured)), self.loads)
        asked = _Asked(diagram, found, record, each, given, self.between_rows(diagram, record, given))
        out = np.full((many, len(each[0]), len(record.pinned)), np.nan)
        for s, values in {**self._ruled(asked), **self._measured(asked)}.items():
            out[..., record.pinned.index(s)] = values
        return out if self.expected is None else out - self.expected[: out.shape[1]]

    def holding(self, diagram: Diagram, record: Record) -> "Filter":
        """Return the filter for which every diagram does between rows what one run of this one does."""
        return replace(self, held=self.between_rows(diagram, record, {}))

    def between_rows(self, diagram: Diagram, record: Record, given: Mapping[str, Values]) -> Behind:
        """Return what runs of a diagram do between rows; a stem that sticks does it at other times than the log's."""
        if self.held is not None:
            return self.held
        seen = self.quiet if any(block.can_stick for block in diagram.blocks) else diagram
        known = [*self.parts.known, *self.parts.measured]
        if given and seen is diagram:
            return behind(seen, record, known, given)
        key = "behind", id(record.log), _leads(record), _digest(seen, [block.name for block in seen.blocks])
        alone: Behind = self._kept(key, record.log, lambda: behind(seen, record, known, {}))
        return alone

    def _ruled(self, asked: "_Asked") -> dict[str, Values]:
        """Return the offsets of controllers, (runs or 1, rows) each."""
        found = asked.found
        if not found.judged:
            return {}
        own = _own(asked.given, found.ruled)
        runs = asked.runs(own)

        def made() -> dict[str, Values]:
            piece = part(asked.diagram, found.ruled, "ruled")
            inputs = as_inputs(asked.diagram, asked.record, asked.logs, piece.open_inputs, asked.more, runs)
            run = replays(
                piece, asked.logs[0] if len(asked.logs) < runs else asked.logs, signals=list(found.judged),
                params={key: np.broadcast_to(v, runs) for key, v in own.items()}, inputs=inputs or None,
            )  # fmt: skip
            return {s: np.where(run.ok[:, None], run.values[f"{s}:offset"], np.nan) for s in found.judged}

        if own or asked.several:
            return made()
        key = "ruled", id(asked.logs[0]), id(asked.more), _digest(asked.diagram, found.ruled)
        kept: dict[str, Values] = self._kept(key, (asked.logs, asked.more), made)
        return kept

    def _measured(self, asked: "_Asked") -> dict[str, Values]:
        """Return the innovations of measurements, (runs or 1, rows) each."""
        found, record = asked.found, asked.record
        fed, own = _own(asked.given, found.fed), _own(asked.given, found.rest)
        y = np.stack([np.stack([log[s] for s in found.measured], axis=1) for log in asked.logs])

        def made() -> Values:
            runs = asked.runs({**fed, **own})
            u = self.driven(asked, fed)
            u = np.broadcast_to(u, (runs, *u.shape[1:]))
            process = self._observer(asked.diagram, found)
            known = self.gains(record)
            K = known.of(process.states, self.process.states)
            each = np.broadcast_to(y, (runs, *y.shape[1:]))
            e = process.residuals(own, u, each, K, known.which, self.start(record), self.back, self.dt)
            return np.where(np.isnan(e) & np.isfinite(y), LOST, known.white(e))

        key = "rest", id(asked.logs[0]), id(asked.more), _digest(asked.diagram, (*found.fed, *found.rest))
        e = made() if fed or own or asked.several else self._kept(key, (asked.logs, asked.more), made)
        return {s: e[..., j] for j, s in enumerate(found.measured)}

    def driven(self, asked: "_Asked", own: Mapping[str, Values]) -> Values:
        """Return the inputs of the process, (runs or 1, 3, rows, inputs): see ``driving``."""

        def made() -> Values:
            return driven(
                asked.diagram, asked.found, asked.record, asked.logs, own, asked.runs(own), asked.more
            )  # fmt: skip

        if own or asked.several:
            return made()
        key = "fed", id(asked.logs[0]), id(asked.more), asked.found.given, _digest(asked.diagram, asked.found.fed)
        alone: Values = self._kept(key, (asked.logs, asked.more), made)
        return alone

    def _observer(self, diagram: Diagram, found: Parts) -> Observer:
        times = {s: time for s, (_, time) in self.loads.items()}
        made: Observer = self._kept(
            ("observer", found.given, found.measured, _digest(diagram, found.rest)), None,
            lambda: observer(part(diagram, found.rest, "rest"), found.given, found.measured, times),
        )  # fmt: skip
        return made

    def gains(self, record: Record) -> Gains:
        """Return the gains of each row of a record, and of other logs with its set points."""
        log = record.log

        def made() -> Gains:
            u = self.driven(self._plain(record), {})[0]
            between = {k for early in record.leads.values() for k in early}
            doubts: dict[int, Values] = {}
            for s in self.parts.known:
                if s in self.quiet.driven and self.quiet.blocks[self.quiet.driven[s][0]].role is Role.CONTROLLER:
                    follow = np.array([s in _read(self.quiet, one, self.parts) for one in self.parts.given])
                    for k in np.flatnonzero(jumps(self.quiet, record, log, s)[:-1]).tolist():
                        first = k if k in between else k + 1  # what a switch between two rows does shows at the next
                        for i in range(first, min(k + 1 + BENT, len(log))):
                            far = UNSURE * np.abs(u[2, i]) + UNSURE_AT_FIRST * (i == k + 1) * np.abs(u[1, i] - u[0, k])
                            doubts[i] = doubts.get(i, 0.0) + far * follow
            return gains(self.process, len(log), doubts)

        found: Gains = self._kept(("gains", id(log), _leads(record)), log, made)
        return found

    def start(self, record: Record) -> dict[str, float]:
        """Return the states from which the model's process shows the first row of a record."""
        y = np.stack([record.log[s] for s in self.parts.measured], axis=1)

        def made() -> Slopes:
            u = self.driven(self._plain(record), {})[0, 0, 0]
            at = dict(zip(self.parts.given, u.tolist(), strict=True))
            return near(part(self.quiet, self.parts.rest, "rest"), self.parts, at, y[np.isfinite(y).all(axis=1)][0])

        local: Slopes = self._kept(("start", id(record.log)), record.log, made)
        return dict(zip(local.states, local.x.tolist(), strict=True))

    def _plain(self, record: Record) -> "_Asked":
        """Return what there is to ask of the model as it is."""
        return _Asked(
            self.quiet,
            self.parts,
            record,
            [record.log],
            {},
            replace(self, held=None).between_rows(self.quiet, record, {}),
        )

    def _kept(self, key: object, named: object, made: Any) -> Any:
        """Return what is known by a key, or make it; what the key ``named`` by its id lives as long as what it gave."""
        if key not in self.known:
            if len(self.known) > KEPT:
                self.known.clear()
            self.known[key] = named, made()
        return self.known[key][1]


@dataclass(frozen=True, eq=False)
class _Asked:
    """What residuals are asked of: a ``diagram`` with its parts ``found``, ``logs`` one a run or one for all, ``given``
    parameters, one value a run, and what runs do between rows, ``more``.
    """

    diagram: Diagram
    found: Parts
    record: Record
    logs: Sequence[Log]
    given: Mapping[str, Values]
    more: Behind

    @property
    def several(self) -> bool:
        """Whether runs differ by more than by parameters."""
        return self.more.runs > 1 or len(self.logs) > 1

    def runs(self, own: Mapping[str, Values]) -> int:
        """Return how many runs differ where only some of the parameters are felt."""
        return max([self.more.runs, len(self.logs), *map(len, own.values())])


def filter_of(model: Diagram, quiet: Diagram, record: Record) -> Record | None:
    """Return the record with the filter of a model, and the signals that it judges; None where replays do better.

    It is for models whose loads wander and whose controllers do not scan.
    """
    wandering = {
        str(model[one.block].output_labels[0]): (one.sd, one.correlation_time)
        for one in nuisances(model)
        if one.correlation_time > 0.0
    }
    scanning = any(block.sampled and block.role is Role.CONTROLLER for block in model.blocks)
    if not wandering or scanning:
        return None
    found = parts(quiet, record, wandering)
    inside = {str(s) for name in found.rest for s in quiet[name].output_labels}
    loads = {s: size for s, size in wandering.items() if s in inside}
    if not found.measured or not loads:
        return None
    dt = float(np.median(np.diff(record.log.t)))
    u = driven(quiet, found, record, [record.log], {}, 1, NOTHING)[0, 0]
    at = dict(zip(found.given, u.mean(axis=0).tolist(), strict=True))
    shown = np.array([np.nanmean(record.log[s]) for s in found.measured])
    local = near(part(quiet, found.rest, "rest"), found, at, shown)
    R = np.diag([known_to(record, s) ** 2 for s in found.measured])
    process = linear(local, found.given, found.measured, loads, R, dt)
    judged = tuple(s for s in record.pinned if s in (*found.measured, *found.judged))
    return replace(
        record,
        pinned=judged,
        used=tuple(s for s in record.pinned if s not in judged),
        filter=Filter(found, loads, dt, quiet, process, dict(zip(local.states, back(local, found), strict=True))),
    )


def _read(quiet: Diagram, signal: str, found: Parts) -> set[str]:
    """Return the known signals from which an input of the process follows."""
    if signal in found.known:
        return {signal}
    return {str(s) for name in ancestors(quiet, [signal], set(found.known)) for s in quiet[name].input_labels}


def _own(given: Mapping[str, Values], names: Sequence[str]) -> dict[str, Values]:
    """Return the parameters of some blocks."""
    return {key: v for key, v in given.items() if key.rpartition(".")[0] in names}


def _leads(record: Record) -> tuple[object, ...]:
    return tuple((s, tuple(early.items())) for s, early in record.leads.items())


def known_to(record: Record, signal: str) -> float:
    """Return the standard deviation of the rounding of a signal."""
    values = record.log[signal]
    return max(record.lattice(signal) / float(np.sqrt(12.0)), FINEST * float(np.nanmax(np.abs(values))), 1e-12)


def _digest(diagram: Diagram, names: Sequence[str]) -> tuple[object, ...]:
    blocks = [diagram[name] for name in names]
    return tuple(
        (
            b.name, type(b).__name__, tuple(b.input_labels), tuple(b.output_labels), b.p.tobytes(), b.x0.tobytes(),
            b.d0.tobytes(),
        )
        for b in blocks
    )  # fmt: skip
