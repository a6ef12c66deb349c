"""In which coordinates sizes are fitted, and the step of a fit within their bounds.

x: logarithm of a size whose range is logarithmic, unless 0 is neutral: then the size in the middle of that range, since
what a small size does grows with it; else the size in its range.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from stickslip.gap.insertion.effect import Effect
from stickslip.logs.arrays import Values

WIDEST = 0.7  # largest change of a coordinate in one step


class Fitted(Protocol):
    """An effect at a place, or none, as a filter has it."""

    @property
    def effect(self) -> Effect | None:
        """The effect."""

    @property
    def bounds(self) -> Mapping[str, tuple[float, float]]:
        """Parameter -> (low, high)."""

    @property
    def nominal(self) -> Mapping[str, float]:
        """Parameter -> its value without the effect."""

    @property
    def filtering(self) -> Any:
        """What all effects of a record share; ``free`` is fitted with each."""


def spread(one: Fitted, name: str) -> bool:
    """Return whether the range of a parameter is logarithmic."""
    low, _ = one.bounds[name]
    if name in one.filtering.free:
        return low > 0.0
    spaced = one.effect is not None and any(p.name == name and p.spacing == "log" for p in one.effect.parameters)
    return spaced and low > 0.0


def logarithmic(one: Fitted, name: str) -> bool:
    """Return whether a parameter is fitted by its logarithm."""
    return spread(one, name) and (name in one.filtering.free or one.nominal[name] != 0.0)


def width(one: Fitted, name: str) -> float:
    """Return the unit in which a parameter is fitted that is not fitted by its logarithm."""
    low, high = one.bounds[name]
    return math.sqrt(low * high) if spread(one, name) else high - low


def coordinate(one: Fitted, name: str, size: float) -> float:
    """Return the coordinate of a size of a parameter."""
    size = float(np.clip(size, *one.bounds[name]))
    return math.log(size) if logarithmic(one, name) else size / width(one, name)


def value(one: Fitted, name: str, x: float) -> float:
    """Return the size of a parameter at a coordinate, within its bounds."""
    size = math.exp(x) if logarithmic(one, name) else x * width(one, name)
    return float(np.clip(size, *one.bounds[name]))


def moved(one: Fitted, names: Sequence[str], values: Mapping[str, float], d: Values) -> dict[str, float]:
    """Return values whose coordinates are so far away."""
    return {name: value(one, name, coordinate(one, name, values[name]) + x)
            for name, x in zip(names, d.tolist(), strict=True)}  # fmt: skip


def spreads(one: Fitted, names: Sequence[str], values: Mapping[str, float], information: Values) -> dict[str, float]:
    """Return the standard deviation of each parameter, in its unit, from Fisher's information of the coordinates."""
    sd = np.sqrt(np.maximum(np.diag(np.linalg.pinv(information)), 0.0)) if len(names) else np.zeros(0)
    return {
        name: float(s) * (abs(values[name]) if logarithmic(one, name) else width(one, name))
        for name, s in zip(names, sd, strict=True)
    }


def step(
    one: Fitted, names: Sequence[str], values: Mapping[str, float], g: Values, information: Values, damped: float
) -> tuple[Values, float]:
    """Return the step within bounds, and the nats that it promises; what wants to leave its bounds stays at them."""
    at = np.array([coordinate(one, name, values[name]) for name in names])
    ends = np.array([[coordinate(one, name, end) for end in one.bounds[name]] for name in names])
    widest = WIDEST * np.maximum(
        1.0, [1.0 if logarithmic(one, name) else abs(x) for name, x in zip(names, at, strict=True)]
    )
    return _within(g, information, damped, np.maximum(ends[:, 0] - at, -widest), np.minimum(ends[:, 1] - at, widest))


def _within(g: Values, information: Values, damped: float, low: Values, high: Values) -> tuple[Values, float]:
    n = len(g)
    A = information + damped * np.diag(np.diag(information)) + 1e-12 * np.trace(information) * np.eye(n)
    held = ((low >= -1e-12) & (g > 0.0)) | ((high <= 1e-12) & (g < 0.0))
    d = np.zeros(n)
    for _ in range(n):
        loose = np.flatnonzero(~held)
        if len(loose) == 0:
            break
        d = np.zeros(n)
        fixed = np.flatnonzero(held)
        ends = np.where(g[fixed] > 0.0, low[fixed], high[fixed])
        d[fixed] = np.where(np.abs(ends) < 1e-12, 0.0, ends)
        d[loose] = np.linalg.solve(A[np.ix_(loose, loose)], -g[loose] - A[np.ix_(loose, fixed)] @ d[fixed])
        out = loose[(d[loose] < low[loose] - 1e-12) | (d[loose] > high[loose] + 1e-12)]
        if len(out) == 0:
            break
        worst = out[np.argmax(np.maximum(low[out] - d[out], d[out] - high[out]))]
        d[worst] = np.clip(d[worst], low[worst], high[worst])
        g = g.copy()
        held[worst] = True
        low, high = low.copy(), high.copy()
        low[worst] = high[worst] = d[worst]
    d = np.clip(d, low, high)
    return d, -float(g @ d + 0.5 * d @ information @ d)
