"""Fit the noise of a sensor: a replay has none, so it shows in the width of the innovations only.

Any gap makes innovations wider.  More noise of a sensor leaves them white, and as wide at one level of the signal as at
another, early as late:

    z = corr(e_k, e_(k-j)) sqrt(n)          z = corr(e_k^2, x_k) sqrt(n),   x the level of the signal, or time

are then normal, of variance 1.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gap.search import Candidate, Fit, best_of, narrowed

Floats = NDArray[np.float64]
UNLIKELY = 3.0  # standard deviations of a correlation
LAGS = (1, 2, 3, 5, 8, 13, 20)  # rows
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
        known = np.isfinite(e) & np.isfinite(level)
        pairs = [(e[:-lag], e[lag:]) for lag in LAGS] + [(e**2, level), (e**2, np.arange(len(e), dtype=float))]
        of = [known[:-lag] & known[lag:] for lag in LAGS] + [known, known]
        z = [correlation(a[rows], b[rows]) * float(np.sqrt(rows.sum())) for (a, b), rows in zip(pairs, of, strict=True)]
        if max(map(abs, z), default=0.0) > UNLIKELY:
            return False
    return True


def correlation(a: Floats, b: Floats) -> float:
    """Return the correlation of two series, 0 where one stands still.

    >>> round(correlation(np.array([0.0, 1.0, 2.0]), np.array([1.0, 3.0, 5.0])), 12)
    1.0
    """
    a, b = a - a.mean(), b - b.mean()
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    return float(a @ b) / size if size > 0.0 else 0.0
