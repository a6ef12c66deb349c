"""The play with a slip jump: where a sticky stem would stand for every OP, for many sizes of stiction at once.

    moving in direction d    x = u - d f_D;  it sticks where u stops or turns
    stuck                    x is held until |u - x| > f_S;  then it slips to u - d f_D, d = sign(u - x)
    f_S = (S + J) / 2,    f_D = (S - J) / 2

J = 0 is the play (backlash) of width S.  For every input these are the moves of the valve of Kano et al. 2004
(``blocks/kano_valve.py``) without its end stops; detectors load no simulator, so the recursion stands here again, over
many candidates, compiled (``kernels``).
"""

import math

import numpy as np
import numpy.typing as npt
from stickslip.logs.arrays import Indices, Values


def stick(u: Values, S: npt.ArrayLike, J: npt.ArrayLike = 0.0, start: npt.ArrayLike = 0.0) -> Values:
    """Stem positions for OP u (n,): shape (n, m) for m candidates, or (n,) where S, J and start are numbers.

    S, J : (m,) [unit of u], 0 <= J <= S
    start : (m,) [-]
        u - x at the first sample as a share of f_S, -1 to 1: where the stem stood is not known.

    >>> stick(np.array([0.0, 3.0, 6.0, 9.0, 4.0]), 6.0, 2.0).tolist()
    [0.0, 0.0, 4.0, 7.0, 7.0]
    """
    from stickslip.detect.stem.kernels import sticks

    s, j, at = np.broadcast_arrays(*(np.atleast_1d(np.asarray(v, dtype=float)) for v in (S, J, start)))
    x = np.empty((len(s), len(u)))
    eps = 1e-9 * max(float(np.ptp(u)), 1e-300)
    sticks(*(np.ascontiguousarray(v) for v in (np.asarray(u, dtype=float), s, j, at)), eps, x)
    return x[0] if np.ndim(S) == np.ndim(J) == np.ndim(start) == 0 else x.T


def turns(u: Values, travel: float) -> Indices:
    """Where u turns: the extremes that are followed and preceded by a move of more than ``travel``, in order.

    >>> turns(np.array([0.0, 5.0, 4.0, 6.0, 1.0, 2.0, 0.0, 7.0]), 3.0).tolist()
    [3, 6]
    """
    found: list[int] = []
    low = high = way = 0
    values = u.tolist()
    for k, value in enumerate(values):
        if value > values[high]:
            high = k
        if value < values[low]:
            low = k
        if way >= 0 and values[high] - value > travel:
            if way > 0:
                found.append(high)
            way, low = -1, k
        elif way <= 0 and value - values[low] > travel:
            if way < 0:
                found.append(low)
            way, high = 1, k
    return np.array(found, dtype=np.intp)


def turn_time(u: Values, period: float) -> tuple[Indices, float]:
    """The large turns of u, by more than a quarter of its range, and the time between two turns [samples].

    That time is half the period where there is one (``period`` [samples] finite), else the record over its turns.
    """
    at = turns(u, 0.25 * float(np.percentile(u, 98) - np.percentile(u, 2)))
    return at, max(0.5 * period if math.isfinite(period) else len(u) / (len(at) + 1.0), 2.0)
