"""The signals that the network looks at: OP, PV, e, their steps, and what is new in PV, on 16 points a turn.

    u, y, e     over their standard deviation              du, dy   steps over theirs
    r           y less its least-squares prediction from four past values of y and of u at lags 1, 2, 3, 5, 8
    w           travel of OP since it last turned, over its range

Those seven are odd: they change sign if OP and PV do.  Read along the way of OP, that is times the sign of w, they are
even, and every half cycle looks alike:   r, dy, |w|.
"""

import numpy as np
import numpy.typing as npt
from stickslip.detect.judge.features.view import View
from stickslip.logs.arrays import Values

Singles = npt.NDArray[np.float32]

ODD, EVEN = 7, 3
TURN = 16.0  # points a turn
LOOKED_AT = 1000  # points of the view
LEAST, MOST = 60, 1024  # points
PAST, LAGS = (1, 2, 3, 4), (1, 2, 3, 5, 8)
CLIP = 6.0
BACK = 0.1  # of OP's range: a smaller way back is no turn


def channels(v: View) -> tuple[Singles, Singles]:
    """The odd (7, n) and even (3, n) channels."""
    from stickslip.detect.judge.features.travel_kernels import travelled

    u, y, e = (_read(x[:LOOKED_AT], v.turn) for x in (v.u, v.y, v.e))
    r = innovations(u, y)
    r = np.clip(r / max(float(r.std()), 1e-6), -CLIP, CLIP)
    span = float(np.subtract(*np.percentile(u, (99, 1)))) or 1.0
    w = np.asarray(travelled(u, BACK * span)) / span
    du, dy = (_over(np.diff(x, prepend=x[0])) for x in (u, y))
    way = np.where(w >= 0.0, 1.0, -1.0)
    steps, moves = np.clip(dy, -CLIP, CLIP), np.clip(du, -CLIP, CLIP)
    odd = np.stack([u, y, e, moves, steps, r, 2.0 * w])
    even = np.stack([r * way, steps * way, 2.0 * np.abs(w)])
    return odd.astype(np.float32), even.astype(np.float32)


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
    """What is new in y (n,) beside its past and u (n,): ``r`` of the module, zero where the past is short."""
    deep, n = max(LAGS), len(u)
    past = [y[deep - k : n - k] for k in PAST] + [u[deep - k : n - k] for k in LAGS]
    columns = np.stack([np.ones(n - deep), *past])
    gram = columns @ columns.T
    gram[np.diag_indices(len(gram))] += 1e-6 * np.trace(gram) / len(gram)
    left = y[deep:] - np.linalg.solve(gram, columns @ y[deep:]) @ columns
    return np.concatenate([np.zeros(deep), left])
