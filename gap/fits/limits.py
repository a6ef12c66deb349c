"""Fit limits of a signal: they lie within the range that the record has seen, or leave no trace.

Each limit is tried at the ends of the range and at some quantiles of the signal, the other one nominal; then both.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.role import Role
from stickslip.gap.fits.adequacy import needed, stands
from stickslip.gap.fits.ranges import between
from stickslip.gap.fits.search import Candidate, Fit, best_of

Floats = NDArray[np.float64]
QUANTILES = (1.0, 0.995, 0.98, 0.94, 0.85, 0.7, 0.5)  # of the signal, at which an upper limit is tried
ZOOMS, BETWEEN = 3, 6  # times that a grid between the neighbours of the best limit is tried, and its points
SETTLED = 0.2  # nats that an interpolated limit must promise to be tried
STANDS = 5  # rows at which a record that begins at a limit stands there
HINT = 0.05  # share of the gap that a limit of a grid takes away before its neighbourhood is looked at
NEAR = 1e-9  # of a signal: so near it stands
ROUNDS = 3  # in which the start of an integral is found


def fitted_limits(candidate: Candidate) -> Fit | None:
    """Return the best fit of two limits; None if no run succeeded."""
    seen = reached(candidate)
    best = _started_behind(candidate, seen) or candidate.absent
    candidate = best.candidate
    for name in ("high", "low"):
        values = dict(best.values)
        quantiles = QUANTILES if name == "high" else [1.0 - q for q in QUANTILES]
        grid = np.unique(np.quantile(seen, quantiles))
        fits = [f for f in candidate.tried([{**values, name: float(v)} for v in grid]) if math.isfinite(f.F)]
        if len(fits) > 1:
            size, F = between(fits, name)
            if min(fit.F for fit in fits) - SETTLED > F:
                fits += candidate.tried([{**values, name: size}])
        before, best = best, best_of([best, *fits]) or best
        if max(needed(candidate.problem), HINT * (before.F - candidate.problem.level)) < before.F - best.F:
            best = _zoomed(best, name, [float(v) for v in grid])
    return best if math.isfinite(best.F) else None


def _zoomed(fit: Fit, name: str, grid: Sequence[float]) -> Fit:
    """Return the best fit between the neighbours of a limit in a grid: the trough of its score may be narrow."""
    if fit.values[name] == fit.candidate.nominal[name] or stands(fit.candidate.problem, fit):
        return fit
    for _ in range(ZOOMS):
        at = fit.values[name]
        low = max((v for v in grid if v < at), default=at)
        high = min((v for v in grid if v > at), default=at)
        grid = np.linspace(low, high, BETWEEN + 2).tolist()
        fit = best_of([fit, *fit.candidate.tried([{**fit.values, name: v} for v in grid if v != at])]) or fit
    return fit


def _started_behind(candidate: Candidate, seen: Floats) -> Fit | None:
    """Return the fit of the limit at which a record begins, its controller started with the integral that it had.

    Such a record does not say how far behind the limit the integral is; the offset of the first row off it does.  None
    where the record begins elsewhere, or nothing is gained.
    """
    record, block = candidate.problem.record, candidate.base[candidate.place]
    signal = str(block.output_labels[0])
    if block.role is not Role.CONTROLLER or signal not in record.pinned or len(block.state_names) != 1:
        return None
    away = np.flatnonzero(np.abs(np.diff(record.log[signal])) > max(1.5 * record.lattice(signal), NEAR)) + 1
    if len(away) == 0 or away[0] < STANDS or seen[0] not in (seen.min(), seen.max()):
        return None
    key, k = f"{block.name}.{block.state_names[0]}", record.pinned.index(signal)
    limit = {"high" if seen[0] == seen.max() else "low": float(seen[0])}
    best = best_of(candidate.tried([limit]))
    for _ in range(ROUNDS):
        if best is None or candidate.effect is None:
            return None
        problem = best.candidate.problem
        settings = candidate.effect.settings(
            candidate.base, candidate.place, **{n: best.values[n] for n in candidate.own}
        )
        offset = float(problem.offsets(candidate.changed, settings)[0, away[0], k])
        start = problem.start.get(key, float(block.x0[0])) + offset
        moved = replace(candidate, problem=replace(problem, start={**problem.start, key: start}))
        found = best_of(moved.tried([best.values]))
        if found is None or found.F > best.F - SETTLED:
            break
        best = found
    return best


def reached(candidate: Candidate) -> Floats:
    """Return the logged values of what is limited, in the unit of the limits; an even grid where it is not logged."""
    effect, log = candidate.effect, candidate.problem.record.log
    block = candidate.base[candidate.place]
    percent = bool(effect and effect.parameters[0].unit.startswith("%"))
    for signal in [*map(str, block.output_labels), *map(str, block.input_labels)]:
        if signal in log:
            values = log[signal][log.good(signal)]
            low, high = candidate.base.signal_spans.get(signal, (0.0, 1.0))
            return np.asarray((values - low) / (high - low) * 100.0 if percent else values)
    low, high = candidate.bounds["low"][0], candidate.bounds["high"][1]
    return np.linspace(low, high, 50)
