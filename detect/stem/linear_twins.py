"""Twins of a record whose valve follows: what would an index be if PV were OP through a lag, and the rest chance?

    PV = answer + left,    twin = answer + left shifted in time

``answer`` is the best linear response to OP (``lags``), ``left`` what it does not tell.  The shift keeps its colour and
takes away that it goes with OP; it is never a whole number of periods.  An index that is no larger on the record than
on its twins says nothing of the valve: a lag between two waves makes it as well.
"""

import numpy as np
from stickslip.detect.stem.lags import Lags
from stickslip.logs.arrays import Values

SHIFTS = ((0.23, 0.3), (0.41, 0.43), (0.59, 0.57), (0.77, 0.7))  # of the record, and beyond whole periods of a period


def linear_twins(u: Values, y: Values, turn: float, sign: float) -> list[Values]:
    """Four twins (n,) of y, which follows OP u (n,); ``turn`` [samples] between turns of u, ``sign`` of the gain.

    >>> t = np.arange(800.0)
    >>> u = np.sin(t / 15) + np.sin(t / 47)
    >>> twins = linear_twins(u, 2.0 * u, 47.0, 1.0)
    >>> len(twins), bool(np.max(np.abs(twins[0] - 2.0 * u)) < 0.05)
    (4, True)
    """
    model = Lags(y, max(turn, 2.0), sign=sign)
    left = model.residual(u, model.fit(u[:, None])[0])
    twins = []
    for share, beyond in SHIFTS:
        shift = (round(0.5 * share * len(left) / turn) + beyond) * 2.0 * turn
        twin = y.copy()
        twin[model.rows] += np.roll(left, round(shift)) - left
        twins.append(twin)
    return twins
