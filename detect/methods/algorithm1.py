"""Algorithm 1 of Kvam, NTNU 2009 (page of section 6.3), exactly as printed: for reproduction, not for use.

    for i = 2 .. N-1:
        SIGN = sign(Y(i) - Y(i-1))
        zero crossing between Y(i) and Y(i+1):
            A1 or A2 zero -> BREAK;   A1 > 0 -> R = A1/A2;   A1 < 0 -> R = A2/A1;   A1 = A2 = 0
        SIGN = +1: A1 += trapezoid(i, i+1);   SIGN = -1: A2 += trapezoid(i, i+1)

BREAK is read in two ways. The text of the thesis says that "a new iteration is done" with no action, which is
"next" here and gives the published figures; taken literally it leaves the loop, which is "stop".

Known faults, kept on purpose: the slope looks back while the area looks ahead, so the interval right after
each peak falls to the wrong side (the sine of Fig. 6.1a gives 1.025, printed 1.03); held samples count on
neither side; the interval of the crossing is dropped; the first, cut half cycle counts; a bad half cycle leaves
its areas to the next one. ``area_ratio`` mends all of them.

It has no card, and ``area_ratio`` stands for it among the methods, because its printed rule (R > 1 stiction, R near 1
aggressive control, no tolerance given) cannot tell the two.  Measured: the interval on the wrong side alone gives a
clean sine R = 1.03 at 500 samples a period, 1.31 at 50 and 1.8 at 23, while a loop that sticks by 6 % falls from R =
20 to 2.3 with noise of 1 % of its wave, to 1.26 with 5 % and to 0.98 with 15 %.  No threshold parts these.
"""

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from stickslip.logs.arrays import Values

BreakMeans = Literal["next", "stop"]


@dataclass(frozen=True, eq=False)
class Result:
    """All R in order, shape (m,), and the crossing times at which each was computed [s], shape (m,)."""

    R: Values
    t: Values

    @property
    def mean(self) -> float:
        """Mean of R as the thesis reports it [-]; NaN when there is none."""
        return float(np.mean(self.R)) if len(self.R) else math.nan

    @property
    def std(self) -> float:
        """Standard deviation of R, n - 1 in the denominator as in Matlab [-]; NaN below two."""
        return float(np.std(self.R, ddof=1)) if len(self.R) > 1 else math.nan


class State(NamedTuple):
    """Two last samples (t, y), both areas [unit s], and whether a literal BREAK ended the run."""

    t0: float = math.nan
    y0: float = math.nan
    t1: float = math.nan
    y1: float = math.nan
    A1: float = 0.0
    A2: float = 0.0
    stopped: bool = False


def init() -> State:
    """The state before the first sample."""
    return State()


def update(state: State, t: float, y: float, break_means: BreakMeans = "next") -> tuple[State, float | None]:
    """One more sample Y(i+1) at t [s]; returns the state and R when a half cycle closed, else None."""
    if state.stopped:
        return state, None
    if math.isnan(state.y0):
        return state._replace(t0=state.t1, y0=state.y1, t1=t, y1=y), None
    moved = state._replace(t0=state.t1, y0=state.y1, t1=t, y1=y)
    slope = state.y1 - state.y0
    if state.y1 * y < 0 or (state.y1 != 0 and y == 0):
        if state.A1 == 0 or state.A2 == 0:
            return moved._replace(stopped=break_means == "stop"), None
        R = state.A1 / state.A2 if state.A1 > 0 else state.A2 / state.A1
        return moved._replace(A1=0.0, A2=0.0), R
    area = 0.5 * (state.y1 + y) * (t - state.t1)
    if slope > 0:
        return moved._replace(A1=state.A1 + area), None
    if slope < 0:
        return moved._replace(A2=state.A2 + area), None
    return moved, None


def ratios(t: npt.ArrayLike, y: npt.ArrayLike, break_means: BreakMeans = "next") -> Result:
    """Every R of the control error y, shapes (n,), t [s].

    A sample at exactly zero counts as the crossing from the sample before it, which the thesis leaves open.

    >>> t = np.arange(0, 600.05, 0.1)
    >>> result = ratios(t, 0.075 * np.sin(2 * np.pi * t / 50))
    >>> round(result.mean, 3), round(result.std, 3)
    (1.025, 0.0)

    Raises ValueError when t and y differ in length or ``break_means`` is neither "next" nor "stop".
    """
    times, values = np.asarray(t, dtype=float), np.asarray(y, dtype=float)
    if times.shape != values.shape or times.ndim != 1:
        raise ValueError(f"t has shape {times.shape}, y {values.shape}; give two arrays of equal length")
    if break_means not in ("next", "stop"):
        raise ValueError(f"break_means = {break_means!r}; give 'next' or 'stop'")
    state, found = init(), []
    for ti, yi in zip(times.tolist(), values.tolist(), strict=True):
        state, R = update(state, ti, yi, break_means)
        if R is not None:
            found.append((R, ti))
    array = np.array(found, dtype=float).reshape(-1, 2)
    return Result(array[:, 0], array[:, 1])
