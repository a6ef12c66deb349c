"""The signals that are searched for patterns: OP, PV, e, their steps, and the innovations of PV, on 16 points a turn.

    u, y, e     over their standard deviation              du, dy   steps over theirs
    r           y less its least-squares prediction from four past values of y and of u at lags 1, 2, 3, 5, 8
    w           travel of OP since it last turned, over its range

Those seven are odd: they change sign if OP and PV do.  Read along the way of OP, that is times the sign of w, they are
even, and every half cycle looks alike:   r, dy, |w|, e, du.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from stickslip.detect.judge.features.view import View

__all__ = ["EVEN", "ODD", "channels", "innovations", "since_turn"]

Values = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]

ODD, EVEN = 7, 5
TURN = 16.0  # points a turn
LOOKED_AT = 1000  # points of the view
LEAST, MOST = 60, 1024  # points
PAST, LAGS = (1, 2, 3, 4), (1, 2, 3, 5, 8)
CLIP = 6.0
BACK = 0.1  # of OP's range: a smaller way back is no turn
BINS = 10  # of the travel since a turn


def channels(v: View) -> tuple[Singles, Singles, Values]:
    """The odd (7, n) and even (5, n) channels, and ``since_turn``, (4 ``BINS``,)."""
    u, y, e = (_read(x[:LOOKED_AT], v.turn) for x in (v.u, v.y, v.e))
    r = innovations(u, y)
    r = np.clip(r / max(float(r.std()), 1e-6), -CLIP, CLIP)
    span = float(np.subtract(*np.percentile(u, (99, 1)))) or 1.0
    w = _travelled(u, BACK * span) / span
    du, dy = (_over(np.diff(x, prepend=x[0])) for x in (u, y))
    way = np.where(w >= 0.0, 1.0, -1.0)
    steps, moves = np.clip(dy, -CLIP, CLIP), np.clip(du, -CLIP, CLIP)
    odd = np.stack([u, y, e, moves, steps, r, 2.0 * w])
    even = np.stack([r * way, steps * way, 2.0 * np.abs(w), e * way, moves * way])
    return odd.astype(np.float32), even.astype(np.float32), since_turn(w, r, dy)


def since_turn(w: Values, r: Values, dy: Values) -> Values:
    """Mean of r and of dy along the way of OP, and of their squares, by the travel of OP since it turned.

    A sticky valve leaves PV behind at first, then lets it go at once, where OP has travelled by S.
    """
    at = np.clip((np.abs(w) * BINS).astype(np.intp), 0, BINS - 1)
    way = np.where(w >= 0.0, 1.0, -1.0)
    count = np.bincount(at, minlength=BINS) + 1.0
    sums = [np.bincount(at, x, minlength=BINS) for x in (way * r, r * r, way * dy, dy * dy)]
    return np.concatenate([sums[0] / np.sqrt(count), *(s / count for s in sums[1:])])


def _read(x: Values, turn: float) -> Values:
    """A signal on the common points, over its spread."""
    n = len(x)
    m = max(min(int((n - 1) * TURN / turn), MOST), LEAST)
    at = np.arange(m) * min(turn / TURN, (n - 1) / m)
    return _over(np.interp(at, np.arange(n), x))


def _over(x: Values) -> Values:
    d = x - x.mean()
    return np.asarray(d / (float(d.std()) + 1e-9))


def innovations(u: Values, y: Values) -> Values:
    """The innovations of y (n,) given its past and u (n,): ``r`` of the module, zero where the past is short."""
    deep, n = max(LAGS), len(u)
    past = [y[deep - k : n - k] for k in PAST] + [u[deep - k : n - k] for k in LAGS]
    columns = np.stack([np.ones(n - deep), *past])
    gram = columns @ columns.T
    gram[np.diag_indices(len(gram))] += 1e-6 * np.trace(gram) / len(gram)
    left = y[deep:] - np.linalg.solve(gram, columns @ y[deep:]) @ columns
    return np.concatenate([np.zeros(deep), left])


def _travelled(u: Values, back: float) -> Values:
    from stickslip.detect.judge.features.convolutions import travelled

    return np.asarray(travelled(u, back))
