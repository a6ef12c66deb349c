"""A long signal with as many points as a picture can show: the lowest and the highest of every stretch."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["POINTS", "envelope", "thinned"]

Values = npt.NDArray[np.float64]

POINTS = 4_000  # of a line in a picture; twice the pixels of a wide one


def thinned(t: Values, x: Values, points: int = POINTS) -> tuple[Values, Values]:
    """Times and values, at most ``points`` of them, whose line covers the same ground as that of all.

    ``t`` (n,) increasing, ``x`` (n,); NaN, a gap in the line, stays a gap: a stretch that holds one is broken.

    >>> t = np.arange(100_000.0)
    >>> few, x = thinned(t, np.sin(t / 50), 1000)
    >>> len(few) <= 1000, float(x.max()) > 0.9999, float(x.min()) < -0.9999
    (True, True, True)
    """
    n = len(t)
    if n <= points:
        return t, x
    stretches = points // 3  # each gives its lowest, its highest and perhaps a gap
    edges = np.linspace(0, n, stretches + 1).astype(np.int64)
    holes = np.isnan(x)
    low = edges[:-1] + _arg(np.where(holes, np.inf, x), edges, np.argmin)
    high = edges[:-1] + _arg(np.where(holes, -np.inf, x), edges, np.argmax)
    gap = edges[:-1] + _arg(holes.astype(np.float64), edges, np.argmax)
    kept = np.unique(np.concatenate([low, high, gap[holes[gap]], [0, n - 1]]))
    return t[kept], x[kept]


def envelope(t: Values, x: Values, stretches: int = 400) -> tuple[Values, Values, Values]:
    """Cut a signal into at most ``stretches``; return the middle, lowest and highest value of each, all (m,).

    ``t`` (n,) increasing, ``x`` (n,); a stretch without a finite value gives NaN.

    >>> t = np.arange(1000.0)
    >>> at, low, high = envelope(t, np.sin(t), 10)
    >>> len(at), bool(low.max() < -0.99), bool(high.min() > 0.99)
    (10, True, True)
    """
    count = min(stretches, len(t))
    edges = np.linspace(0, len(t), count + 1).astype(np.int64)[:-1]
    known = np.isfinite(x)
    low = np.minimum.reduceat(np.where(known, x, np.inf), edges)
    high = np.maximum.reduceat(np.where(known, x, -np.inf), edges)
    empty = low > high
    at = 0.5 * (t[edges] + t[np.append(edges[1:], len(t)) - 1])
    at[0], at[-1] = t[0], t[-1]  # the band reaches as far as the signal
    return at, np.where(empty, np.nan, low), np.where(empty, np.nan, high)


def _arg(x: Values, edges: npt.NDArray[np.int64], which: object) -> npt.NDArray[np.int64]:
    """Place of the extreme of each stretch, from its start."""
    widths = np.diff(edges)
    most = int(widths.max())
    places = np.minimum(np.arange(most), widths[:, None] - 1)
    return np.asarray(which(x[edges[:-1, None] + places], axis=1), dtype=np.int64)  # type: ignore[operator]
