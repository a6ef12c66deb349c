"""How a size is said."""

from __future__ import annotations

import math

__all__ = ["rounded"]


def rounded(x: float) -> float:
    """A size to two digits, as people say it.

    >>> rounded(4.567), rounded(0.01234)
    (4.6, 0.012)
    """
    return 0.0 if x == 0.0 else round(x, 1 - math.floor(math.log10(abs(x))))
