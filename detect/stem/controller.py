"""The sign of the process's gain, from the controller: in a stable loop both gains have the same sign."""

import numpy as np
from stickslip.logs.arrays import Values


def controller_sign(op: Values, e: Values) -> float:
    """Whether OP rises (+1) or falls (-1) with e = SP - PV, from their steps and from e itself: a PI moves by both.

    >>> e = np.sin(np.arange(100.0) / 5)
    >>> controller_sign(-2 * e - 0.1 * np.cumsum(e), e)
    -1.0
    """
    move, step, level = np.diff(op), np.diff(e), e[1:] - np.mean(e)

    def alike(other: Values) -> float:
        size = float(np.linalg.norm(move) * np.linalg.norm(other))
        return float(move @ other) / size if size > 0.0 else 0.0

    return -1.0 if alike(step) + alike(level) < 0.0 else 1.0
