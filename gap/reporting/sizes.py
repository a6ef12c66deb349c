"""How far a gap shrinks on rows that the fit of an effect has not seen."""

import numpy as np
from stickslip.gap.answers.report import Shrinkage
from stickslip.gap.null_model.null_model import losses
from stickslip.logs.arrays import Values

SEEN = 0.625  # share of the rows on which effects are fitted again to be judged on the rest
RANGE, NOTHING = (-9.0, 1.0), 1e-6  # of a fraction; loss above the floor that is none
BLOCKS = 12  # stretches of the rest whose scatter gives the interval


def shrinkage(before: Values, after: Values, floor: float, first: int) -> Shrinkage:
    """Return how far the gap shrinks on the rows from ``first`` on.

    ``before``, ``after`` innovations (rows, signals) of the model as it is and with effects that were fitted on earlier
    rows; ``floor`` mean loss without a gap.
    """
    rows = slice(first, None)
    return _by_stretches(losses(before[rows]).mean(axis=1), losses(after[rows]).mean(axis=1), floor)


def shrinkage_of_losses(before: Values, after: Values, e: Values, first: int) -> Shrinkage:
    """Return how far the gap shrinks on the rows from ``first`` on, from a likelihood's losses of rows (rows,).

    ``e`` (rows, signals) innovations with effects.  A loss counts less what the effect's own filter would leave if its
    innovations were of unit size, plus 1/2, which is the floor.
    """
    signals = e.shape[1]
    reference = (after[first:] - 0.5 * np.nansum(e[first:] ** 2 - 1.0, axis=1)) / signals - 0.5
    return _by_stretches(before[first:] / signals - reference, after[first:] / signals - reference, 0.5)


def _by_stretches(before: Values, after: Values, floor: float) -> Shrinkage:
    """Return the shrinkage, with the interval that the scatter over stretches gives."""
    parts = np.array_split(np.arange(len(before)), BLOCKS)
    b, a = (np.array([loss[part].mean() for part in parts]) for loss in (before, after))
    if b.mean() - floor <= NOTHING:  # there is no gap that could shrink
        return Shrinkage(float(b.mean()), float(a.mean()), floor, 0.0, *RANGE)
    fraction = _fraction(b.mean(), a.mean(), floor)
    rng = np.random.default_rng(0)
    drawn = [_fraction(b[k].mean(), a[k].mean(), floor) for k in rng.integers(0, len(b), (400, len(b)))]
    low, high = np.quantile(drawn, (0.05, 0.95))
    return Shrinkage(float(b.mean()), float(a.mean()), floor, fraction, float(low), float(high))


def _fraction(before: float, after: float, floor: float) -> float:
    removable = before - floor
    return float(np.clip((before - after) / removable, *RANGE)) if removable > NOTHING else 0.0
