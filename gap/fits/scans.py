"""Fit the scan of a controller: its output changes at scans only, so the log shows period and first scan.

Rows at which OP is new lie less than one interval behind a scan: t_i - dt < offset + k_i P <= t_i.  P is the slope of
t_i over k_i; of the offsets that this leaves the ends and the middle are tried, with either way of integrating.
"""

from collections.abc import Iterator

import numpy as np
from stickslip.logs.arrays import Values

STILL = 0.05  # share of rows at which OP stands still, from which on its scans can be read off
# periods in intervals of the log that are tried where they cannot
FASTER = (0.1, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.9, 1.0)
COMBED, CLOSE = 200, 0.1  # rows at which OP moves that are looked at first; how far they may lie off, in periods
LONGEST = 50.0  # period, in rows
OTHERS = (1.0, 2.0, 3.0, 4.0, 6.0, 8.0)  # and where the controller scans already, in its own period


def first_scans(
    t: Values, values: Values, own: float, dt: float, bounds: tuple[float, float]
) -> list[dict[str, float]]:
    """Return the scans to try first: as the values of OP at ``t`` show them, or else faster than rows ``dt`` [s] apart.

    And multiples of a controller's ``own`` period, where it scans already; all within the bounds of a period.
    """
    guesses = read_off(t, values) if len(t) else []
    if own > 0.0:
        guesses += [(own * factor, 0.0) for factor in OTHERS]
    elif not guesses:
        guesses = [(dt * factor, 0.0) for factor in FASTER]
    low, high = bounds
    return [
        {"period": float(period), "offset": float(offset % period), "present": present}
        for period, offset in guesses
        if min(low, dt * FASTER[0]) <= period <= high
        for present in (1.0, 0.0)
    ]


def read_off(t: Values, values: Values) -> list[tuple[float, float]]:
    """Return (period, first scan) read from the stretches of equal values; None if values are always new.

    >>> read_off(np.arange(9.0), np.array([0.0, 1, 1, 1, 1, 2, 2, 2, 2]))
    []
    >>> [(round(P, 6), round(first, 6)) for P, first in read_off(np.arange(40.0), np.arange(40.0) // 4)]
    [(4.0, 0.0), (4.0, 3.5), (4.0, 3.001)]
    >>> round(read_off(np.arange(400.0), np.arange(400.0) // 1.8)[0][0], 3)
    1.8
    """
    moved = np.flatnonzero(np.diff(values) != 0.0) + 1
    if len(moved) < 5 or len(moved) > (1.0 - STILL) * len(values):
        return []
    at = t[moved]
    dt = float(np.median(np.diff(t)))
    guesses = (float(np.median(np.diff(at))), float((at[-1] - at[0]) / (len(at) - 1)))
    period = min((_settled(at, one, dt) for one in guesses), key=lambda one: _spread(at, one))
    if _spread(at, period) > dt:  # a coarse log does not show all scans
        period = next((one for one in _combs(at, dt) if _spread(at, one) <= dt), period)
    k = np.round((at - at[0]) / period)
    latest = round(float(np.quantile(at - k * period, 0.02)), 9)
    earliest = min(float(np.quantile(at - k * period, 0.98)) - dt, latest)
    first = [latest, 0.5 * (latest + earliest), earliest + 1e-3 * dt]
    return [(period, float(one % period)) for one in first]


def _combs(at: Values, dt: float) -> Iterator[float]:
    """Yield periods, the longest first, of which some of the times are multiples but for one row ``dt`` [s]."""
    few = at[:COMBED] - at[0]
    frequencies = np.arange(1.0 / LONGEST, 1.0, 0.1 * dt / max(float(few[-1]), dt)) / dt
    phases = np.sort((few * frequencies[:, None]) % 1.0, axis=1)
    gaps = np.diff(np.concatenate([phases, phases[:, :1] + 1.0], axis=1), axis=1)
    beyond = 1.0 - gaps.max(axis=1) - dt * frequencies
    best = np.r_[np.inf, beyond, np.inf]
    for k in np.flatnonzero((beyond < CLOSE) & (beyond <= best[:-2]) & (beyond <= best[2:])):
        yield _settled(at, float(1.0 / frequencies[k]), dt)


def _settled(at: Values, period: float, dt: float) -> float:
    """Return the slope of the times over the number of the scan, whole rows where it nearly is."""
    for _ in range(4):
        k = np.round((at - at[0]) / period)
        new = float(np.polyfit(k, at, 1)[0])
        if abs(new - period) < 1e-9:
            break
        period = new
    for digits in range(4):  # a scan that meets a row now and then does so exactly
        plain = dt * round(period / dt, digits)
        if plain > 0.0 and _spread(at, plain) < dt * (1.0 - 1e-6):
            return float(plain)
    return period


def _spread(at: Values, period: float) -> float:
    """Return how far the times lie from a comb of the period [s]: less than a row if it is right."""
    off = at - np.round((at - at[0]) / period) * period
    return float(np.ptp(off))
