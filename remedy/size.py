"""A value with its 90 % interval, from a population of loops or without one where the record does not tell it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Size", "size_of", "widened"]

Floats = NDArray[np.float64]
WIDER = 2.4  # than the population: no stem, load or process is the model's; set on loops that serve nothing else


@dataclass(frozen=True)
class Size:
    """A value with its 90 % interval; None with a ``reason`` where the record does not tell it."""

    value: float | None
    low: float | None
    high: float | None
    reason: str = ""

    def to_dict(self) -> dict[str, Any]:
        """For JSON, which has no infinite numbers; what is null has a reason."""
        given = {"value": self.value, "low": self.low, "high": self.high}
        own: dict[str, Any] = {key: x if x is not None and math.isfinite(x) else None for key, x in given.items()}
        endless = any(x is not None and math.isinf(x) for x in given.values())
        why = self.reason or ("the interval has no end" if endless else "no interval is known")
        return own | ({"reason": why} if self.reason or None in own.values() else {})

    def __str__(self) -> str:
        if self.value is None:
            return f"not known: {self.reason}"
        if self.low is None or self.high is None:
            return f"{self.value:.3g}"
        return f"{self.value:.3g} ({self.low:.3g} to {self.high:.3g})"


def widened(values: Floats, zero: bool = False) -> Floats:
    """Values (n,) ``WIDER`` times as far from their median, in logarithms where all have one sign; inf stays.

    Not in logarithms where they may be ``zero`` or some are.  Values of one sign keep it.
    """
    known = np.isfinite(values)
    if not known.any():
        return values
    middle, found = float(np.median(values[known])), values.astype(float)
    if not zero and np.all(values[known] * middle > 0.0):
        found[known] = middle * (values[known] / middle) ** WIDER
        return found
    found[known] = middle + WIDER * (values[known] - middle)
    least, most = float(np.min(values[known])), float(np.max(values[known]))
    low, high = 0.0 if least >= 0.0 else -math.inf, 0.0 if most <= 0.0 else math.inf
    return np.asarray(np.clip(found, low, high))


def size_of(values: Floats, reason: str = "", endless: str = "", zero: bool = False) -> Size:
    """Median and 90 % interval of a population (n,), widened; with a ``reason``, the interval alone.

    ``endless`` : the reason where half of the values or more are infinite;  ``zero`` : as ``widened`` takes it
    """
    values = widened(values, zero)
    way: Any = "linear" if np.isfinite(values).all() else "nearest"
    low, middle, high = (float(x) for x in np.percentile(values, [5.0, 50.0, 95.0], method=way))
    reason = reason or (endless if math.isinf(middle) else "")
    return Size(None if reason else middle, low, high, reason)
