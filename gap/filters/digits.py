"""Explanations that the digits of a measurement show by themselves: a coarse sensor, a compressing historian."""

from dataclasses import replace

import numpy as np
from stickslip.gap.effects.quantisation import Quantisation
from stickslip.gap.filters.explaining import settled
from stickslip.gap.filters.filtering import Explanation
from stickslip.gap.filters.fitting import Found, refined, tried
from stickslip.gap.filters.reading import Filtering
from stickslip.gap.fits.digits import UNEVEN, coarse, deviation, levels, straightened
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.records.record import rounding
from stickslip.logs import Log


def few_levels(f: Filtering) -> dict[str, float]:
    """Return name -> figure of each measurement that has few levels: sqrt(2 n ln(1/p)), p the share that is on them by
    chance; a sensor that is no coarser than its log has none.
    """
    found = {}
    for j, s in enumerate(f.signals):
        values = f.Y[:, j][np.isfinite(f.Y[:, j])]
        step = levels(values) if s not in f.ops and len(values) else 0.0
        if step:
            p = min((2.0 * 0.51 * rounding(values) + 2.0 * UNEVEN * step) / step, 1.0)
            found[f"few levels of {s}"] = float(np.sqrt(-2.0 * len(values) * np.log(p)))
    return found


def coarse_sensor(plain: Found, effect: Effect, place: str) -> Found | None:
    """Return a sensor of few levels if its signal has them, and the log is finer than these."""
    f = plain.best.explanation.filtering
    step = coarse(f, place) if isinstance(effect, Quantisation) else 0.0
    start = tried(Explanation(f, effect, place), {**plain.best.values, "step": step}) if step else None
    return refined(start, tuple(f.free)) if start is not None else None


def compressed(plain: Found, effect: Effect, place: str, seed: int) -> Found | None:
    """Return a compression that makes as many straight lines as the log has; None if it has none beyond noise.

    The loop has seen the true values, so the lines are left out of its filter, and noise and loads are fitted.
    """
    f = plain.best.explanation.filtering
    signal = straightened(f, seed)
    if not signal:
        return None
    left = replace(_without(f, signal), loose=True)
    best = replace(settled(left).best, explanation=Explanation(left, effect, place))
    size = deviation(f, best.values, effect, place, signal, seed)
    if size is None:
        return None
    return Found(replace(best, values={**best.values, "deviation": size}), (), np.zeros((0, 0)))


def _without(f: Filtering, signal: str) -> Filtering:
    """Return a record as if a signal had not been logged: the others have seen the true one."""
    log = f.record.log
    quality = {s: log.good(s) & (s != signal) for s in log.names}
    other = Log(log.t, {s: log[s] for s in log.names}, quality=quality)
    return replace(f, record=replace(f.record, log=other), leads=np.zeros_like(f.leads))
