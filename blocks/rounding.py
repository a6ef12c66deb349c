"""Rounding to multiples of a step, as converters and archives do; compiled into the blocks that round."""

import math

RESOLUTION = 2.0**52  # values of more steps than this are whole numbers of steps anyway


def rounded(value: float, step: float) -> float:
    """Return the nearest multiple of ``step``, the upper one of two; the value itself for a step of 0.

    >>> rounded(0.37, 0.25), rounded(-0.125, 0.25), rounded(0.37, 0.0), rounded(1e300, 1e-9)
    (0.25, 0.0, 0.37, 1e+300)
    """
    if step > 0.0 and abs(value) < RESOLUTION * step:
        return step * math.floor(value / step + 0.5)
    return value
