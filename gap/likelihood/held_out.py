"""How far a gap shrinks on rows that the fit of its effect has not seen."""

from dataclasses import replace

import numpy as np
from stickslip.gap.answers.report import Shrinkage
from stickslip.gap.likelihood.fit import Fit, refined, tried
from stickslip.gap.likelihood.hypothesis import Innovations
from stickslip.gap.likelihood.replay import Replays
from stickslip.gap.likelihood.settling import FIRST, free_names
from stickslip.gap.likelihood.stems import StemFit
from stickslip.gap.reporting.sizes import SEEN, shrinkage, shrinkage_of_losses


def held_out(null: Fit, best: Fit) -> Shrinkage | None:
    """Return how far the gap shrinks behind the part of the record on which model and effect are fitted again."""
    before, after = _of_first_rows(null), _of_first_rows(best)
    return None if before is None or after is None else _shrunk(before, after)


def shrunk(null: Fit, best: Fit) -> Shrinkage:
    """Return how far the gap shrinks there with an effect whose size is known."""
    return _shrunk(null.best, best.best)


def _shrunk(before: Innovations, after: Innovations) -> Shrinkage:
    f = before.hypothesis.frame
    if isinstance(f, Replays):
        rows = slice(f.skipped, None)
        first = round(SEEN * len(f.Y)) - f.skipped
        after_e = after.missed / np.sqrt(before.S)  # in one unit, whatever noise each has
        return shrinkage(before.e[rows], after_e[rows], f.null_model.mean / len(f.signals), first)
    # innovations of a mixture are of unit size by what they are
    e = after.e if after.mixed is None else np.where(np.isnan(after.e), np.nan, 1.0)
    return shrinkage_of_losses(before.losses, after.losses, e, round(SEEN * len(e)))


def _of_first_rows(fit: Fit) -> Innovations | None:
    one = fit.hypothesis
    if isinstance(fit, StemFit):
        rows = one.frame.counted & (np.arange(len(one.frame.counted)) < SEEN * len(one.frame.counted))
        return min(fit.trials, key=lambda trial: float(trial.losses[rows].sum()))
    first = one.of(replace(one.frame, seen=SEEN))
    start = tried(first, fit.best.values)
    return None if start is None else refined(start, free_names(one), FIRST).best
