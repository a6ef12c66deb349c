"""The likeliest sizes of an effect that hides a mode, a stem that sticks: each size by a filter of its own.

The gains of another filter say little of a stem, since they do not know when it sticks, and a model without a stem has
taken the stem for noise or a load.  So noise and loads are fitted at each size of a grid, and the size is narrowed near
the best.  A slip jump is tried last, from the likeliest stem without one, which is a deadband.
"""

import math
from collections.abc import Sequence

import numpy as np
from stickslip.gap.likelihood.fit import refined, tried
from stickslip.gap.likelihood.hypothesis import Hypothesis, Innovations

GRID = 5  # sizes over their whole range
NARROWED = 6  # trials between two of them
ROUNDS = 2  # of a fit of noise and loads
JUMPS = (0.2, 0.4, 0.6)  # of S
NEAR = 0.15  # share by which sizes near the best are tried


def likeliest_band(start: Innovations) -> Innovations | None:
    """Return a filter of its own of the likeliest band of a stem without a jump; ``start`` has the values of all else.

    None where no filter can follow it.
    """
    band, *jump = start.hypothesis.own
    low, high = start.hypothesis.bounds[band]
    grid = np.geomspace(low, high, GRID + 2)[1:-1].tolist()
    free = tuple(start.hypothesis.frame.free)
    several = [{band: value, **dict.fromkeys(jump, 0.0)} for value in grid]
    found = [refined(one, free, ROUNDS).best for one in _good(start, several)]
    return _narrowed(min(found, key=_nll), band, grid[1] / grid[0]) if found else None


def likeliest_jump(one: Hypothesis, without: Innovations) -> Innovations | None:
    """Return a filter of its own of the likeliest sizes of a stem that jumps, from the likeliest ``without`` a jump."""
    band = without.values[without.hypothesis.own[0]]
    shared = {key: without.values[key] for key in one.frame.free}
    start = tried(one, {**shared, "S": band, "J": 0.0})
    if start is None:
        return None
    # a play that stands for a stem that jumps has a band between S - J and S
    several = [{"S": band / (1.0 - 0.5 * share), "J": share * band / (1.0 - 0.5 * share)} for share in JUMPS]
    best = min([start, *(refined(x, tuple(one.frame.free), ROUNDS).best for x in _good(start, several))], key=_nll)
    if best is start:
        return start
    S, J = best.values["S"], best.values["J"]
    near = [{"S": S * by, "J": J * by} for by in (1.0 - NEAR, 1.0 + NEAR)]
    near += [{"J": J * by} for by in (1.0 - 2.0 * NEAR, 1.0 + 2.0 * NEAR)]
    return min([best, *_good(best, near)], key=_nll)


def _narrowed(best: Innovations, size: str, by: float) -> Innovations:
    """Return the likeliest of some sizes within a factor, found by Brent's search."""
    from scipy.optimize import minimize_scalar

    least, most = best.hypothesis.bounds[size]
    seen = [best]

    def nll(x: float) -> float:
        found = _at(best, {size: math.exp(x)})
        if found is None:
            return math.inf
        seen.append(found)
        return found.nll

    ends = math.log(max(best.values[size] / by, least)), math.log(min(best.values[size] * by, most))
    minimize_scalar(nll, bounds=ends, method="bounded", options={"maxiter": NARROWED, "xatol": 0.02})
    return min(seen, key=_nll)


def _good(start: Innovations, several: Sequence[dict[str, float]]) -> list[Innovations]:
    return [found for values in several if (found := _at(start, values)) is not None]


def _at(start: Innovations, values: dict[str, float]) -> Innovations | None:
    return tried(start.hypothesis, {**start.values, **values})


def _nll(found: Innovations) -> float:
    return found.nll
