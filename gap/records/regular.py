"""A log as a diagnosis needs it: inputs that hold between the rows that name them, rows that are missing put in.

A historian that keeps a set point only when it changes leaves the rows between without one; it held.  A log without
some of its rows, or with rows at uneven whole multiples of an interval, is one with rows of that interval in which
nothing was logged.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.logs import Log

OFF = 1e-3  # of the interval, by which rows may lie off even times
MOST = 6.0  # times as many rows as logged: with more, nearly nothing is known


def with_inputs_held(log: Log, inputs: Sequence[str]) -> Log:
    """Return the log with missing values of some signals replaced by the last good ones before, at first the next.

    >>> import numpy as np
    >>> log = with_inputs_held(Log([0, 1, 2, 3], {"SP": [np.nan, 5.0, np.nan, 7.0]}), ["SP"])
    >>> log["SP"].tolist(), log.notes
    ([5.0, 5.0, 5.0, 7.0], ('SP is logged in 2 of 4 rows and taken as held in between.',))
    """
    for s in inputs:
        good = log.good(s)
        if good.all() or not good.any():
            continue
        before = np.maximum.accumulate(np.where(good, np.arange(len(log)), -1))
        values = log[s][np.where(before < 0, int(np.argmax(good)), before)]
        note = f"{s} is logged in {int(good.sum())} of {len(log)} rows and taken as held in between."
        quality = {name: mask for name, mask in log.quality.items() if name != s}
        log = replace(log, signals={**log.signals, s: values}, quality=quality, notes=(*log.notes, note))
    return log


def with_rows_filled(log: Log, inputs: Sequence[str], period: float = 0.0) -> Log:
    """Return a log whose rows lie on even times, with rows of nothing in between; as it is where they do already, or
    lie on none.

    ``period`` [s] of the model's scans: rows that are no multiples of their usual interval may lie on these.

    >>> log = with_rows_filled(Log([0, 1, 2, 5], {"PV": [1.0, 2.0, 3.0, 4.0]}), [])
    >>> log.t.tolist(), log["PV"].tolist()
    ([0.0, 1.0, 2.0, 3.0, 4.0, 5.0], [1.0, 2.0, 3.0, nan, nan, 4.0])
    """
    steps = np.diff(log.t)
    if float(np.ptp(steps)) <= OFF * log.dt:
        return log
    for dt in (log.dt, _coarsest(steps, period)):
        if dt <= 0.0:
            continue
        k = np.round((log.t - log.t[0]) / dt).astype(np.int64)
        uneven = np.abs(log.t - log.t[0] - k * dt).max() > OFF * dt
        if uneven or np.any(np.diff(k) < 1) or k[-1] + 1 > MOST * len(log):
            continue
        return _spread(log, k, dt, inputs)
    return log


def without_unsettled(log: Log, inputs: Sequence[str], signals: Sequence[str], settling: int) -> Log:
    """Return the log without ``settling`` rows of ``signals`` behind each hole in which an input changed.

    Nobody knows when, nor what the loop did since; once it has settled it has forgotten.

    >>> import numpy as np
    >>> log = Log([0, 1, 2, 3, 4], {"SP": [1, 1, 2, 2, 2], "PV": [1, np.nan, 2, 2, 2]})
    >>> without_unsettled(log, ["SP"], ["PV"], 2).good("PV").tolist()
    [True, False, False, False, True]
    """
    seen = np.any([log.good(s) for s in signals], axis=0)
    moved = np.any([np.diff(log[s]) != 0.0 for s in inputs], axis=0) if inputs else np.zeros(len(log) - 1, dtype=bool)
    behind = np.flatnonzero(moved & ~seen[:-1]) + 1
    if not len(behind):
        return log
    lost = np.zeros(len(log), dtype=bool)
    for k in behind:
        lost[k : k + settling] = True
    note = (
        f"{int((lost & seen).sum())} rows behind gaps in which an input changed are left out: the loop had to settle."
    )
    quality = {**log.quality, **{s: log.good(s) & ~lost for s in signals}}
    return replace(log, quality=quality, notes=(*log.notes, note))


def _coarsest(steps: NDArray[np.float64], period: float) -> float:
    """Return the longest multiple of a period of which all steps are multiples, 0 for none."""
    if period <= 0.0:
        return 0.0
    whole = np.round(steps / period).astype(np.int64)
    if np.abs(steps - whole * period).max() > OFF * period:
        return 0.0
    return period * float(np.gcd.reduce(whole))


def _spread(log: Log, k: NDArray[np.int64], dt: float, inputs: Sequence[str]) -> Log:
    """Return the log with row i at k_i intervals ``dt`` from the first, the others empty but for held inputs."""
    n = int(k[-1]) + 1
    last = np.searchsorted(k, np.arange(n), side="right") - 1
    signals, quality = {}, {}
    for s in log.names:
        there = np.zeros(n, dtype=bool)
        there[k] = log.good(s)
        if s in inputs:
            signals[s] = log[s][last]
        else:
            signals[s] = np.full(n, np.nan)
            signals[s][k] = log[s]
            quality[s] = there
    note = f"{n - len(log)} rows that would make the log even, {dt:g} s apart, are not there and count as not logged."
    return Log(log.t[0] + dt * np.arange(n), signals, log.units, log.spans, quality, log.origin, log.start,
               (*log.notes, note), log.loops)  # fmt: skip
