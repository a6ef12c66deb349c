"""A record as rows of an autoregression: PV against its own past and the past of OP or of a stem.

    thinned   means of q samples, q = samples between two turns of OP over ``ROWS_A_TURN``; the stem runs at full rate
    row t     y(t) from 1, t, y(t-1) .. y(t-a) and w(t-k) .. w(t-k-b+1),   k >= 1

PV answers OP one row late at the earliest, so each row's likelihood is that of the closed loop: OP was made of the
past.  With k = 0 the controller would be inverted.  No row is asked for where PV and OP both stand to the bit, which is
stale collection, or OP stands at an extreme of its own, which is a limit.
"""

import math
from typing import NamedTuple

import numpy as np
from stickslip.detect.signals.runs import runs
from stickslip.detect.stem.recent import blocks, recent
from stickslip.detect.stem.stick import turns
from stickslip.logs.arrays import Mask, Values

ROWS_A_TURN = 25.0  # rows between two turns of OP: enough for the shape of a stick's answer, few enough to look ahead
ROWS_MIN = 400  # a record is not thinned below
SAMPLES_MAX = 3_000  # samples that are looked at, as long as OP turns often in them
TURN_SHARE = 0.3  # of OP's travel: a smaller way back is no turn
STALE, AT_LIMIT = 3, 8  # samples in a row
LATEST_ROWS = 32  # rows that a row may look back


class Rows(NamedTuple):
    """One record, thinned.

    op : (m,) at full rate [unit of OP]; y : (n,) PV over its spread [-]; used : (n - LATEST_ROWS,) rows that count
    travel : P98 - P2 of OP [its unit]; middle : its mean; q : samples in a row; turned : turns of OP
    floor : least spread of an error, from PV's resolution [-]
    """

    op: Values
    y: Values
    used: Mask
    travel: float
    middle: float
    q: int
    turned: int
    floor: float

    def input(self, x: Values) -> Values:
        """Stems or OP at full rate (m, ...) as inputs of the rows (n, ...), over OP's travel [-]."""
        n = len(self.y)
        return np.asarray((x[: n * self.q].reshape(n, self.q, *x.shape[1:]).mean(axis=1) - self.middle) / self.travel)

    @property
    def between(self) -> float:
        """Samples of the record between two turns of OP."""
        return len(self.op) / (self.turned + 1.0)


def past(x: Values, first: int, count: int) -> Values:
    """x (n, ...) of ``first`` to ``first + count - 1`` rows ago, for the rows from ``LATEST_ROWS`` on, (n', count, ...)

    >>> past(np.arange(35.0), 1, 2).tolist()
    [[31.0, 30.0], [32.0, 31.0], [33.0, 32.0]]
    """
    return np.stack([x[LATEST_ROWS - k : len(x) - k] for k in range(first, first + count)], axis=1)


def rows_of(op: Values, pv: Values) -> Rows | None:
    """The rows of OP and PV (m,) on an even grid; None where either stands.

    >>> t = np.arange(1000.0)
    >>> found = rows_of(np.sin(t / 40), np.cos(t / 40))
    >>> found.q, found.turned, round(found.between)
    (2, 8, 111)
    """
    start = recent(op, SAMPLES_MAX)
    op, pv = op[start:], pv[start:]
    travel, spread = float(np.subtract(*np.percentile(op, [98, 2]))), float(np.std(pv))
    if not (travel > 1e-9 * float(np.max(np.abs(op))) and spread > 1e-9 * float(np.max(np.abs(pv)))):
        return None
    turned = len(turns(op, TURN_SHARE * travel))
    q = max(1, min(int(len(op) / (turned + 1) / ROWS_A_TURN), len(op) // ROWS_MIN))
    stale = np.concatenate([[False], (np.diff(op) == 0.0) & (np.diff(pv) == 0.0)])
    limit = (op == np.max(op)) | (op == np.min(op))
    unused = blocks((_runs(stale, STALE) | _runs(limit, AT_LIMIT)).astype(float), q) > 0.0
    used = ~unused[LATEST_ROWS:]
    step = float(np.min(np.diff(np.unique(pv)))) / spread
    y = blocks((pv - np.mean(pv)) / spread, q)
    return Rows(op, y, used, travel, float(np.mean(op)), q, turned, max(1e-4, step / math.sqrt(12.0 * q)))


def _runs(x: Mask, least: int) -> Mask:
    """True in the runs of at least so many True."""
    found = np.zeros(len(x), dtype=np.bool_)
    for first, end in zip(*runs(x), strict=True):
        found[first:end] = end - first >= least
    return found
