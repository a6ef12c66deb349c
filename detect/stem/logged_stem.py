"""S, J and the positioner from a logged stem: MV stands, breaks away and slips, and OP says how far it had to go.

S = travel of OP until the stem moves after a reversal        J = how much further than OP beyond S it then goes
level = offset + gain OP at rest - c (S - J)/2, with c the way the stem came
"""

import math
from typing import NamedTuple

import numpy as np
from stickslip.detect.stem.stem_noise import rounding
from stickslip.logs.arrays import Indices, Values
from stickslip.logs.normal import half_of_median

LATEST = 3  # samples that the stem may be late, at most
SLIP_SAMPLES = 4  # samples that a slip may last
PACED_SHARE = 0.75  # of what OP moves in the sample in which the stem goes: smaller jumps cannot be separated from that


class Stem(NamedTuple):
    """S and J, each (value, low, high) [unit of u], NaN where there is no reversal; deadband S - J.

    offset [unit of mv], gain [-], gain_known : whether it was fitted; lag [samples]; scatter of S [-]
    step : what OP's own moves from sample to sample may make look like a jump [unit of u]
    S_each, J_each : (r,); first, last : (m,) samples of the stands
    """

    S: tuple[float, float, float]
    J: tuple[float, float, float]
    offset: float
    gain: float
    gain_known: bool
    lag: int
    scatter: float
    step: float
    S_each: Values
    J_each: Values
    first: Indices
    last: Indices


def stem(
    u: Values, mv: Values, sigma: float = 0.0, free: tuple[float, float] = (-math.inf, math.inf), latest: int = LATEST
) -> Stem:
    """Read the stem mv (n,) with noise sigma against OP u (n,), where it stands between the two places ``free``.

    It may be up to ``latest`` samples late.

    >>> from stickslip.detect.stem.stick import stick
    >>> t = np.arange(2000.0)
    >>> u = 5 * np.sin(t / 40) + np.sin(t / 171)
    >>> found = stem(u, 2.0 + 0.5 * stick(u, 4.0, 1.5))
    >>> round(found.S[0], 1), round(found.J[0], 1), round(found.offset, 1), round(found.gain, 1)
    (4.0, 1.5, 2.0, 0.5)
    """
    first, last = _stands(mv, max(4.5 * sigma, 1e-6 * float(np.ptp(mv))))
    inside = np.array(
        [free[0] < np.mean(mv[a : b + 1]) < free[1] for a, b in zip(first, last, strict=True)], dtype=bool
    )
    first, last = first[inside], last[inside]
    readings = [
        _read(u[: len(u) - lag] if lag else u, mv[lag:], first - lag, last - lag, lag) for lag in range(latest + 1)
    ]
    at_once, later = readings[0], min(readings, key=lambda r: r.scatter)
    even = at_once.scatter * at_once.S[0] <= at_once.step  # no more than OP's sampling makes: no delay to look for
    return later if later.scatter < 0.5 * at_once.scatter and not even else at_once


def band(u: Values, mv: Values) -> float:
    """How far OP and the stem, brought to its scale, stray from each other: range but for 1 %, least over the lags.

    A stick makes it S + J, because the stem stands between f_S above and f_S below its place.
    """
    least = math.inf
    for lag in range(LATEST + 1):
        x, y = u[: len(u) - lag] - np.mean(u), mv[lag:] - np.mean(mv)
        gain = float(x @ y) / max(float(x @ x), 1e-300)
        if gain > 0.0:
            apart = x - y / gain
            least = min(least, float(np.percentile(apart, 99.5) - np.percentile(apart, 0.5)))
    return least


def _stands(mv: Values, within: float) -> tuple[Indices, Indices]:
    """First and last sample of every stand of three samples or more: MV stays ``within`` of its mean so far."""
    first, last = [], []
    start, mean = 0, float(mv[0])
    for k, value in enumerate(mv.tolist()):
        if abs(value - mean) > within:
            if k - start >= 3:
                first.append(start)
                last.append(k - 1)
            start, mean = k, value
        else:
            mean += (value - mean) / (k - start + 1)
    return np.array(first, dtype=np.intp), np.array(last, dtype=np.intp)


def _read(u: Values, mv: Values, first: Indices, last: Indices, lag: int) -> Stem:
    """S, J and the positioner from the stands, those at the ends of the record left out."""
    inside = (first > 0) & (last + 1 < len(mv))
    first, last = first[inside], last[inside]
    level = np.array([np.mean(mv[a : b + 1]) for a, b in zip(first, last, strict=True)])
    came, went = np.sign(level - mv[first - 1]), np.sign(mv[last + 1] - level)
    rest, before, after = u[first], np.abs(u[last] - u[first]), np.abs(u[last + 1] - u[first])
    travel = 0.5 * (before + after)
    toward = (u[last + 1] - rest) * went > 0.0  # else noise, or another cause than OP
    back, on = toward & (came != went), toward & (came == went)
    S_each, step = travel[back], float(np.median(np.abs(after - before)[back])) if back.any() else math.nan
    S = _middle(S_each, step)
    moved = np.abs([rest - u[first - 1], u[first - 1] - u[np.maximum(first - 2, 0)]])  # OP may turn as the stem rests
    offset, gain, known = _positioner(rest, level, came, np.maximum(np.max(moved, axis=0), rounding(u)))
    # noise breaks a slow slide into stands that are none, so that those that go on tell only where none turns back
    J_each = (
        _slips(u, mv / abs(gain), rest[back], level[back] / abs(gain), last[back], S[0]) if back.any() else travel[on]
    )
    scatter = float(np.percentile(S_each, 75) - np.percentile(S_each, 25)) / S[0] if len(S_each) > 1 else math.inf
    J = _middle(J_each, step)
    step = max(PACED_SHARE * step, rounding(u)) if back.any() else step
    return Stem(
        S, (max(J[0], 0.0), max(J[1], 0.0), max(J[2], 0.0)), offset, gain, known, lag, scatter, step, S_each, J_each,
        first + lag, last + lag,
    )  # fmt: skip


def _slips(u: Values, mv: Values, rest: Values, level: Values, last: Indices, S: float) -> Values:
    """J of every stand (r,) [unit of u]: how much further than OP beyond S the stem goes in ``SLIP_SAMPLES`` samples.

    Without a jump the stem keeps S behind OP from the first of them on; air and mass make a slip last for several.
    """
    best = gone = beyond = np.zeros(len(last))
    on = np.ones(len(last), dtype=bool)
    for k in range(1, SLIP_SAMPLES + 1):
        at = np.minimum(last + k, len(u) - 1)
        on &= np.abs(u[at] - rest) >= beyond  # behind a turn of OP a stem that merely lags goes on as well
        beyond = np.abs(u[at] - rest)
        gone = np.where(on, np.abs(mv[at] - level) - (beyond - S), gone)
        if k == 1 or np.median(gone) > np.median(best):
            best = gone
    return best


def _middle(each: Values, step: float) -> tuple[float, float, float]:
    """Median with its 90 % interval, for normal scatter, widened by what one sample of OP leaves open."""
    if not len(each):
        return math.nan, math.nan, math.nan
    middle, half = float(np.median(each)), half_of_median(each, step / math.sqrt(12.0))
    return middle, middle - half, middle + half


def _positioner(rest: Values, level: Values, came: Values, steps: Values) -> tuple[float, float, bool]:
    """a, b of level = a + b rest - c came, and whether b is known to 10 %; else b = 1 and a from the means.

    OP at rest is known to within its last step or its rounding (``steps``). What scatters so makes b too small, by its
    share in the variance of OP at rest, and in an even cycle OP rests at nearly the same value each time.
    """
    own = rest - np.array([np.mean(rest[came == way]) for way in came.tolist()])
    blurred = float(steps @ steps) / 12.0 > 0.1 * float(own @ own)
    if len(rest) >= 6 and len(np.unique(came)) > 1 and not blurred:
        terms = np.column_stack([np.ones(len(rest)), rest, -came])
        terms[:, 1] -= np.mean(rest)
        solution = np.linalg.lstsq(terms, level, rcond=None)[0]
        left = level - terms @ solution
        try:
            error = math.sqrt(float(left @ left) / (len(rest) - 3) * float(np.linalg.inv(terms.T @ terms)[1, 1]))
        except np.linalg.LinAlgError:
            error = math.inf
        if error < 0.1 * abs(solution[1]):
            return float(solution[0] - solution[1] * np.mean(rest)), float(solution[1]), True
    gap = float(np.mean(level) - np.mean(rest)) if len(rest) else 0.0
    return gap, 1.0, False
