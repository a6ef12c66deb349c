"""Fit the noise of a sensor: a replay has none, so it shows in the width of the innovations only."""

import numpy as np

from gap.search import Candidate, Fit, best_of, narrowed

FACTORS = 40  # sizes of noise that are tried, and again between the best ones


def fitted_noise(candidate: Candidate) -> Fit | None:
    """Return the fit of another size of a sensor's noise; None where its signal is not logged."""
    plain = candidate.absent
    if not {str(s) for s in candidate.base[candidate.place].output_labels} & set(candidate.problem.record.pinned):
        return None
    factors = np.geomspace(*candidate.bounds["factor"], FACTORS)
    fits: list[Fit] = []
    for _ in range(2):
        fits = [narrowed(Fit(candidate, {**plain.values, "factor": float(f)}, 0.0, plain.e)) for f in factors]
        k = int(np.argmin([fit.F for fit in fits]))
        factors = np.geomspace(factors[max(k - 1, 0)], factors[min(k + 1, len(factors) - 1)], FACTORS)
    return best_of(fits)
