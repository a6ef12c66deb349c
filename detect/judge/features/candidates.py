"""The PV to expect if the valve stuck: for several sizes, the steps of the stem, and the innovations of PV.

    x       stem for OP u, S a share of OP's travel, J = ``JUMP`` S (``stem.stick``)
    step    x_k - x_(k-1), over its root mean square
    new     y less its least-squares prediction from its past and the stem (``channels.innovations``), over the root
            mean square of the size that leaves least

Both are odd: they change sign if OP and PV do.  Where the stem is right, what is new is white noise; where it is not,
it shows when the stem in truth stood still and when it slipped.
"""

import numpy as np
from stickslip.detect.judge.features.channels import LAGS, innovations
from stickslip.detect.stem.stick import stick
from stickslip.logs.arrays import Values

SHARES = np.array((0.12, 0.22, 0.35, 0.5, 0.7, 0.9))  # S over the travel of OP
JUMP = 0.7  # J over S
CANDIDATES = 2 * len(SHARES)  # channels
MOST = 8.0  # a value is cut there


def candidates(u: Values, y: Values) -> Values:
    """The channels (``CANDIDATES``, n) of OP u and PV y (n,) [-] on 16 points a turn: steps of every size, then new.

    >>> u = np.sin(np.arange(200.0) / 5)
    >>> stems = candidates(u, np.roll(u, 1))
    >>> stems.shape, bool(np.all(stems[0] * np.diff(u, prepend=u[0]) >= 0.0))  # a stem moves as OP does, or not
    ((12, 200), True)
    """
    span = float(np.subtract(*np.percentile(u, (99, 1)))) or 1.0
    S = SHARES * span
    x = stick(u, S, JUMP * S, np.zeros(len(S))).T
    steps = np.diff(x, axis=1, prepend=x[:, :1])
    steps /= np.sqrt(np.mean(steps**2, axis=1, keepdims=True)) + 1e-6
    new = np.stack([innovations(one, y) for one in x])
    least = float(np.sqrt(np.min(np.mean(new[:, max(LAGS) :] ** 2, axis=1))))
    return np.asarray(np.clip(np.concatenate([steps, new / max(least, 1e-6)]), -MOST, MOST))
