"""From one row to the next in one step, where no controller and no stop of a valve is at a limit.

    z_k+1 = A z_k + B u_k,   x_k = W z_k + V u_k           x: OPs, and the opening that a valve with stops is told
    z_k+E = A^E z_k + sum_i A^(E-1-i) B u_k+i              E scans between two rows

The same numbers as scan by scan, but for rounding; whether x stays within its limits is looked at scan by scan.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.filters import laws
from stickslip.gap.filters.scanned import Scanned

Floats = NDArray[np.float64]


class Jumps(NamedTuple):
    """What follows from z at a row: ``ahead`` (n, every x checked + n), x at each scan until the next row, then z then;
    ``seen`` (signals, n) the logged signals; ``at_row`` (rows, signals + every x checked + n) what inputs add, no rows
    where there are no such steps; ``whole`` A^E; ``grown`` (n, n) and ``loose`` (every, checked), what the noise since
    the row adds to the variance of z and of x.
    """

    ahead: Floats
    seen: Floats
    at_row: Floats
    whole: Floats
    grown: Floats
    loose: Floats


NOWHERE = Jumps(*(np.zeros((0, 0)) for _ in range(6)))


def lifted(one: Scanned, U: Floats, every: int, law: int) -> Jumps:
    """Return the steps from row to row; ``U`` inputs at each scan (scans, kinds), ``law`` of the valve: none or stops.

    A law that bends everywhere has none.
    """
    n, C, kinds = one.n, len(one.v), U.shape[1]
    given = np.zeros((C + 1, n + kinds))  # over [z, u]
    given[:C, :n] = one.free
    stops = law == laws.STOPS and one.told is not None
    for c in range(C):
        given[c, n:] = one.v[c, n + C + 1 :] + one.v[c, n : n + c] @ given[:c, n:]
    if stops and one.told is not None:
        given[C] = _along(one.told, given, n, C, 0.0)
    rows = np.stack([_along(row, given, n, C, 1.0 if stops else 0.0) for row in (*one.H, *one.F)])
    m = len(one.H)
    A, B = rows[m:, :n], rows[m:, n:]
    parts, inputs = [], [np.hstack([rows[:m, n:], np.zeros((m, (every - 1) * kinds))])]
    now, then = np.eye(n), np.zeros((n, every * kinds))
    grown, loose = np.zeros((n, n)), np.zeros((every, C + 1))
    for k in range(every):
        loose[k] = np.einsum("ci,ij,cj->c", given[:, :n], grown, given[:, :n])
        grown = A @ grown @ A.T + one.Q
        parts.append(given[:, :n] @ now)
        by = given[:, :n] @ then
        by[:, k * kinds : (k + 1) * kinds] += given[:, n:]
        inputs.append(by)
        now, then = A @ now, A @ then
        then[:, k * kinds : (k + 1) * kinds] += B
    count = (len(U) - 1) // every
    u = U[: count * every].reshape(count, every * kinds)
    at_row = u @ np.vstack([*inputs, then]).T
    ahead = np.ascontiguousarray(np.vstack([*parts, now]).T)
    return Jumps(ahead, np.ascontiguousarray(rows[:m, :n]), at_row, now, grown, loose)


def _along(row: Floats, given: Floats, n: int, C: int, stops: float) -> Floats:
    """Return a row over [z, OPs, MV, u] as one over [z, u]."""
    found = np.concatenate([row[:n], row[n + C + 1 :]])
    return np.asarray(found + row[n : n + C] @ given[:C] + stops * row[n + C] * given[C])
