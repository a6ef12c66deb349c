"""Intervals for the sizes of an effect, and how far the gap shrinks with them on rows that the fit has not seen."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.answers.report import Shrinkage, Size
from stickslip.gap.fits.search import Fit, slopes
from stickslip.gap.floors.floor import NU, losses
from stickslip.gap.records.given import SURE

Floats = NDArray[np.float64]
LOST = (NU + 3.0) / (NU + 1.0)  # variance by Student's loss over that of the innovations' own law
SEEN = 0.625  # share of the rows on which effects are fitted again to be judged on the rest
RANGE, NOTHING = (-9.0, 1.0), 1e-6  # of a fraction; loss above the floor that is none
BLOCKS = 12  # stretches of the rest whose scatter gives the interval


def sizes(fit: Fit) -> dict[str, Size]:
    """Return the parameters of a fit with intervals of 90 %, from the slopes of the innovations."""
    J, felt = slopes(fit)
    flat = np.nan_to_num(J)
    weights = 1.0 / (1.0 + np.nan_to_num(fit.e.ravel()) ** 2 / NU)
    G = flat.T @ (flat * weights[:, None])
    sd = dict(zip(felt, np.sqrt(np.maximum(np.diag(np.linalg.pinv(G)), 0.0) * LOST).tolist(), strict=True))
    found, log = {}, fit.candidate.problem.record.log
    for p in fit.effect.parameters:
        value, (low, high) = float(fit.values[p.name]), fit.candidate.bounds[p.name]
        if p.nuisance or not np.isfinite(value):
            continue
        wide = SURE * sd.get(p.name, np.inf)  # what the record does not feel may be anything
        if not p.smooth:  # read off the rows: a row in the whole record
            wide = value * log.dt / max(log.duration, log.dt)
        found[p.name] = Size(value, max(value - wide, min(low, value)), min(value + wide, max(high, value)), p.unit)
    return found


def shrinkage(before: Floats, after: Floats, floor: float, first: int) -> Shrinkage:
    """Return how far the gap shrinks on the rows from ``first`` on.

    ``before``, ``after`` innovations (rows, signals) of the model as it is and with effects that were fitted on earlier
    rows; ``floor`` mean loss without a gap.
    """
    rows = slice(first, None)
    return _by_stretches(losses(before[rows]).mean(axis=1), losses(after[rows]).mean(axis=1), floor)


def shrinkage_of_losses(before: Floats, after: Floats, e: Floats, first: int) -> Shrinkage:
    """Return how far the gap shrinks on the rows from ``first`` on, from a likelihood's losses of rows (rows,).

    ``e`` (rows, signals) innovations with effects.  A loss counts less what the effect's own filter would leave if its
    innovations were of unit size, plus 1/2, which is the floor.
    """
    signals = e.shape[1]
    reference = (after[first:] - 0.5 * np.nansum(e[first:] ** 2 - 1.0, axis=1)) / signals - 0.5
    return _by_stretches(before[first:] / signals - reference, after[first:] / signals - reference, 0.5)


def _by_stretches(before: Floats, after: Floats, floor: float) -> Shrinkage:
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


def shares(fits: Sequence[Fit], F0: float, floor: float) -> dict[str, float]:
    """Return place -> share of the gap that the best effect there explains, the largest first."""
    found: dict[str, float] = {}
    for fit in fits:
        share = float(np.clip((F0 - fit.F) / max(F0 - floor, 1e-9), 0.0, 1.0))
        found[fit.place] = max(found.get(fit.place, 0.0), share)
    return dict(sorted(found.items(), key=lambda one: -one[1]))
