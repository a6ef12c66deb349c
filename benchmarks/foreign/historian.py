"""What the historian makes of a tag: rounding, and as effects a swinging door, a late time stamp and a filter."""

import numpy as np


def rounded(y: np.ndarray, step: float) -> np.ndarray:
    """Return whole steps, without the tail of binary numbers."""
    return np.round(step * np.round(y / step), 9)


def swinging_door(t: np.ndarray, y: np.ndarray, deviation: float) -> np.ndarray:
    """Keep a value only where no line from the last one kept passes within ``deviation`` of all between; join by lines.

    >>> swinging_door(np.arange(4.0), np.array([0.0, 1.1, 2.0, 9.0]), 0.2).tolist()
    [0.0, 1.0, 2.0, 9.0]
    """
    kept, low, high = [0], -np.inf, np.inf
    for i in range(1, len(t)):
        steep = (y[i] - y[kept[-1]]) / (t[i] - t[kept[-1]])
        if not low <= steep <= high:
            kept.append(i - 1)
            low, high = -np.inf, np.inf
        gone = t[i] - t[kept[-1]]
        low = max(low, (y[i] - deviation - y[kept[-1]]) / gone)
        high = min(high, (y[i] + deviation - y[kept[-1]]) / gone)
    kept.append(len(t) - 1)
    return np.interp(t, t[kept], y[kept])


def late(t: np.ndarray, y: np.ndarray, by: float) -> np.ndarray:
    """Return a tag whose time stamps are late by ``by`` [s]: each row holds the value of the last row before it."""
    return y[np.maximum(np.searchsorted(t, t - by + 1e-9, side="right") - 1, 0)]


def filtered(t: np.ndarray, y: np.ndarray, tau: float) -> np.ndarray:
    """Return a tag behind a first-order filter of ``tau`` [s], which holds each row until the next.

    >>> filtered(np.arange(3.0), np.array([0.0, 2.0, 2.0]), 1.0 / np.log(2.0)).round(9).tolist()
    [0.0, 1.0, 1.5]
    """
    out = y.astype(float)
    if tau > 0.0:
        for k, gone in enumerate(np.diff(t), 1):
            out[k] = out[k - 1] + (y[k] - out[k - 1]) * (1.0 - np.exp(-gone / tau))
    return out
