"""The first sizes of a limit, of a controller or of a valve's stem: where OP stands, or just beyond all it was seen at.

A limit that OP met between two rows only is in no row.  It is met most where a set point switches, so the scans of the
switches that suited a model without it tell nothing of its size: the likeliest sizes get switches of their own.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from stickslip.gap.filters.filtering import Explanation, Filtered
from stickslip.gap.filters.fitting import Found, best_of, tried
from stickslip.gap.filters.switches import with_switches

LEAST = 5.0  # nats that a second limit must gain
HIGHEST = 0.1  # share of the rows of OP that a limit cuts, unless it stops the valve while OP goes on
CUT = tuple(np.linspace(0.1, 0.9, 17).tolist())  # share of the rows at which a valve that stops short is told more
OUTER = (0.5, 1.0, 2.0, 4.0)  # [%], by which a limit of a controller may lie beyond all rows
TOO_LARGE = 3.0  # standard deviations by which squares of innovations are too large where OP may have met a limit
SWITCHED = 3  # sizes that get switches of their own: the likeliest by all rows, and by those that no switch is near
STEPS = (0.4, 0.2, 0.1, 0.05)  # [%], about the likeliest size
REACH, WITHIN = (0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2), 1.35  # [%] from it; nats of an interval of 90 %


def limited(plain: Found, one: Explanation) -> Filtered | None:
    """Return the best of some upper and lower limits; ``plain`` the model as it is."""
    f = one.filtering
    percent = 100.0 if one.effect and one.effect.parameters[0].unit.startswith("%") else 1.0
    op = f.op_at(one.place)
    logged = f.record.log[op][f.record.log.good(op)]
    found = None
    values = {key: plain.best.values[key] for key in f.free}
    met = not one.law and _too_large(plain.best)
    for name, way in (("high", 1.0), ("low", -1.0)):
        beyond = np.sort(way * logged)[::-1] * way
        rows = 2 ** np.arange(int(np.log2(max(HIGHEST * len(logged), 1.0))) + 1) - 1  # at which OP exceeds it
        if one.law:
            rows = np.concatenate([rows, [int(share * (len(logged) - 1)) for share in CUT]])
        sizes = np.unique(beyond[rows]) * percent
        if met:
            outer = beyond[0] * percent + way * np.array(OUTER)
            best = _switched(one, values, name, [*sizes, *outer])
            if best is not None and best.values[name] in outer:
                best = _between(best, name)
        else:
            best = best_of([tried(one, {**values, name: float(size)}) for size in sizes])
        if best is not None and (found is None or best.nll < found.nll - LEAST):
            found = best
        if found is not None:
            values = dict(found.values)
    return found


def _too_large(plain: Filtered) -> bool:
    """Return whether innovations are larger than chance makes them."""
    e = plain.judged
    return float(np.nansum(e**2 - 1.0)) > TOO_LARGE * math.sqrt(2.0 * float(np.isfinite(e).sum()))


def _switched(one: Explanation, values: Mapping[str, float], name: str, sizes: list[float]) -> Filtered | None:
    """Return the likeliest size of a limit, by all rows, with inputs that switch as suits it."""
    low, high = one.bounds[name]
    whole = replace(one, filtering=replace(one.filtering, apart=False))
    looked = [x for size in sizes if low < size < high and (x := tried(whole, {**values, name: float(size)}))]
    best = best_of(looked)
    if best is None:
        return None
    likely = sorted(looked, key=lambda x: x.nll)[:SWITCHED]
    likely += sorted(looked, key=lambda x: float(x.losses[one.filtering.counted].sum()))[:SWITCHED]
    return best_of([best, *map(with_switches, {x.values[name]: x for x in likely}.values())])


def _between(best: Filtered, name: str) -> Filtered:
    """Return the likeliest size near one that no row shows."""
    one, (low, high) = best.explanation, best.explanation.bounds[name]
    for step in STEPS:
        near = [float(np.clip(best.values[name] + way * step, low, high)) for way in (1.0, -1.0)]
        best = best_of([best, *(tried(one, {**best.values, name: size}) for size in near)]) or best
    return best


def reach(best: Filtered, name: str) -> tuple[float, float]:
    """Return the sizes of a limit up to which it is hardly less likely, all else as it is: (lowest, highest) [%]."""
    one, (low, high), value = best.explanation, best.explanation.bounds[name], best.values[name]
    ends = []
    for way in (-1.0, 1.0):
        ends.append(value)
        for step in REACH:
            size = float(np.clip(value + way * step, low, high))
            near = tried(one, {**best.values, name: size})
            if near is None or near.nll > best.nll + WITHIN:
                break
            ends[-1] = size
    return ends[0], ends[1]
