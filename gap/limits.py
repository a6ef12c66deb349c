"""Fit limits of a signal: they lie within the range that the record has seen, or leave no trace.

Each limit is tried at the ends of the range and at some quantiles of the signal, the other one nominal; then both.
"""

import math

import numpy as np
from numpy.typing import NDArray

from gap.ranges import between
from gap.search import Candidate, Fit, best_of

Floats = NDArray[np.float64]
QUANTILES = (1.0, 0.995, 0.98, 0.94, 0.85, 0.7, 0.5)  # of the signal, at which an upper limit is tried
SETTLED = 0.2  # nats that an interpolated limit must promise to be tried


def fitted_limits(candidate: Candidate) -> Fit | None:
    """Return the best fit of two limits; None if no run succeeded."""
    seen = reached(candidate)
    best: Fit | None = candidate.absent
    for name in ("high", "low"):
        if best is None:
            return None
        values = dict(best.values)
        quantiles = QUANTILES if name == "high" else [1.0 - q for q in QUANTILES]
        grid = np.unique(np.quantile(seen, quantiles))
        fits = [f for f in candidate.tried([{**values, name: float(v)} for v in grid]) if math.isfinite(f.F)]
        if len(fits) > 1:
            size, F = between(fits, name)
            if min(fit.F for fit in fits) - SETTLED > F:
                fits += candidate.tried([{**values, name: size}])
        best = best_of([best, *fits])
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
