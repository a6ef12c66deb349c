"""Fit the noise of a sensor: a replay has none, so it shows in the width of the innovations only.

Any gap makes innovations wider.  More noise of a sensor leaves them white, without a mean, and as wide at one level of
the signal as at another, while it moves as at rest, early as late:

    z = corr(e_k, e_(k-j)) sqrt(n)          z = mean(e) sqrt(n) / sd(e)
    z = corr(e_k^2, x_k) sqrt(n),           x the level of the signal, its rate, or time

are then normal, of variance 1, and so is what tells noise that comes in bursts, wider for a while and not:

    z = sum over j = 1 ... m of corr(e_k^2, e_(k-j)^2) sqrt(n / m)          after McLeod and Li (1983)

Noise that grows with the signal instead, of which a record of few levels, or a little
noise, shows next to nothing, would have for the level

    z_1 = cov(v, x) sqrt(n) / (sd(e^2) sd(x))       v = 1 + (1 - 1/f^2) (x^2 / mean(x^2) - 1),   f the noise found

and is the likelier of the two where z > z_1 / 2.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.fits.search import Candidate, Fit, best_of, narrowed

Floats = NDArray[np.float64]
UNLIKELY, MOVING = 3.0, 3.5  # standard deviations of a correlation, and of that with the rate
LAGS = (1, 2, 3, 5, 8, 13, 20)  # rows
NEIGHBOURS = 32  # rows behind one, with whose squares its own goes where noise comes in bursts
LARGEST = 4.0  # innovation: what is beyond counts as this, so that a few do not decide
FACTORS = 40  # sizes of noise that are tried, and again between the best ones


def fitted_noise(candidate: Candidate, beside: Fit | None = None) -> Fit | None:
    """Return the fit of another size of a sensor's noise; None where its signal is not logged.

    ``beside``: a fit of another effect, whose innovations count instead of those of the candidate's diagram.
    """
    plain = candidate.absent if beside is None else replace(candidate.absent, e=beside.e)
    if not {str(s) for s in candidate.base[candidate.place].output_labels} & set(candidate.problem.record.pinned):
        return None
    factors = np.geomspace(*candidate.bounds["factor"], FACTORS)
    fits: list[Fit] = []
    for _ in range(2):
        fits = [narrowed(Fit(candidate, {**plain.values, "factor": float(f)}, 0.0, plain.e)) for f in factors]
        k = int(np.argmin([fit.F for fit in fits]))
        factors = np.geomspace(factors[max(k - 1, 0)], factors[min(k + 1, len(factors) - 1)], FACTORS)
    return best_of(fits)


def is_noise(fit: Fit) -> bool:
    """Return whether what a fit of a sensor's noise leaves has the marks of noise: white, and as wide everywhere."""
    problem, candidate = fit.candidate.problem, fit.candidate
    if problem.floor.coloured:
        return True
    record = problem.record
    for s in (str(s) for s in candidate.base[candidate.place].output_labels if str(s) in record.pinned):
        k = record.pinned.index(s)
        e = np.clip(fit.e[:, k], -LARGEST, LARGEST)
        raw = problem.as_it_is[:, k] * problem.floor.L[k, k]
        level = record.log[s][problem.floor.skipped :] - raw  # of the model: the noise itself is not in it
        time, rate = np.arange(len(e), dtype=float), np.abs(np.diff(level, prepend=level[:1]))  # up to this row only
        z = [shown(e[:-lag], e[lag:]) for lag in LAGS] + [shown(e**2, x) for x in (level, time)]
        z.append(float(np.nanmean(e)) / max(float(np.nanstd(e)), 1e-300) * float(np.sqrt(np.isfinite(e).sum())))
        if max(map(abs, z)) > UNLIKELY or abs(shown(e**2, rate)) > MOVING or in_bursts(e) > MOVING:
            return False
        if shown(e**2, level) > 0.5 * growing(e, level, fit.values["factor"]) > 0.0:
            return False
    return True


def in_bursts(e: Floats) -> float:
    """Return the z that squares of innovations go with those of the rows before, positive where noise comes in bursts.

    >>> rng = np.random.default_rng(1)
    >>> e, wide = rng.normal(size=4000), np.repeat([1.0, 2.0], 100)
    >>> abs(in_bursts(e)) < 3.0, in_bursts(e * np.tile(wide, 20)) > 20.0
    (True, True)
    """
    squares = e**2
    lags = range(1, min(NEIGHBOURS, len(e) // 4) + 1)
    return sum(shown(squares[:-lag], squares[lag:]) for lag in lags) / float(np.sqrt(max(len(lags), 1)))


def growing(e: Floats, level: Floats, factor: float) -> float:
    """Return the z that squares of innovations would have with the level if noise beyond the model's grew with it."""
    known = np.isfinite(e) & np.isfinite(level)
    x, squares = level[known], e[known] ** 2
    v = (1.0 - 1.0 / factor**2) * (x**2 / max(float(np.mean(x**2)), 1e-300) - 1.0)
    size = float(squares.std() * x.std())
    return float(np.mean((v - v.mean()) * (x - x.mean()))) / size * float(np.sqrt(len(x))) if size > 0.0 else 0.0


def shown(a: Floats, b: Floats) -> float:
    """Return the correlation of the rows that two series have, in its standard deviations without any."""
    known = np.isfinite(a) & np.isfinite(b)
    return correlation(a[known], b[known]) * float(np.sqrt(known.sum())) if known.any() else 0.0


def correlation(a: Floats, b: Floats) -> float:
    """Return the correlation of two series, 0 where one stands still.

    >>> round(correlation(np.array([0.0, 1.0, 2.0]), np.array([1.0, 3.0, 5.0])), 12)
    1.0
    """
    a, b = a - a.mean(), b - b.mean()
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    return float(a @ b) / size if size > 0.0 else 0.0
