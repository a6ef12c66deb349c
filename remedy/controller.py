"""Read a controller off OP, SP and PV: gain, integral and derivative time, filter.

    over m rows     OP_k - OP_(k-m) = K_p (e_k - e_(k-m)) + K_p dt/T_i sum_(k-m <= j < k) e_j
                                      - K_p T_d (D_k - D_(k-m)),   D_k = (PV_k - PV_(k-1)) / dt

That is the law whose integral takes in the error of the last scan.  One that takes in the present error is the same law
with other numbers: K_p and T_i of that one read as K_p (1 + dt/T_i) and T_i + dt.
A line through all rows in which OP stands at no limit; m is chosen so that K_p and K_p/T_i are known best: short
spans suit a log of every scan, long ones a log that is rounded or coarser than the scan.  Without SP its level is one
more unknown.  A derivative, a first-order filter of PV, or both, are taken where they leave a tenth less.  A filter of
the derivative alone, K_p (1 + 1/(T_i s) + T_d s/(T_f s + 1)), is a filter of all: K_p (1 + T_f/T_i), T_i + T_f.
Source: textbook, the velocity form (Astrom and Hagglund, Advanced PID Control, 2006, section 3.6).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stickslip.logs.arrays import Values
from stickslip.logs.normal import Z90

__all__ = ["Controller", "controller_of"]

SPANS = (1, 4, 16, 64)  # rows
LESS = 0.9  # of what is left, that a derivative or a filter must get below
FILTERS = (0.7, 1.4, 2.8, 5.6, 11.0, 22.0, 45.0)  # rows, that are tried
HAND = 20.0  # times what the law leaves in the median: a move by hand
AT_LIMIT = 8  # rows at an extreme of OP that make it a limit
EXACT = 1.0 - 1e-9  # of the moves of OP, from which on nothing is left to tell
LEAST = 0.5  # of the moves of OP that the law must tell


@dataclass(frozen=True)
class Controller:
    """The law that OP follows.

    K_p : signed, positive where OP falls with PV [unit of OP / unit of PV];  T_i, T_d, dt : [s];  T_i = inf: none
    K_p_sd, rate_sd : standard deviations of K_p and of K_p/T_i;  low, high : limits of OP [its unit]
    explained : share of OP's moves that the law tells;  T_f : of a first-order filter of PV [s]
    span : rows over which it was read
    """

    K_p: float
    T_i: float
    T_d: float
    dt: float
    low: float
    high: float
    explained: float
    K_p_sd: float
    rate_sd: float
    T_f: float = 0.0
    span: int = 0

    @property
    def form(self) -> str:
        """P, PI or PID."""
        return f"P{'I' if math.isfinite(self.T_i) else ''}{'D' if self.T_d > 0.0 else ''}"

    @property
    def present(self) -> tuple[float, float]:
        """K_p and T_i of the same law whose integral takes in the present error, a filter its derivative alone."""
        late = self.dt + (self.dt / math.expm1(self.dt / self.T_f) if self.T_f > 0.0 and self.T_d > 0.0 else 0.0)
        if not self.T_i > late:
            return self.K_p, self.T_i
        return self.K_p * (1.0 - late / self.T_i), self.T_i - late

    @property
    def middle(self) -> tuple[float, float]:
        """K_p and T_i between both forms, which a controller that scans much faster than the log has as well."""
        K_p, T_i = self.present
        return 0.5 * (self.K_p + K_p), self.T_i - 0.5 * (self.T_i - T_i if math.isfinite(self.T_i) else 0.0)

    def spread(self, key: str) -> tuple[float, float]:
        """The 90 % interval of K_p or T_i, whose upper end is infinite for a law without an integral."""
        if key == "K_p":
            return self.K_p - Z90 * self.K_p_sd, self.K_p + Z90 * self.K_p_sd
        rate = abs(self.K_p) / self.T_i
        most, least = rate + Z90 * self.rate_sd, max(rate - Z90 * self.rate_sd, 1e-9 * rate)
        low, high = (abs(self.K_p) / one if one > 0.0 else math.inf for one in (most, least))
        return low, high


def limits_of(op: Values, span: tuple[float, float] | None) -> tuple[float, float]:
    """The limits of OP: where it rests at an extreme for some rows, else its span, else none."""
    found = span or (-math.inf, math.inf)
    ends = (float(op.min()), float(op.max()))
    rests = [np.max(np.convolve(op == end, np.ones(AT_LIMIT), "valid")) > AT_LIMIT - 0.5 for end in ends]
    rests = [own and (span is None or ends[0] < ends[1]) for own in rests]
    return ends[0] if rests[0] else found[0], ends[1] if rests[1] else found[1]


def controller_of(
    op: Values, pv: Values, sp: Values | None, dt: float, limits: tuple[float, float], spans: Sequence[int] = SPANS
) -> Controller:
    """The law that OP (n,) follows on an even grid of ``dt`` [s]; its ``explained`` says how well.

    >>> e = np.random.default_rng(1).normal(size=500)
    >>> op = 2.0 * e + np.concatenate([[0.0], np.cumsum(2.0 * e / 10.0)[:-1]])
    >>> law = controller_of(op, -e, np.zeros(500), 1.0, (-np.inf, np.inf))
    >>> round(law.K_p, 6), round(law.T_i, 6), law.form
    (2.0, 10.0, 'PI')
    """
    e = -pv if sp is None else sp - pv
    free = (op > limits[0]) & (op < limits[1])
    found = [one for m in spans if 8 * m < len(op) if (one := _line(op, e, None, free, dt, m, sp))]
    if not found:
        return Controller(math.nan, math.inf, 0.0, dt, *limits, 0.0, math.nan, math.nan)
    _, b, sd, explained, m, left = min(found, key=lambda one: one[0])
    T_d = T_f = 0.0
    forms = [(False, True), (True, False), (True, True)] if explained < EXACT else []  # a filter of PV, a derivative
    for smooth, derivative in forms:
        law, late = _late(op, pv, free, dt, m, sp, smooth, derivative)
        if law and law[5] < LESS * left and not (derivative and law[1][2] * law[1][0] >= 0.0):
            _, b, sd, explained, _, left = law
            T_d, T_f = float(-b[2] / b[0]) if derivative else 0.0, late
    K_p, rate = float(b[0]), float(b[1])
    integrates = rate * K_p > 0.0 and abs(rate) > 3.0 * sd[1]
    return Controller(
        K_p, K_p / rate if integrates else math.inf, T_d, dt, *limits, explained, float(sd[0]), float(sd[1]), T_f, m
    )


_Line = tuple[float, Values, Values, float, int, float]


def _late(
    op: Values, pv: Values, free: NDArray[np.bool_], dt: float, m: int, sp: Values | None, smooth: bool, slopes: bool
) -> tuple[_Line | None, float]:
    """The law with a derivative (``slopes``) or not, behind the filter of PV that leaves least; its time constant."""
    from scipy.optimize import minimize_scalar
    from scipy.signal import lfilter

    def law(a: float) -> _Line | None:
        y = np.asarray(lfilter([1.0 - a], [1.0, -a], pv - pv[0])) + pv[0]
        slope = np.concatenate([[0.0], np.diff(y)]) / dt if slopes else None
        return _line(op, -y if sp is None else sp - y, slope, free, dt, m, sp)

    def left(log: float) -> float:
        found = law(math.exp(-1.0 / math.exp(log)))
        return found[5] if found else math.inf

    if not smooth:
        return law(0.0), 0.0
    start = math.log(min(FILTERS, key=lambda rows: left(math.log(rows))))
    rows = math.exp(float(minimize_scalar(left, bounds=(start - 0.8, start + 0.8), method="bounded").x))
    return law(math.exp(-1.0 / rows)), rows * dt


def _line(
    op: Values, e: Values, slope: Values | None, free: NDArray[np.bool_], dt: float, m: int, sp: Values | None
) -> _Line | None:
    """How badly gain and rate are known, coefficients, their spread, share explained, m, and what is left."""
    total = np.concatenate([[0.0], np.cumsum(e)[:-1]]) * dt  # without the error of the row itself
    integral = total[m:] - total[:-m]
    columns = [e[m:] - e[:-m], integral]
    if slope is not None:
        columns.append(slope[m:] - slope[:-m])
    if sp is None:
        columns.append(np.full(len(integral), m * dt))
    y = op[m:] - op[:-m]
    inside = np.concatenate([[0], np.cumsum(~free)])
    kept = (inside[m + 1 :] - inside[: -m - 1] == 0) & (np.arange(len(y)) > 1)
    X, y = np.column_stack(columns)[kept], y[kept]
    if len(y) < 10 * X.shape[1] or not np.any(y):
        return None
    size = np.sqrt(np.mean(X**2, axis=0)) + 1e-300
    b, *_ = np.linalg.lstsq(X / size, y, rcond=None)
    left = y - X / size @ b
    near = np.abs(left) <= 4.0 * np.median(np.abs(left)) + 1e-12 * np.ptp(y)  # moves by hand, tags that come late
    if np.mean(near) > 0.5:
        b, *_ = np.linalg.lstsq(X[near] / size, y[near], rcond=None)
        left, y = (y - X / size @ b)[near], y[near]
    variance = float(np.mean(left**2)) * m / len(left)
    sd = np.sqrt(np.maximum(variance * np.diag(np.linalg.pinv(X.T @ X / len(X) / np.outer(size, size))), 0.0)) / size
    b = b / size
    explained = max(1.0 - float(np.sum(left**2) / max(np.sum(y**2), 1e-300)), 0.0)
    known = (sd[0] / max(abs(b[0]), 1e-300)) ** 2 + (sd[1] / max(abs(b[1]), 1e-300)) ** 2
    return float(known), b, sd, explained, m, float(np.mean(left**2))


def moved_from_outside(law: Controller, op: Values, pv: Values, sp: Values | None) -> Values:
    """What moves OP (n,) and is not PV: SP through the controller's gain, and moves by hand."""
    e = -pv if sp is None else sp - pv
    own = law.K_p * np.diff(e) + (law.K_p / law.T_i) * law.dt * e[:-1]
    left = np.diff(op) - own
    by_hand = np.abs(left - np.median(left)) > HAND * np.median(np.abs(left)) + 1e-6 * np.ptp(op)
    moved = np.concatenate([[0.0], np.cumsum(left * by_hand)])
    return moved if sp is None else moved + law.K_p * sp


def series(law: Controller) -> tuple[float, float, float]:
    """K_p, T_i and T_d of the controller in series form, K_p without its sign; as they are without derivative."""
    K_p = abs(law.K_p)
    if law.T_d <= 0.0 or not math.isfinite(law.T_i):
        return K_p, law.T_i, law.T_d
    root = math.sqrt(max(1.0 - 4.0 * law.T_d / law.T_i, 0.0))
    share = 0.5 * (1.0 + root)
    return K_p * share, law.T_i * share, law.T_d / share
