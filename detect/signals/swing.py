"""How far a signal swings."""

import numpy as np
from stickslip.logs.arrays import Values


def amplitude(values: Values) -> float | None:
    """Half of the width that holds 90 % of ``values`` (n,), in their unit; None for fewer than two known ones.

    A sine of amplitude A gives 0.988 A, a square wave A, and one wild value among a thousand changes nothing.

    >>> round(amplitude(2.0 * np.sin(np.linspace(0.0, 20.0 * np.pi, 2001))), 2)
    1.98
    """
    good = values[np.isfinite(values)]
    if len(good) < 2:
        return None
    low, high = np.quantile(good, (0.05, 0.95))
    return 0.5 * float(high - low)
