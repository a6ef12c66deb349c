"""Fit the scan of a controller: its output changes at scans only, so the log shows period and first scan.

Rows at which OP is new lie less than one interval behind a scan: t_i - dt < offset + k_i P <= t_i.  P is the slope of
t_i over k_i; of the offsets that this leaves the ends and the middle are tried, with either way of integrating.
"""

import numpy as np
from numpy.typing import NDArray

from gap.search import Candidate, Fit, best_of

Floats = NDArray[np.float64]
STILL = 0.05  # share of rows at which OP stands still, from which on its scans can be read off
FASTER = (0.1, 0.2, 0.5, 1.0, 2.0)  # periods in intervals of the log that are tried where they cannot
OTHERS = (1.0, 2.0, 3.0, 4.0, 6.0, 8.0)  # and where the controller scans already, in its own period


def fitted_scan(candidate: Candidate) -> Fit | None:
    """Return the best fit of a scanning controller; None if no run succeeded."""
    log = candidate.problem.record.log
    signal = str(candidate.base[candidate.place].output_labels[0])
    own = candidate.nominal["period"]
    guesses = [(own * factor, 0.0) for factor in OTHERS] if own > 0.0 else [(log.dt * f, 0.0) for f in FASTER]
    if signal in log:
        good = log.good(signal)
        guesses = [*read_off(log.t[good], log[signal][good]), *guesses]
    low, high = candidate.bounds["period"]
    many = [
        {"period": float(period), "offset": float(offset % period), "present": present}
        for period, offset in guesses
        if min(low, log.dt * FASTER[0]) <= period <= high
        for present in (1.0, 0.0)
    ]
    return best_of(candidate.tried(many))


def read_off(t: Floats, values: Floats) -> list[tuple[float, float]]:
    """Return (period, first scan) that the stretches of equal values tell, none where values are always new.

    >>> read_off(np.arange(9.0), np.array([0.0, 1, 1, 1, 1, 2, 2, 2, 2]))
    []
    >>> [(round(P, 6), round(first, 6)) for P, first in read_off(np.arange(40.0), np.arange(40.0) // 4)]
    [(4.0, 0.0), (4.0, 3.5), (4.0, 3.001)]
    """
    moved = np.flatnonzero(np.diff(values) != 0.0) + 1
    if len(moved) < 5 or len(moved) > (1.0 - STILL) * len(values):
        return []
    at = t[moved]
    dt = float(np.median(np.diff(t)))
    period = float(np.median(np.diff(at)))
    for _ in range(4):
        k = np.round((at - at[0]) / period)
        new = float(np.polyfit(k, at, 1)[0])
        if abs(new - period) < 1e-9:
            break
        period = new
    if abs(period / dt - round(period / dt)) < 0.02:
        period = dt * round(period / dt)
    k = np.round((at - at[0]) / period)
    latest = float(np.quantile(at - k * period, 0.02))
    earliest = latest - dt
    first = [latest, 0.5 * (latest + earliest), earliest + 1e-3 * dt]
    return [(period, float(one % period)) for one in first]
