"""How straight a log is: a historian that compresses draws lines between the values that it kept."""

import numpy as np
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.records.record import Digits
from stickslip.logs import Log
from stickslip.logs.arrays import Values

SIZES = 13  # deviations that are tried
ROUNDS = 3
LEAST, MOST = 1e-3, 1.0  # of the range of a signal: no deviation beyond these leaves a record to look at


def lined(values: Values, step: float | Values) -> float:
    """Return the share of three neighbours that lie on a line, equal ones too, within the rounding ``step`` of each.

    >>> lined(np.array([0.0, 1.0, 2.0, 2.0, 2.0, 5.0]), 0.0)
    0.5
    """
    bend, near = np.abs(np.diff(values, 2)), 1.01 * _coarsest(values, step) + 1e-9
    known = np.isfinite(bend)
    return float(np.mean((bend <= near)[known])) if known.any() else 0.0


def sloping(values: Values, step: float | Values) -> float:
    """Return the share of three neighbours on a line that are not all equal, within the rounding ``step`` of each.

    >>> sloping(np.array([0.0, 1.0, 2.0, 2.0, 2.0, 5.0]), 0.0)
    0.25
    """
    bend, rise = np.abs(np.diff(values, 2)), np.abs(np.diff(values))
    near = 1.01 * _coarsest(values, step) + 1e-9 * float(np.nanmax(np.abs(values), initial=0.0))
    moved = (rise[1:] > 0.0) | (rise[:-1] > 0.0)
    return float(((bend <= near) & moved).mean()) if len(bend) else 0.0


def corners(values: Values, step: float | Values) -> float:
    """Return the share of bends that are corners: three neighbours off a line, beside two threes that lie on one.

    A historian's lines meet in corners, and a smooth signal bends by degrees.  Rounding bends a line by up to two
    steps.

    >>> corners(np.array([0.0, 1.0, 2.0, 3.0, 3.5, 4.0, 4.5]), 0.0)
    1.0
    >>> corners(np.linspace(0.0, 1.0, 9) ** 2, 0.0)
    0.0
    """
    bend = np.abs(np.diff(values, 2))
    near = 1.01 * _coarsest(values, step) + 1e-9 * float(np.nanmax(np.abs(values), initial=0.0))
    bent, straight = bend > 2.0 * near, bend <= near
    return float(np.sum(bent[1:-1] & straight[:-2] & straight[2:])) / max(float(np.sum(bent)), 1.0)


def _coarsest(values: Values, step: float | Values) -> Values:
    """Return the coarsest rounding of three neighbours."""
    steps = np.broadcast_to(np.asarray(step, dtype=float), np.shape(values))
    return np.asarray(np.maximum(np.maximum(steps[:-2], steps[1:-1]), steps[2:]))


def deviation_of(log: Log, effect: Effect, place: str, signal: str, values: Values) -> float:
    """Return the deviation of a compression that makes a signal of a log as straight as ``values`` [its unit].

    Equal neighbours count, so that more deviation is never less straight.
    """
    digits = Digits.of(values)
    wanted = lined(values, digits.steps(values))
    low, high = (share * float(np.ptp(log[signal])) for share in (LEAST, MOST))
    for _ in range(ROUNDS):
        sizes = np.geomspace(low, high, SIZES)
        shares = []
        for size in sizes:
            made = effect.on_log(log, place, deviation=float(size))[signal]
            shares.append(lined(digits.rounded(made), digits.steps(made)))
        k = int(np.clip(np.searchsorted(np.maximum.accumulate(shares), wanted), 1, len(sizes) - 1))
        low, high = float(sizes[k - 1]), float(sizes[k])
    return float(np.sqrt(low * high))
