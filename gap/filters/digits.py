"""What the digits of a measurement show: levels of a coarse sensor, straight lines of a compressing historian."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.effects.quantisation import Quantisation
from stickslip.gap.filters.explaining import settled
from stickslip.gap.filters.filtering import Explanation
from stickslip.gap.filters.fitting import Found, refined, tried
from stickslip.gap.filters.reading import Filtering
from stickslip.gap.floors.floor import without_gap
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.insertion.straightness import deviation_of, lined
from stickslip.gap.records.record import rounding
from stickslip.logs import Log

Floats = NDArray[np.float64]
APART = 2.5  # roundings of the log by which levels lie apart where a sensor is coarse
FEW = 0.1  # levels for each row, at most
TRIED = 3000  # steps near the usual distance of neighbours
UNEVEN = 0.05  # of a step, beyond the log's rounding
STRAIGHT = 0.2  # share of straight triples beyond what the model's own log has


def levels(values: Floats) -> float:
    """Return the step between the few levels of a measurement, which the log may have rounded again; 0 for none.

    >>> levels(np.round(np.round(np.random.default_rng(0).normal(1.5, 0.1, 999) / 0.019) * 0.019 / 0.0015) * 0.0015)
    0.019
    """
    known = values[np.isfinite(values)]
    fine, found = rounding(known), np.unique(np.round(known, 9))
    if not 4 <= len(found) <= FEW * len(known):
        return 0.0
    step = float(np.median(np.diff(found)))
    if step < APART * max(fine, 1e-9):
        return 0.0
    tried = step * np.linspace(0.85, 1.15, TRIED)  # the one in whose multiples all levels agree best
    step = float(tried[np.argmax(np.abs(np.exp(2j * np.pi * found[:, None] / tried).mean(axis=0)))])
    step = float(np.polyfit(np.round(found / step), found, 1)[0])
    off = np.abs(found - np.round(found / step) * step)
    return float(f"{step:.4g}") if float(off.max()) <= 0.51 * fine + UNEVEN * step else 0.0


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
    """Return a sensor of few levels if its signal has them and the controller has seen them too."""
    f = plain.best.explanation.filtering
    if not isinstance(effect, Quantisation):
        return None
    signal = next((str(s) for s in f.quiet[place].output_labels if str(s) in f.signals), "")
    step = levels(f.Y[:, f.signals.index(signal)]) if signal else 0.0
    if not step:
        return None
    one = Explanation(f, effect, place)
    start = tried(one, {**plain.best.values, "step": step})
    if start is None:
        return None
    found = refined(start, tuple(f.free))
    return found if found.nll < plain.nll else None


def compressed(plain: Found, effect: Effect, place: str, seed: int) -> Found | None:
    """Return a compression that makes as many straight lines as the log has; None if it has none beyond noise."""
    f = plain.best.explanation.filtering
    for j, signal in enumerate(f.signals):
        if signal in f.ops:
            continue
        step, values = rounding(f.Y[:, j]), f.Y[:, j]
        wanted = lined(values, step)
        if wanted < STRAIGHT:
            continue
        plain_logs = without_gap(f.model, f.record, 1, seed + 1)
        if not plain_logs or wanted < lined(plain_logs[0][signal], step) + STRAIGHT:
            continue
        deviation = deviation_of(plain_logs[0], effect, place, signal, step, values)
        one = Explanation(_without(f, j), effect, place)
        refitted = settled(_without(f, j))  # what suits straight lines is not what the loop has seen
        best = replace(refitted.best, explanation=one, values={**refitted.best.values, "deviation": deviation})
        return Found(best, (), np.zeros((0, 0)))
    return None


def _without(f: Filtering, j: int) -> Filtering:
    """Return a record as if a signal had not been logged: the others have seen the true one."""
    log = f.record.log
    quality = {s: log.good(s) & (s != f.signals[j]) for s in log.names}
    other = Log(log.t, {s: log[s] for s in log.names}, quality=quality)
    return replace(f, record=replace(f.record, log=other), leads=np.zeros_like(f.leads))
