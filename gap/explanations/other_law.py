"""A stem of another law of friction than the model's: what it leaves is the law's, not a second effect's.

A model without noise foretells a log to the last digits.  Its score then counts each row at which two laws differ by a
little as it counts one at which all is wrong, so it says little of how much is explained.  Squares do:

    explained = 1 - sum e^2 / sum e_0^2            e innovations with the effect, e_0 those of the model as it is

A stem is named if it takes nearly all of the gap away and leaves far less than anything else that is no stem.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.fits.search import Fit
from stickslip.gap.floors.problem import Problem
from stickslip.gap.records.model import nuisances

NEARLY = 0.9  # share of the squares that a stem explains whatever its law
FAR = 0.5  # of what any other effect leaves, which it may leave at most


def stem_of_other_law(problem: Problem, fits: Sequence[Fit]) -> Fit | None:
    """Return the stem that explains nearly all of the gap of a model without noise, whatever its law; None for none.

    ``fits``: the best explanation first, stems among them once.
    """
    stem = next((fit for fit in fits if fit.effect.hidden), None)
    if stem is None or nuisances(problem.model) or problem.record.filter is not None:
        return None
    there, left = _squares(problem.as_it_is), _squares(stem.e)
    others = [_squares(fit.e) for fit in fits if not fit.effect.hidden and not fit.candidate.noisy]
    return stem if left <= (1.0 - NEARLY) * there and left <= FAR * min(others, default=there) else None


def _squares(e: NDArray[np.float64]) -> float:
    return float(np.nansum(np.square(e)))
