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
from diagram.linear.slopes import Slopes, slopes
from diagram.pins import replays
from gap.floor import Floor, floor_of, losses, residuals, settling_rows, without_gap
from gap.linearised.between import BEFORE, as_input, until
from gap.linearised.kalman import Sampled, gain, innovations, noise, sampled
from gap.linearised.parts import Parts, ancestors, parts
from gap.model import nuisances
from gap.offsets import known_starts
from gap.record import Record
from logs import Log

Floats = NDArray[np.float64]
FINEST = 1e-6  # of a signal's size: what a signal that is not rounded is known to
MISSED = 1e-5  # of a state's size: what a linear model misses in one second
MOVES, NEAR = 3, 1e-3  # how often a process is moved to where the log is, and how near is enough, of each signal
SIGMAS = 4.5  # by which a segment's loss may exceed its mean without a gap
BESIDE = 0.02  # of an input: how far from the model's own its mean may be to be linear about the same point
KEPT = 4000  # results that are remembered
LEAST = 1e-3  # size of a state that starts at less


@dataclass(frozen=True, eq=False)
class Filter:
    """The filter of a model for records of one kind: its ``parts``, the gain ``K``, the unit of innovations.

    ``at`` the inputs of the process, ``start`` its states, about which it is linear; ``loads`` those that nobody
    measures, signal -> (standard deviation, correlation time [s]); ``root`` (outputs, outputs) makes innovations white;
    ``expected`` (rows, signals) what is left on average without a gap, since the process is not quite linear; ``usual``
    (3, signals) unit, mean and standard deviation of the loss of each signal's residuals then.
    """

    parts: Parts
    at: Mapping[str, float]
    start: Mapping[str, float]
    loads: Mapping[str, tuple[float, float]]
    size: Mapping[str, float]
    dt: float
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
        found = parts(diagram, replace(record, pinned=(*self.parts.known, *self.parts.measured)))
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
        own = {key: v for key, v in given.items() if _block(key) in found.rest}
        for k, values in enumerate(_each(own, many)):
            e = self._innovations(diagram, found, values, fed[k], y)
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

    def beside(self, signal: str, mean: float) -> float:
        """Return the value of an input about which the process is linear: the model's own while it is about that."""
        if signal not in self.at:
            return 0.0
        own = self.at[signal]
        unit = BESIDE * max(abs(own), LEAST)
        return own + unit * round((mean - own) / unit)

    def _innovations(self, diagram: Diagram, found: Parts, values: Mapping[str, float], u: Floats, y: Floats) -> Floats:
        # What the model alone has not is a planned load, which is added: its level changes no slope.
        at = np.array([self.beside(s, m) for s, m in zip(found.given, u[0].mean(axis=0).tolist(), strict=True)])
        shown = np.nanmean(y, axis=0)
        key = "rest", _digest(diagram, found.rest), found.given, tuple(values.items()), at.tobytes(), shown.tobytes()
        if key not in self.known:
            if len(self.known) > KEPT:
                self.known.clear()
            piece = part(diagram, found.rest, "rest").with_params(dict(values))
            inputs = dict(zip(found.given, at.tolist(), strict=True))
            local = near(piece.starting_at(known_starts(piece, self.start)), found, inputs, shown)
            self.known[key] = _linear(local, found, self.loads, self.dt)
        model, states = self.known[key]
        K = np.zeros((len(states), len(found.measured)))
        own = {name: i for i, name in enumerate(self.size)}
        for i, name in enumerate(states):
            if name in own:
                K[i] = self.K[own[name]]
        e = innovations(model, K, u[0] - at, u[1] - at, y, np.zeros(len(states)))
        return np.asarray(e @ self.root.T)


def filter_of(model: Diagram, quiet: Diagram, record: Record) -> Record | None:
    """Return the record with the filter of a model, and the signals that it judges; None where replays do better.

    It is for models whose loads wander and whose controllers do not scan.
    """
    wandering = {one.block: (one.sd, one.correlation_time) for one in nuisances(model) if one.correlation_time > 0.0}
    scanning = any(block.sampled and block.role is Role.CONTROLLER for block in model.blocks)
    if not wandering or scanning:
        return None
    found = parts(quiet, record)
    loads = {str(quiet[name].output_labels[0]): told for name, told in wandering.items() if name in found.rest}
    if not found.measured or not loads:
        return None
    dt = float(np.median(np.diff(record.log.t)))
    u = driven(quiet, found, record, record.log, {}, 1)[0, 0]
    at = dict(zip(found.given, u.mean(axis=0).tolist(), strict=True))
    shown = np.array([np.nanmean(record.log[s]) for s in found.measured])
    local = near(part(quiet, found.rest, "rest"), found, at, shown)
    one, states = _linear(local, found, loads, dt)
    A, Q, size = _spread(local, loads)
    start = {f"{b}.{x}": float(v) for s, v in zip(local.states, local.x, strict=True) for b, x in [s[:-1].split("[")]}
    R = np.diag([_known_to(record, s) ** 2 for s in found.measured])
    K, S = gain(one.F, one.C, noise(A, Q, dt), R)
    root = np.linalg.inv(np.linalg.cholesky(S))
    judged = tuple(s for s in record.pinned if s in (*found.measured, *found.judged))
    return replace(
        record,
        pinned=judged,
        used=tuple(s for s in record.pinned if s not in judged),
        filter=Filter(found, at, start, loads, dict(zip(states, size, strict=True)), dt, K, root),
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


def near(piece: Diagram, found: Parts, at: Mapping[str, float], shown: Floats) -> Slopes:
    """Return the slopes of a process where it shows what the log shows on average, as little moved as that takes."""
    closed = close(piece, {s: at[s] for s in piece.open_inputs})
    local = slopes(closed)
    for _ in range(MOVES):
        rows = [local.signals.index(s) for s in found.measured]
        unit = np.maximum(np.abs(shown), LEAST)
        off = (shown - local.s[rows]) / unit
        if np.abs(off).max() < NEAR:
            break
        size = np.maximum(np.abs(local.x), LEAST)
        C = local.joined()[2][rows] * size / unit[:, None]
        local = slopes(closed.at_state(local.x + size * np.linalg.lstsq(C, off, rcond=1e-6)[0]))
    return local


def _linear(
    local: Slopes, found: Parts, loads: Mapping[str, tuple[float, float]], dt: float
) -> tuple[Sampled, tuple[str, ...]]:
    """Return a process from row to row, in deviations from where its slopes are, in sizes, and its states."""
    A, B, c, C, D, g, states, _ = _scaled(local, found.given, found.measured, loads)
    return sampled(A, B, c, C, D, g, dt), states


def _scaled(
    local: Slopes, given: Sequence[str], measured: Sequence[str], loads: Mapping[str, tuple[float, float]]
) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats, tuple[str, ...], Floats]:
    """Return A, B, c, C, D, g of a process with its loads as states behind its own; names and sizes of states."""
    A, B, C, D = local.joined()
    place = {s: i for i, s in enumerate(local.signals)}
    size = np.maximum(np.abs(local.x), LEAST)
    v, w = [place[s] for s in given], [place[s] for s in loads]
    rows = [place[s] for s in measured]
    n, m = len(size), len(w)
    whole = np.zeros((n + m, n + m))
    whole[:n, :n] = A * size / size[:, None]
    sd = np.array([spread for spread, _ in loads.values()])
    whole[:n, n:] = B[:, w] * sd / size[:, None]
    whole[n:, n:] = -np.diag([1.0 / time for _, time in loads.values()])
    drives = np.vstack([B[:, v] / size[:, None], np.zeros((m, len(v)))])
    shows = np.hstack([C[rows] * size, D[np.ix_(rows, w)] * sd])
    c = np.concatenate([local.rates / size, np.zeros(m)])
    states = (*local.states, *(f"{s}[load]" for s in loads))
    return whole, drives, c, shows, D[np.ix_(rows, v)], local.s[rows], states, np.concatenate([size, sd])


def _spread(local: Slopes, loads: Mapping[str, tuple[float, float]]) -> tuple[Floats, Floats, Floats]:
    """Return A, the density of the noise that moves the states, and their sizes."""
    A, *_, states, size = _scaled(local, (), (), loads)
    Q = MISSED**2 * np.eye(len(states))
    for k, (_, time) in enumerate(loads.values()):
        j = len(states) - len(loads) + k
        Q[j, j] = 2.0 / time
    return A, Q, size


def _known_to(record: Record, signal: str) -> float:
    """Return the standard deviation of the rounding of a signal."""
    values = record.log[signal]
    return max(record.lattice(signal) / float(np.sqrt(12.0)), FINEST * float(np.nanmax(np.abs(values))), 1e-12)


def _each(own: Mapping[str, Floats], many: int) -> list[dict[str, float]]:
    return [{key: float(v[k if len(v) > 1 else 0]) for key, v in own.items()} for k in range(many)]


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
