"""A linear diagram from one row of a log to the next, over all scans between them.

    z' = A z + sum over scans of  B_k u_k + w,   w ~ N(0, Q),      y = H z + G u          y: logged signals at a row

Where a controller scans more slowly than the fastest block, rows differ by when it scans next: each such kind of row
has matrices of its own.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.exact.scanned import Scanned
from stickslip.logs.arrays import Values


@dataclass(frozen=True, eq=False)
class Rows:
    """``A`` (kinds, n, n), ``Q`` (kinds, n, n), ``H`` (kinds, signals, n); ``inputs`` how signals at a row, then z at
    the next, follow u at the scans of the row, (kinds, signals + n, scans x u); ``firsts`` the scan, of a ``turn`` of
    all controllers, at which each kind of row begins; ``start`` and ``variance`` of z at first; ``memory`` of
    controllers, ``of`` which each is.
    """

    A: Values
    Q: Values
    H: Values
    inputs: Values
    firsts: NDArray[np.int64]
    turn: int
    start: Values
    variance: Values
    memory: NDArray[np.int64]
    of: NDArray[np.int64]

    def kinds(self, rows: int, every: int) -> NDArray[np.int64]:
        """Return of which kind each row is."""
        return np.searchsorted(self.firsts, every * np.arange(rows) % self.turn)

    def added(self, u: Values, every: int, kind: NDArray[np.int64]) -> Values:
        """Return what inputs ``u`` (scans, kinds of inputs) add at each row, (rows, signals + n)."""
        each = np.vstack([u, np.repeat(u[-1:], every - 1, axis=0)])[: len(kind) * every].reshape(len(kind), -1)
        found = np.empty((len(kind), self.inputs.shape[1]))
        for i, inputs in enumerate(self.inputs):
            found[kind == i] = each[kind == i] @ inputs.T
        return found


def by_rows(one: Scanned, every: int, variance: Values) -> Rows:
    """Return the steps of a diagram from row to row; a row comes ``every`` scans; ``variance`` of z at first."""
    n, m, q = one.n, len(one.H), len(one.kinds)
    turn = math.lcm(*one.period.tolist())
    firsts = np.unique(every * np.arange(turn) % turn)
    known = [one.closed(k) for k in range(turn)]
    A, Q, H = (np.empty((len(firsts), *shape)) for shape in ((n, n), (n, n), (m, n)))
    inputs = np.zeros((len(firsts), m + n, every * q))
    for i, first in enumerate(firsts.tolist()):
        now, then, spread = np.eye(n), np.zeros((n, every * q)), np.zeros((n, n))
        H[i], inputs[i, :m, :q] = np.split(known[first][1], [n], axis=1)
        for k in range(every):
            F, B = np.split(known[(first + k) % turn][0], [n], axis=1)
            now, then, spread = F @ now, F @ then, F @ spread @ F.T + one.Q
            then[:, k * q : (k + 1) * q] += B
        A[i], Q[i], inputs[i, m:] = now, spread, then
    return Rows(A, Q, H, inputs, firsts, turn, one.start, variance, one.memory, one.of)
