"""Damage that historians and networks do to clean signals, for tests and demonstrations; repeatable by seed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from stickslip.logs.arrays import Mask, Values
from stickslip.logs.errors import LogError
from stickslip.logs.log import Log

__all__ = ["bad_states", "drop_out", "jitter_time", "quantise", "swinging_door", "swinging_door_kept"]


def swinging_door_kept(t: npt.ArrayLike, values: npt.ArrayLike, deviation: float) -> Mask:
    """Which samples swinging-door compression archives.

    From the last archived point (t_a, y_a), two doors are held open by the slopes (y_i +- E - y_a)/(t_i - t_a);
    the sample before the one that closes them is archived at the value that the archive line has there.
    This variant archives measured samples only and checks that the line to the newest sample passes within the
    deviation E of every sample between, so that

        |line between archived samples - sample| <= E    at every sample.

    Parameters: ``t``, ``values`` ((n,) arrays [s], [unit of the signal]) Finite values over increasing time;
    ``deviation`` (float [unit of the signal]) E >= 0.

    Returns a bool array (n,), True for archived; the first and the last sample always are.

    Raises LogError if the deviation is negative or a value is missing.

    >>> swinging_door_kept([0, 1, 2, 3, 4], [0, 1, 2, 2, 2], deviation=0.1).tolist()
    [True, False, True, False, True]
    """
    given = np.asarray(values, dtype=float)
    if not deviation >= 0:
        raise LogError(f"deviation = {deviation!r} is negative; give it in the unit of the signal, >= 0")
    if not np.isfinite(given).all():
        raise LogError("a value is missing; compress the good stretches one by one")
    times, y = np.asarray(t, dtype=float).tolist(), given.tolist()  # plain numbers are three times as fast in a loop
    n = len(y)
    kept = np.zeros(n, dtype=bool)
    kept[[0, n - 1]] = True
    start = 0
    low, high = -np.inf, np.inf  # slopes of the lines from ``start`` that pass all samples so far
    for i in range(1, n):
        slope = (y[i] - y[start]) / (times[i] - times[start])
        if not low <= slope <= high:
            start = i - 1
            kept[start] = True
            low, high = -np.inf, np.inf
        run = times[i] - times[start]
        lowest, highest = (y[i] - deviation - y[start]) / run, (y[i] + deviation - y[start]) / run
        low = lowest if lowest > low else low
        high = highest if highest < high else high
    return kept


def swinging_door(log: Log, deviation: float | dict[str, float], names: Iterable[str] | None = None) -> Log:
    """The log as a historian gives it back after swinging-door compression, joined by straight lines.

    Parameters: ``deviation`` (float or dict of float [unit of the signal]) Largest error; one for all signals or one a
    signal; ``names`` (iterable of str, optional) Signals to compress, all (or those of the dict) if not given.

    Stretches of missing values stay missing. Raises LogError if a deviation is negative.

    >>> log = Log(t=[0, 1, 2, 3], signals={"PV": [0.0, 0.9, 2.1, 3.0]})
    >>> swinging_door(log, 0.2)["PV"]
    array([0., 1., 2., 3.])
    """
    if names is None:
        names = deviation if isinstance(deviation, dict) else log.names
    compressed: dict[str, Values] = {}
    for name in names:
        limit = deviation[name] if isinstance(deviation, dict) else deviation
        values = log[name].copy()
        finite = np.isfinite(values)
        edges = np.flatnonzero(np.diff(np.concatenate([[False], finite, [False]]).astype(np.int8)))
        for first, stop in zip(edges[::2], edges[1::2], strict=True):
            t, y = log.t[first:stop], values[first:stop]
            kept = swinging_door_kept(t, y, limit)
            values[first:stop] = np.interp(t, t[kept], y[kept])
        compressed[name] = values
    return _changed(log, compressed)


def quantise(log: Log, name: str, step: float) -> Log:
    """The log with the signal ``name`` rounded to multiples of ``step`` [its unit], as a coarse converter does.

    Raises LogError unless the step is positive.

    >>> quantise(Log(t=[0, 1], signals={"PV": [0.24, 0.26]}), "PV", 0.5)["PV"]
    array([0. , 0.5])
    """
    if not (np.isfinite(step) and step > 0):
        raise LogError(f"step = {step!r} is not positive; give the resolution in the unit of the signal")
    return _changed(log, {name: np.round(log[name] / step) * step})


def drop_out(log: Log, share: float, seed: int = 0, length: int = 1) -> Log:
    """The log without about ``share`` of its rows, lost in stretches of ``length`` samples.

    The first and the last row stay. Raises LogError if the share is not within 0 to 1.

    >>> len(drop_out(Log(t=range(100), signals={}), share=0.2, seed=1)) < 100
    True
    """
    lost = _stretches(len(log), share, length, seed)
    lost[[0, -1]] = False
    keep = np.flatnonzero(~lost)
    return replace(
        log,
        t=log.t[keep],
        signals={name: values[keep] for name, values in log.signals.items()},
        quality={name: mask[keep] for name, mask in log.quality.items()},
    )


def bad_states(log: Log, name: str, share: float, seed: int = 0, length: int = 5) -> Log:
    """The log with about ``share`` of the samples of ``name`` missing and of bad quality, in stretches.

    That is what a digital state ("Bad Input") in place of a number is read as.

    >>> log = bad_states(Log(t=range(50), signals={"PV": [1.0] * 50}), "PV", share=0.3)
    >>> bool(log.good("PV").all()), bool((log.good("PV") == ~(log["PV"] != log["PV"])).all())
    (False, True)
    """
    bad = _stretches(len(log), share, length, seed)
    good = log.good(name) & ~bad
    changed = _changed(log, {name: np.where(bad, np.nan, log[name])})
    return replace(changed, quality={**log.quality, name: good})


def jitter_time(log: Log, deviation: float, seed: int = 0) -> Log:
    """The log with each time stamp moved at random, evenly within +- ``deviation`` [s]; the values stay.

    Raises LogError unless 0 <= deviation < half the shortest step, which keeps the order.

    >>> jittered = jitter_time(Log(t=[0, 1, 2], signals={}), 0.2, seed=3)
    >>> bool((abs(jittered.t - [0, 1, 2]) <= 0.2).all())
    True
    """
    shortest = float(np.diff(log.t).min()) if len(log) > 1 else np.inf
    if not 0 <= deviation < 0.5 * shortest:
        raise LogError(
            f"deviation = {deviation!r} s must be from 0 to below half the shortest step ({0.5 * shortest:g} s), "
            "or rows would change places"
        )
    moved = np.random.default_rng(seed).uniform(-deviation, deviation, len(log))
    return replace(log, t=log.t + moved)


def _stretches(n: int, share: float, length: int, seed: int) -> Mask:
    if not 0 <= share <= 1:
        raise LogError(f"share = {share!r} is not within 0 to 1")
    if length < 1:
        raise LogError(f"length = {length!r} samples; a stretch has at least 1")
    struck = np.zeros(n, dtype=bool)
    firsts = np.random.default_rng(seed).permutation(n)
    for first in firsts:
        missing = round(share * n) - int(struck.sum())
        if missing <= 0:
            break
        struck[first : first + min(length, missing)] = True
    return struck


def _changed(log: Log, signals: dict[str, Values]) -> Log:
    """The log with values replaced and all else, quality too, as it was."""
    return replace(log, signals={**log.signals, **signals})
