"""One signal over time in a panel: broken where samples are missing, crossed where bad, gaps shaded, ticks readable."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from stickslip.logs.style import COLOURS, PALE, tidy
from stickslip.logs.thinned import POINTS, envelope, thinned

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from stickslip.logs.arrays import Mask, Values
    from stickslip.logs.log import Log
    from stickslip.logs.time_axis import TimeAxis

__all__ = ["broken_at_gaps", "draw_signal", "finish_panel", "finish_plane", "mark_gaps", "rests", "shade_bad"]

LINE = 0.9
DENSE = 1000  # crossings of the middle from which on a line would be a solid block
RESTS_SHARE = 1e-6  # of its size: a signal that moves less rests, and what it moves is rounding
NARROWEST_SHARE = 0.002  # of the axis: a gap is drawn no narrower


def draw_signal(
    ax: Axes, axis: TimeAxis, log: Log, name: str, colour: str, label: str = "", good: Mask | None = None, **style: Any
) -> None:
    """Draw a signal; ``good`` (n,) says which samples count, by default those that are good by themselves.

    The line is broken at gaps in time and where samples do not count; values that were logged but do not count get a
    cross.  A long signal is thinned to the lowest and highest of each stretch.
    """
    good = log.good(name) if good is None else good
    x, y = broken_at_gaps(log, axis.at(log.t), np.where(good, log[name], np.nan))
    if _dense(y):
        at, low, high = envelope(x, y)
        ax.fill_between(at, low, high, color=colour, alpha=0.4, linewidth=0.0, label=label or None)
    else:
        single = "." if len(log) < 2 else ""
        ax.plot(*thinned(x, y), color=colour, label=label or None, marker=single, **{"linewidth": LINE, **style})
    doubtful = ~log.good(name) & np.isfinite(log[name])
    if doubtful.any():
        t, values = thinned(axis.at(log.t[doubtful]), log[name][doubtful], 400)
        ax.plot(t, values, linestyle="", marker="x", markersize=3.5, color=COLOURS["bad"])


def _dense(y: Values) -> bool:
    """Whether a signal (n,) goes up and down so often that its line would fill the picture."""
    if len(y) <= POINTS:
        return False
    around = np.sign(y - np.nanmedian(y)) if np.isfinite(y).any() else y
    return int(np.sum(np.abs(np.diff(around[np.isfinite(around)])) > 1.0)) > DENSE


def broken_at_gaps(log: Log, x: Values, y: Values) -> tuple[Values, Values]:
    """A missing point after the last sample before each gap, so that the line is not drawn across it."""
    after = np.searchsorted(log.t, [t1 for _, t1 in log.gaps()])
    return np.insert(x, after, x[after - 1]), np.insert(y, after, np.nan)


def mark_gaps(ax: Axes, axis: TimeAxis, log: Log) -> None:
    """Shade the stretches without samples, the first with a name for the legend."""
    least = NARROWEST_SHARE * log.duration
    for i, (t0, t1) in enumerate(log.gaps()):
        a, b = axis.at(np.array([t0, max(t1, t0 + least)])).tolist()
        ax.axvspan(a, b, color=PALE, alpha=0.28, linewidth=0, zorder=0.4, label="gap" if i == 0 else None)


def shade_bad(ax: Axes, axis: TimeAxis, log: Log, good: Mask) -> None:
    """Shade the samples that do not count; ``good`` (n,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[True], good, [True]]).astype(np.int8)))
    reach = 0.5 * log.dt if np.isfinite(log.dt) else 0.0
    for i, (first, stop) in enumerate(zip(edges[::2], edges[1::2], strict=True)):
        a, b = axis.at(np.array([log.t[first] - reach, log.t[stop - 1] + reach])).tolist()
        ax.axvspan(a, b, color=COLOURS["bad"], alpha=0.10, linewidth=0, label="not good" if i == 0 else None)


def rests(values: Values) -> bool:
    """Whether a signal (n,) stands still: what is left of a movement is the rounding of its numbers.

    >>> rests(np.array([7.6e3, 7.6e3 + 1e-9])), rests(np.array([0.0, 1e-300])), rests(np.array([1.0, 1.1]))
    (True, True, False)
    """
    y = values[np.isfinite(values)]
    return not y.size or float(np.ptp(y)) <= max(RESTS_SHARE * float(np.abs(y).max()), 1e-12)


def finish_plane(ax: Axes, x: list[Values], y: list[Values]) -> None:
    """A panel of one signal over another: what rests is at its value, on an axis that is wide beside its rounding.

    ``x``, ``y``: what is drawn, each (n,), in the units of the axes.
    """
    finish_panel(ax, y)
    seen = np.concatenate([values[np.isfinite(values)] for values in x]) if x else np.empty(0)
    if seen.size and rests(seen):
        ax.set_xlim(*_around(seen))
    ax.ticklabel_format(useOffset=False)


def _around(seen: Values) -> tuple[float, float]:
    """Return the ends of an axis on which what rests is in the middle."""
    middle = float(np.median(seen))
    half = 0.05 * abs(middle) or 1.0
    return middle - half, middle + half


def finish_panel(ax: Axes, values: list[Values]) -> None:
    """Give axes a light grid, a margin and at least two ticks of few digits.

    A signal that rests becomes a line at its value: its rounding is not spread over the axes.

    ``values``: what is drawn, each (n,), in the unit of the axis.
    """
    from matplotlib.ticker import MaxNLocator

    tidy(ax)
    ax.margins(y=0.1)
    seen = np.concatenate([y[np.isfinite(y)] for y in values]) if values else np.empty(0)
    if seen.size and rests(seen):
        ax.set_ylim(*_around(seen))
        ax.annotate(
            f"at rest at {float(np.median(seen)):.5g}", (1.0, 0.5), (-4.0, 4.0), xycoords="axes fraction",
            textcoords="offset points", ha="right", fontsize=8.0, color=COLOURS["SP"],
        )  # fmt: skip
    ax.yaxis.set_major_locator(MaxNLocator(nbins=5, min_n_ticks=3, steps=[1, 2, 2.5, 5, 10]))
    ax.ticklabel_format(useOffset=False, axis="y")
