"""Residuals of a diagram too large, or with too many integrators, to be replayed freely between the rows of a log.

What drives a process is logged (``parts``), so a log takes it apart:

    controllers and what a log drives alone    replayed as they are, pinned to the log: the change of each offset
    valves and planned sources                 simulated as they are, with whatever sticks in them, driven by the log
    the process behind them                    linear about where the model rests, innovations of its Kalman filter

The filter's gain is that of the model with its nuisances; an effect changes the prediction, not the gain.  What a
linear model misses without a gap is in the floor, since the runs behind that are of the diagram as it is.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocks.role import Role
from diagram.changes import part
from diagram.diagram import Diagram
from diagram.ensembles.running import ensemble
from diagram.inputs import close
from diagram.linear.slopes import slopes
from diagram.pins import replays
from gap.floor import Floor, floor_of, losses, residuals, settling_rows, without_gap
from gap.linearised.between import BEFORE, as_input, stretches, until
from gap.linearised.kalman import Sampled, gain, innovations, noise
from gap.linearised.local import LEAST, linear, near, spread
from gap.linearised.parts import Parts, ancestors, parts
from gap.model import nuisances
from gap.offsets import known_starts
from gap.record import Record
from logs import Log

Floats = NDArray[np.float64]
FINEST = 1e-6  # of a signal's size: what a signal that is not rounded is known to
SIGMAS = 4.5  # by which a segment's loss may exceed its mean without a gap
BESIDE = 0.02  # of an input: to what its mean is taken, about which a process is linear
KEPT = 4000  # results that are remembered
MOVED = 0.01  # of a measurement's mean: by how much it may move until a new stretch begins


@dataclass(frozen=True, eq=False)
class Filter:
    """The filter of a model for records of one kind: its ``parts``, the gain ``K``, the unit of innovations.

    ``quiet`` the model; ``loads`` those that nobody
    measures, signal -> (standard deviation, correlation time [s]); ``root`` (outputs, outputs) makes innovations white;
    ``expected`` (rows, signals) what is left on average without a gap, since the process is not quite linear; ``usual``
    (3, signals) unit, mean and standard deviation of the loss of each signal's residuals then.
    """

    parts: Parts
    loads: Mapping[str, tuple[float, float]]
    size: Mapping[str, float]
    dt: float
    quiet: Diagram
    K: Floats
    root: Floats
    expected: Floats | None = None
    usual: Floats | None = None
    known: dict[object, Any] = field(default_factory=dict, repr=False)

    def residuals(
        self, diagram: Diagram, record: Record, params: Mapping[str, ArrayLike] | None, logs: Sequence[Log] | None
    ) -> Floats:
        """Return (runs, rows, pinned signals) of a silent diagram: see ``gap.offsets.offsets``."""
        given = {key: np.atleast_1d(np.asarray(v, dtype=float)) for key, v in (params or {}).items()}
        many = max((len(v) for v in given.values()), default=1)
        found = parts(diagram, replace(record, pinned=(*self.parts.known, *self.parts.measured)), self.loads)
        each = [record.log] if logs is None else list(logs)
        out = []
        for log in each:
            columns = {s: np.full((many, len(log)), np.nan) for s in record.pinned}
            self._ruled(diagram, found, record, log, given, columns)
            self._measured(diagram, found, record, log, given, many, columns)
            found_here = np.stack([columns[s] for s in record.pinned], axis=-1)
            out.append(found_here if self.expected is None else found_here - self.expected[: len(log)])
        return np.concatenate(out)

    def suspects(self, quiet: Diagram, record: Record, floor: Floor) -> tuple[str, ...]:
        """Return the blocks of the segments whose own residuals leave their floor.

        A controller and what is before it, back to logged signals, is a segment; the process with its valves is one.
        """
        if self.usual is None:
            return tuple(block.name for block in quiet.blocks)
        unit, mean, sd = self.usual
        r = residuals(self.residuals(quiet, record, None, None)[0], floor.changes)[floor.skipped :]
        loss = losses(r / unit).mean(axis=0)
        left = {s for s, far in zip(record.pinned, loss > mean + SIGMAS * sd, strict=True) if far}
        found = {name for s in left & set(self.parts.judged) for name in ancestors(quiet, [s], set(record.log.names))}
        if left & set(self.parts.measured) or not left:
            found |= {*self.parts.fed, *self.parts.rest}
        return tuple(block.name for block in quiet.blocks if block.name in found)

    def _ruled(
        self,
        diagram: Diagram,
        found: Parts,
        record: Record,
        log: Log,
        given: Mapping[str, Floats],
        out: dict[str, Floats],
    ) -> None:
        """Write the offsets of controllers."""
        if not found.judged:
            return
        own = {key: v for key, v in given.items() if _block(key) in found.ruled}
        key = "ruled", id(log), _digest(diagram, found.ruled)
        if own or key not in self.known:
            piece = part(diagram, found.ruled, "ruled")
            closed = close(piece, {s: as_input(diagram, record, log, s) for s in piece.open_inputs})
            run = replays(closed, log if own else [log], signals=list(found.judged), params=own)
            offsets = {s: np.where(run.ok[:, None], run.values[f"{s}:offset"], np.nan) for s in found.judged}
            if not own:
                self.known[key] = log, offsets
        else:
            offsets = self.known[key][1]
        for s, found_offsets in offsets.items():
            out[s][:] = found_offsets

    def _measured(
        self,
        diagram: Diagram,
        found: Parts,
        record: Record,
        log: Log,
        given: Mapping[str, Floats],
        many: int,
        out: dict[str, Floats],
    ) -> None:
        """Write the innovations of measurements."""
        y = np.stack([log[s] for s in found.measured], axis=1)
        fed = self._fed(diagram, found, record, log, {k: v for k, v in given.items() if _block(k) in found.fed}, many)
        own, way = {key: v for key, v in given.items() if _block(key) in found.rest}, self.way(record, log)
        for k, values in enumerate(_each(own, many)):
            e = self._innovations(diagram, found, values, fed[k], y, way)
            for j, s in enumerate(found.measured):
                out[s][k] = e[:, j]

    def _fed(
        self, diagram: Diagram, found: Parts, record: Record, log: Log, own: Mapping[str, Floats], many: int
    ) -> Floats:
        """Return the inputs of the process at each row and just before it, (runs, 2, rows, inputs)."""
        key = "fed", id(log), _digest(diagram, found.fed)
        if own:
            return driven(diagram, found, record, log, own, many)
        if key not in self.known:
            self.known[key] = log, driven(diagram, found, record, log, {}, 1)
        alone: Floats = self.known[key][1]
        return np.broadcast_to(alone, (many, *alone.shape[1:]))

    def _innovations(
        self, diagram: Diagram, found: Parts, values: Mapping[str, float], u: Floats, y: Floats, way: "Way"
    ) -> Floats:
        e, now = np.empty(y.shape), dict(way.start)
        for stretch, about in zip(way.stretches, way.about, strict=True):
            e[slice(*stretch)], now = self._along(diagram, found, values, u, y, stretch, about, now)
        return np.asarray(e @ self.root.T)

    def _along(
        self, diagram: Diagram, found: Parts, values: Mapping[str, float], u: Floats, y: Floats,
        stretch: tuple[int, int], about: Mapping[str, float], now: Mapping[str, float],
    ) -> tuple[Floats, dict[str, float]]:  # fmt: skip
        """Return what is left of the rows of a stretch, and the states behind it, from those before it."""
        first, behind = stretch
        mean = u[0, first:behind].mean(axis=0).tolist()
        at = np.array([beside(m) for m in mean])
        local, model = self._local(diagram, found, values, at, about)
        K = np.zeros((len(local), len(found.measured)))
        own = {name: i for i, name in enumerate(self.size)}
        for i, (name, (_, size)) in enumerate(local.items()):
            if name in own:
                K[i] = self.K[own[name]] * self.size[name] / size
        x = np.array([(now.get(name, v) - v) / size for name, (v, size) in local.items()])
        rows = slice(first, behind + 1)  # the last one is only predicted: the next stretch sets it right
        shown = y[rows].copy()
        shown[behind - first :] = np.nan
        e = innovations(model, K, u[0, rows] - at, u[1, rows] - at, shown, x)[: behind - first]
        return e, {name: float(v + size * dev) for (name, (v, size)), dev in zip(local.items(), x, strict=True)}

    def _local(
        self, diagram: Diagram, found: Parts, values: Mapping[str, float], at: Floats, about: Mapping[str, float]
    ) -> tuple[dict[str, tuple[float, float]], Sampled]:
        """Return state -> (value, size) where a process is linear near known states, and the model from row to row."""
        key = (
            "rest", _digest(diagram, found.rest), found.given, tuple(values.items()), at.tobytes(),
            tuple(about.values()),
        )  # fmt: skip
        if key not in self.known:
            if len(self.known) > KEPT:
                self.known.clear()
            piece = part(diagram, found.rest, "rest").with_params(dict(values))
            piece = piece.starting_at(known_starts(piece, {_dotted(name): v for name, v in about.items()}))
            inputs = dict(zip(found.given, at.tolist(), strict=True))
            local = slopes(close(piece, {s: inputs[s] for s in piece.open_inputs}))
            model, states, size = linear(local, found, self.loads, self.dt)
            levels = [*local.x.tolist(), *[0.0] * len(self.loads)]
            self.known[key] = {n: (v, d) for n, v, d in zip(states, levels, size.tolist(), strict=True)}, model
        states_and_model: tuple[dict[str, tuple[float, float]], Sampled] = self.known[key]
        return states_and_model

    def way(self, record: Record, log: Log) -> "Way":
        """Return where the model's own filter puts the process along a log."""
        key = "way", id(log)
        if key not in self.known:
            y = np.stack([log[s] for s in self.parts.measured], axis=1)
            u = self._fed(self.quiet, self.parts, record, log, {}, 1)[0]
            rest = part(self.quiet, self.parts.rest, "rest")
            shown = y[np.isfinite(y).all(axis=1)]
            at = dict(zip(self.parts.given, u[0, 0].tolist(), strict=True))
            first = near(rest, self.parts, at, shown[0])
            start = dict(zip(first.states, first.x.tolist(), strict=True))
            pieces, about, now = stretches(y, MOVED * np.maximum(np.abs(np.nanmean(y, axis=0)), LEAST)), [], dict(start)
            for stretch in pieces:
                _, behind = self._along(self.quiet, self.parts, {}, u, y, stretch, now, now)
                about.append({name: 0.5 * (now.get(name, v) + v) for name, v in behind.items()})
                now = behind
            self.known[key] = log, Way(tuple(pieces), tuple(about), start)
        found: Way = self.known[key][1]
        return found


@dataclass(frozen=True)
class Way:
    """Where a process is along a log: ``stretches`` (first row, row behind), the states ``about`` which it is linear in
    each, and those at the ``start``, by name.
    """

    stretches: tuple[tuple[int, int], ...]
    about: tuple[Mapping[str, float], ...]
    start: Mapping[str, float]


def beside(mean: float) -> float:
    """Return the mean of an input to some two digits, so that explanations near one another share one linear process.

    >>> beside(0.1371), beside(0.1373)
    (0.1375, 0.1375)
    """
    unit = BESIDE * 2.0 ** round(np.log2(max(abs(mean), LEAST)))
    return float(unit * round(mean / unit))


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
    loads = {s: told for s, told in wandering.items() if s in inside}
    if not found.measured or not loads:
        return None
    dt = float(np.median(np.diff(record.log.t)))
    u = driven(quiet, found, record, record.log, {}, 1)[0, 0]
    at = dict(zip(found.given, u.mean(axis=0).tolist(), strict=True))
    shown = np.array([np.nanmean(record.log[s]) for s in found.measured])
    local = near(part(quiet, found.rest, "rest"), found, at, shown)
    one, states, _ = linear(local, found, loads, dt)
    A, Q, size = spread(local, loads)
    R = np.diag([_known_to(record, s) ** 2 for s in found.measured])
    K, S = gain(one.F, one.C, noise(A, Q, dt), R)
    root = np.linalg.inv(np.linalg.cholesky(S))
    judged = tuple(s for s in record.pinned if s in (*found.measured, *found.judged))
    return replace(
        record,
        pinned=judged,
        used=tuple(s for s in record.pinned if s not in judged),
        filter=Filter(found, loads, dict(zip(states, size, strict=True)), dt, quiet, K, root),
    )


def floor_of_record(model: Diagram, quiet: Diagram, record: Record, runs: int, seed: int) -> tuple[Record, Floor]:
    """Return a record with what is expected of its residuals without a gap, and the floor beyond that.

    Both are of this record's set points, from ``runs`` runs of the model, ``seed`` the first.
    """
    if not isinstance(record.filter, Filter):
        raise TypeError("the record has no filter")
    logs = without_gap(model, record, runs, seed)
    found = record.filter.residuals(quiet, record, None, logs)
    judged = record.filter.parts.judged
    expected = np.nanmean(found, axis=0)
    of_others = (found - expected) * len(found) / (len(found) - 1)  # each run without its own share of the mean
    floor = floor_of(of_others, settling_rows(model, record), [s in judged for s in record.pinned], True)
    r = residuals(of_others, floor.changes)[:, floor.skipped :]
    unit = np.sqrt(np.nanmean(r**2, axis=(0, 1)))
    loss = losses(r / unit).mean(axis=1)
    usual = np.stack([unit, loss.mean(axis=0), loss.std(axis=0, ddof=1)])
    return replace(record, filter=replace(record.filter, expected=expected, usual=usual)), floor


def suspected(quiet: Diagram, record: Record, floor: Floor) -> Record:
    """Return a record with the blocks of the segments whose residuals leave their floor."""
    if not isinstance(record.filter, Filter):
        return record
    return replace(record, suspects=record.filter.suspects(quiet, record, floor))


def driven(diagram: Diagram, found: Parts, record: Record, log: Log, own: Mapping[str, Floats], many: int) -> Floats:
    """Return what a log makes valves and planned sources give, at each row and just before it: (runs, 2, rows, inputs).

    ``own`` parameters of these blocks, one value a run.
    """
    piece = part(diagram, found.fed, "fed")
    inside = [s for s in found.given if s in piece.signals]
    times = np.repeat(log.t, 2)[1:]
    times[1::2] -= BEFORE * np.diff(log.t)  # just before each row but the first
    out = np.empty((many, 2, len(log), len(found.given)))
    if inside:
        run = ensemble(
            piece, log.duration, t0=float(log.t[0]), times=times, params=dict(own), seeds=np.zeros(many, dtype=int),
            inputs={s: as_input(diagram, record, log, s) for s in piece.open_inputs} or None, signals=inside,
            progress=False,
        )  # fmt: skip
    for j, s in enumerate(found.given):
        if s in inside:
            values = np.where(run.ok[:, None], run.values[s], np.nan)
            out[:, 0, :, j] = values[:, ::2]
            out[:, 1, 0, j], out[:, 1, 1:, j] = values[:, 0], values[:, 1::2]
        else:
            table = as_input(diagram, record, log, s)
            out[:, 0, :, j] = log[s]
            out[:, 1, :, j] = until(log.t, table) if isinstance(table, tuple) else np.append(log[s][:1], log[s][:-1])
    return out


def _known_to(record: Record, signal: str) -> float:
    """Return the standard deviation of the rounding of a signal."""
    values = record.log[signal]
    return max(record.lattice(signal) / float(np.sqrt(12.0)), FINEST * float(np.nanmax(np.abs(values))), 1e-12)


def _each(own: Mapping[str, Floats], many: int) -> list[dict[str, float]]:
    return [{key: float(v[k if len(v) > 1 else 0]) for key, v in own.items()} for k in range(many)]


def _dotted(state: str) -> str:
    """Return block.name of a state that slopes call block[name]."""
    block, _, name = state.removesuffix("]").partition("[")
    return f"{block}.{name}"


def _block(key: str) -> str:
    return key.rpartition(".")[0]


def _digest(diagram: Diagram, names: Sequence[str]) -> tuple[object, ...]:
    blocks = [diagram[name] for name in names]
    return tuple(
        (
            b.name,
            type(b).__name__,
            tuple(b.input_labels),
            tuple(b.output_labels),
            b.p.tobytes(),
            b.x0.tobytes(),
            b.d0.tobytes(),
        )
        for b in blocks
    )
