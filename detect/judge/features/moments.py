"""Shapes of distributions in one number, blind to offset and scale."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

__all__ = ["kurtosis", "skewness"]

Values = npt.NDArray[np.float64]


def kurtosis(x: Values) -> float:
    """Excess kurtosis [-]: 0 for a Gaussian, -1.5 for a sine, -2 for a square, large for rare jumps; NaN if constant.

    >>> round(kurtosis(np.sin(np.arange(0, 2 * np.pi, 0.01))), 2)
    -1.5
    """
    d = x - np.mean(x)
    variance = float(np.mean(d**2))
    return float(np.mean(d**4)) / variance**2 - 3.0 if variance > 1e-24 else math.nan


def skewness(x: Values) -> float:
    """Third moment over the cube of the standard deviation [-]; NaN if constant.

    >>> skewness(np.array([-1.0, 0.0, 1.0]))
    0.0
    """
    d = x - np.mean(x)
    variance = float(np.mean(d**2))
    return float(np.mean(d**3)) / variance**1.5 if variance > 1e-24 else math.nan
