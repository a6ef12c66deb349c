"""What the residuals of a record are without a gap, found by simulating the model itself: scales, colours, scores.

    r_k   residuals of row k: the offsets themselves where they keep their level, else their changes
    e_k = L^-1 (r_k - sum_j A_j r_(k-j))            innovations: white, of unit variance, without a gap
    F   = sum over rows and signals of (nu + 1)/2 ln(1 + (e/c)^2/nu)                    (Student's t, nu = 4)

Runs of the model with its own nuisances, with the record's set points, rows and rounding, give A_j and L, and how large
F is without a gap.  The logarithm counts how many residuals are as without a gap: a slip that is missed costs little.

Where loads are not measured the residuals are coloured, and the A_j make of them what a Kalman filter of the same model
would give; where sensor noise and rounding are all there is, no A_j is needed and none is used.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.ensembles.running import ensemble
from stickslip.engine.run import Settings
from stickslip.gap.insertion.paths import made_of
from stickslip.gap.insertion.scales import time_scale
from stickslip.gap.records.offsets import offsets
from stickslip.gap.records.record import GapError, Record
from stickslip.logs import Log
from stickslip.logs.arrays import Values

NU = 4.0
UNIT = 0.8310  # of the loss: with it a normal innovation of standard deviation 1 has the loss least at its own size
SKIPPED = 0.02  # share of the record at its beginning that is not scored: what the start leaves has died away
FEWEST_SKIPPED = 20
SETTLING = 10.0  # time scales until a start is forgotten
ORDER = 24  # rows that a prediction of the residuals may look back
WORTH = 0.5  # nats a row that predicting residuals must gain to be done
GROWTH = 1.5  # a level whose variance grows by this between the thirds of a record has none
SMALLEST = 1e-12
EXACT = Settings(rtol=1e-8, atol=1e-11)  # of runs of a large diagram, whose rows lie inside long steps: see ``_exact``
LARGEST = 1e9  # loss
NUMERICAL = 1e-7  # of a signal's range: what is left of a start after ten time scales is below it
MECHANICAL = 1e-4  # share of its travel to which a stem's position is known
FORETOLD = 3e-3  # share of its range to which laws of friction (Coulomb's, Stribeck's) agree on what a stem drives
SILENT = 3.0  # of the least scale of a signal: what a model without noise leaves of its own rounded runs


@dataclass(frozen=True, eq=False)
class NullModel:
    """Residuals without a gap.

    ``changes`` (signals,) whether the change of an offset is the residual; ``A`` (order, signals, signals); ``L``
    (signals, signals); ``skipped`` rows; ``scores`` (runs,) of F without a gap, sorted, each over ``rows`` rows.
    """

    changes: NDArray[np.bool_]
    A: Values
    L: Values
    skipped: int
    scores: Values
    rows: int

    def innovations(self, found: Values) -> Values:
        """Return e of offsets (..., rows, signals): (..., rows - skipped, signals); NaN where a row says nothing."""
        return whitened(residuals(found, self.changes), self.A, self.L)[..., self.skipped :, :]

    @property
    def mean(self) -> float:
        """Mean score F without a gap, for each row that is scored."""
        return float(self.scores.mean()) / self.rows

    @property
    def sd(self) -> float:
        """Standard deviation of the score F without a gap, over the square root of the rows."""
        return float(self.scores.std(ddof=1) / np.sqrt(self.rows))

    @property
    def coloured(self) -> bool:
        """Whether residuals are predicted from earlier ones: there are loads that nobody measures."""
        return len(self.A) > 0


def residuals(found: Values, changes: NDArray[np.bool_]) -> Values:
    """Return offsets or their changes, signal by signal; the first change is NaN."""
    moved = np.full_like(found, np.nan)
    moved[..., 1:, :] = np.diff(found, axis=-2)
    return np.where(changes, moved, found)


def whitened(r: Values, A: Values, L: Values) -> Values:
    """Return the innovations of residuals; unknown earlier residuals count as 0."""
    known = np.nan_to_num(r)
    e = r.copy()
    for j, a in enumerate(A, start=1):
        e[..., j:, :] -= known[..., :-j, :] @ a.T
    return e @ np.linalg.inv(L).T if np.count_nonzero(L - np.diag(np.diag(L))) else e / np.diag(L)


def losses(e: Values) -> Values:
    """Return the loss of every innovation, 0 where it is unknown."""
    with np.errstate(over="ignore"):  # a square beyond all numbers has the largest loss
        loss = 0.5 * (NU + 1.0) * np.log1p((e / UNIT) ** 2 / NU)
    return np.asarray(np.minimum(np.where(np.isnan(loss), 0.0, loss), LARGEST))


def scored(e: Values) -> Values:
    """Return F of innovations (..., rows, signals); infinite where hardly any is known."""
    if not e.shape[-2]:  # the first part of a short record is all settling
        return np.full(e.shape[:-2], np.inf)
    share = np.isfinite(e).mean(axis=(-2, -1))
    return np.where(share > 0.01, losses(e).sum(axis=(-2, -1)), np.inf)


def without_gap(
    model: Diagram, record: Record, runs: int, seed: int, inputs: Mapping[str, Block] | None = None
) -> list[Log]:
    """Return logs of the model with its nuisances, as the record's system would have written them.

    ``seed``: the first of ``runs`` consecutive seeds; ``inputs``: what drives the model, as the record has it unless
    given.
    """
    log, played = record.log, {s: record.log[s] for s in record.played}
    found, logs = unrounded(model, record, runs, seed, inputs), []
    for i in range(len(next(iter(found.values()), ()))):
        values = record.rounded({s: runs_of[i] for s, runs_of in found.items()})
        quality = {s: log.good(s) for s in found}
        logs.append(Log(log.t, {**played, **values}, quality=quality))
    return logs


def unrounded(
    model: Diagram, record: Record, runs: int, seed: int, inputs: Mapping[str, Block] | None = None
) -> dict[str, Values]:
    """Return what runs of the model with its nuisances have at the record's rows, (runs that succeed, rows)."""
    log, driven = record.log, [*record.pinned, *record.used]
    many = ensemble(
        model,
        log.duration,
        t0=float(log.t[0]),
        times=log.t,
        inputs=(inputs or _played(record)) if record.played else None,
        seeds=np.arange(seed, seed + runs),
        signals=driven,
        progress=False,
        settings=_exact(record),
    )
    ok = np.flatnonzero(many.ok)
    return {s: many.values[s][ok] for s in driven}


def undisturbed(quiet: Diagram, record: Record) -> Log:
    """Return the log of a silent model that is driven as the record's system was, not rounded."""
    log, driven = record.log, [*record.pinned, *record.used]
    run = ensemble(
        quiet, log.duration, t0=np.full(1, log.t[0]), times=log.t, inputs=_played(record) if record.played else None,
        signals=driven, progress=False, settings=_exact(record),
    )  # fmt: skip
    return Log(log.t, {**{s: log[s] for s in record.played}, **{s: run.values[s][0] for s in driven}})


def _exact(record: Record) -> Settings:
    """Return how exact runs of a model are.

    Those of a large diagram are as exact as no log is: where the program steps over many rows, the curve that it draws
    through them behind a switch of a set point was off by 2 % of a torque at the usual tolerance.
    """
    return Settings() if record.filter is None else EXACT


def _played(record: Record) -> Mapping[str, Block] | Log:
    """Return what drives the inputs of a run as the record's system was driven.

    In a large diagram a set point is written where it switches only, at which a run has to stop, and not at each row.
    """
    log = record.log
    if record.filter is None and not record.leads and not record.ramps:
        return Log(log.t, {s: log[s] for s in record.played})
    return {s: record.source(s) for s in record.played}


def skipped_rows(rows: int, settling: float = 0.0) -> int:
    """Return how many rows at the beginning of a record are not scored: ``settling`` rows until its start is forgotten.

    At least a fiftieth of the record, at most a tenth.
    """
    return min(max(FEWEST_SKIPPED, int(SKIPPED * rows), min(int(settling), rows // 10)), rows // 2)


def settling_rows(model: Diagram, record: Record) -> float:
    """Return after how many rows of a record the start is forgotten: ten times the time scale of the loop."""
    times = [time_scale(model, block.name) for block in model.blocks if block.role is Role.PROCESS]
    return SETTLING * float(np.median(times)) / record.log.dt if times else 0.0


def null_model_of(
    found: Values,
    settling: float = 0.0,
    integrating: Sequence[bool] = (),
    steady: bool = False,
    least: Sequence[float] = (),
) -> NullModel:
    """Return the null model of the offsets of runs without a gap, (runs, rows, signals).

    ``integrating``: signals whose changes are the residuals in any case; ``steady``: all others have a level;
    ``least`` scale of each signal's residuals [its unit], where a model is sharper than its plant can be.
    """
    skipped = skipped_rows(found.shape[1], settling)
    changes = np.array(integrating or [False] * found.shape[-1])
    if not steady:
        changes |= _drifting(found[:, skipped:])
    r = residuals(found, changes)[:, skipped:]
    A, L = _predictor(r, np.array(least or [SMALLEST] * found.shape[-1]))
    scores = np.sort(scored(whitened(r, A, L)))
    return NullModel(changes, A, L, skipped, scores, r.shape[1])


def _drifting(found: Values) -> NDArray[np.bool_]:
    """Tell which signals have no level without a gap: their offsets wander ever farther."""
    third = max(found.shape[1] // 3, 1)
    early = np.nanmean((found[:, :third] - np.nanmedian(found[:, :1], axis=0)) ** 2, axis=(0, 1))
    late = np.nanmean((found[:, -third:] - np.nanmedian(found[:, :1], axis=0)) ** 2, axis=(0, 1))
    return np.asarray(late > GROWTH * np.maximum(early, SMALLEST**2))


def _predictor(r: Values, least: Values) -> tuple[Values, Values]:
    """Return (A, L) of residuals without a gap, (runs, rows, signals), whose scales are at least so large."""
    m = r.shape[-1]
    flat = np.nan_to_num(r).reshape(-1, m)
    own, least = np.sqrt(np.mean(flat**2, axis=0)), np.maximum(least, SMALLEST)
    still, plain = own < least, np.maximum(own, least)  # what is still by itself needs no prediction
    none = np.zeros((0, m, m)), np.diag(plain)
    rows = r.shape[1]
    if rows <= 3 * ORDER or still.all():  # a model without noise foretells its own runs to the last digit
        return none
    scaled = np.nan_to_num(r) / plain
    past = np.concatenate([scaled[:, ORDER - j : rows - j] for j in range(1, ORDER + 1)], axis=-1).reshape(
        -1, m * ORDER
    )
    now = scaled[:, ORDER:].reshape(-1, m)
    G = past.T @ past
    C = np.linalg.solve(G + 1e-9 * np.trace(G) / len(G) * np.eye(len(G)), past.T @ now)
    left = now - past @ C
    S = left.T @ left / len(left)
    S[still, still] = 1.0
    gain = -0.5 * np.linalg.slogdet(S + 1e-12 * np.eye(m))[1]
    if gain < WORTH:
        return none
    A = np.stack([(C[m * j : m * (j + 1)].T * plain[:, None]) / plain for j in range(ORDER)])
    return A, np.linalg.cholesky((S + 1e-12 * np.eye(m)) * plain[:, None] * plain)


def usual_runs(model: Diagram, record: Record, runs: int, seed: int) -> list[Log]:
    """Return logs without a gap (``without_gap``). Raises ``GapError`` if no run comes to its end."""
    logs = without_gap(model, record, runs, seed)
    if not logs:
        raise GapError(
            f"none of {runs} runs of the model over the times of the log came to its end, so nothing says what is "
            "usual; simulate the model alone with the log's inputs, and mend what stops it"
        )
    return logs


def measured(model: Diagram, quiet: Diagram, record: Record, runs: int, seed: int) -> tuple[NullModel, list[Log]]:
    """Return the null model of a diagram for records like this one, and the logs of the runs that gave it."""
    logs = usual_runs(model, record, runs, seed)
    found = offsets(quiet, record, logs=logs)
    # The integral of a controller runs on freely, and a stem that sticks stays where its last slip has left it: their
    # level says nothing, however well the model keeps it.
    integrating = [model.blocks[model.driven[s][0]].role in (Role.CONTROLLER, Role.VALVE) for s in record.pinned]
    least = [sharpest(model, record, s) for s in record.pinned]
    left = np.sqrt(np.nanmean(found**2, axis=(0, 1)))
    least = [
        max(sharp, foretold(model, record, s)) if own <= SILENT * sharp else sharp
        for s, sharp, own in zip(record.pinned, least, left.tolist(), strict=True)
    ]
    return null_model_of(found, settling_rows(model, record), integrating, least=least), logs


def sharpest(model: Diagram, record: Record, signal: str) -> float:
    """Return the least scale that residuals of a signal are judged by [its unit].

    The log's rounding, of which a model that only hands a signal on shows nothing; where it is not rounded the last
    digits that a simulation and a start are good for; and of a valve, whose stem no law foretells to the last digit of
    a log, a ten-thousandth of the travel.
    """
    rounding, ranged = record.steps[signal] / float(np.sqrt(12.0)), _ranged(record.known(signal))
    if model.blocks[model.driven[signal][0]].role is Role.VALVE:
        low, high = model.signal_spans.get(signal, (0.0, ranged))
        return max(rounding, NUMERICAL * ranged, MECHANICAL * (high - low))
    return max(rounding, NUMERICAL * ranged)


def foretold(model: Diagram, record: Record, signal: str) -> float:
    """Return to what a signal can be foretold by a model without noise [its unit]: 0 for one that no valve drives.

    Laws of friction with one S and J slip in times of their own and lag by viscosities of their own, so what a valve
    drives is not judged finer than by three thousandths of its range.
    """
    drivers = [model.blocks[model.driven[s][0]].role for s in made_of(model, signal) if s in model.driven]
    driven = Role.VALVE in drivers and drivers[0] is not Role.VALVE
    return FORETOLD * _ranged(record.known(signal)) if driven else 0.0


def _ranged(known: Values) -> float:
    """Return how far a signal ranges as the nearest power of two: records alike have one null model."""
    far = float(np.ptp(known))
    return 2.0 ** round(math.log2(far)) if far > 0.0 else 0.0
