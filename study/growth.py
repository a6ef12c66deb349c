"""How oscillation grows with one parameter: amplitude and period over it, one line a signal."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from stickslip.logs.arrays import Values
from stickslip.logs.style import CYCLE, SOFT, tidy
from stickslip.study.axes import Axis
from stickslip.study.findings import Findings
from stickslip.study.frame import DECADES, head, plain_numbers
from stickslip.study.groups import Group, groups

if TYPE_CHECKING:
    from matplotlib.figure import Figure


SHOWN = 6  # signals in one panel
ASIDE = 0.004  # of the axis, from the bar of one signal to the next
SLICES, DRAWN = 40, 12  # of a listed and of a random axis


def draw_growth(result: Findings) -> "Figure | None":
    """Return amplitude [% of the operating point] and period [s] over the first axis of at least three numbers."""
    from stickslip.logs.picture import Picture

    axis = next((axis for axis in result.varied() if numbers(axis, 3)), None)
    if axis is None:
        return None
    figure = Picture(figsize=(9.0, 6.2), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(1.6, 1.0))
    swings = result.swings()
    every = [group for group in groups(result, axis, SLICES, DRAWN) if group.runs.any()]
    found = [Group(group.label, group.at, group.runs & swings) for group in every]
    at = np.array([group.at for group in found])
    top = 0.0
    signals = chosen(result.signals)
    for k, (signal, colour) in enumerate(zip(signals, CYCLE, strict=False)):
        for ax, values in ((upper, result.percent(signal)), (lower, result.column(f"{signal}.period"))):
            bands = [group.band(values) for group in found]
            middle = np.array([b.median for b in bands])
            if ax is upper:
                # Six bands over each other are mud: each value has a bar of its own, a little aside.
                aside = _aside(at, (k - 0.5 * (len(signals) - 1)) * ASIDE, axis.even_ratios)
                ax.vlines(aside, [max(b.low, 1e-12) for b in bands], [b.high for b in bands],
                          color=colour, alpha=0.45, linewidth=1.6, zorder=1.5)  # fmt: skip
            ax.plot(at, middle, color=colour, linewidth=1.5, marker="o", markersize=3.0, label=signal)
            if ax is upper and np.isfinite(middle).any():
                top = max(top, float(np.nanmax(middle)))
    still = [group.at for group, moving in zip(every, found, strict=True) if not moving.runs.any()]
    if still:
        upper.plot(still, np.full(len(still), 0.03), "x", color=SOFT, ms=6, transform=upper.get_xaxis_transform(),
                   clip_on=False)  # fmt: skip
    for ax in (upper, lower):
        tidy(ax)
    if top > 0.0:
        upper.set_yscale("log")
        upper.set_ylim(bottom=max(upper.get_ylim()[0], top * 10.0**-DECADES))
        plain_numbers(upper)
    lower.set_ylim(bottom=0.0)
    if axis.even_ratios:
        lower.set_xscale("log")
        plain_numbers(lower, "x")
    upper.set_ylabel("amplitude\n[% of the operating point]", fontsize=9)
    lower.set_ylabel("period [s]", fontsize=9)
    lower.set_xlabel(axis.name, fontsize=9)
    named = [line for line in upper.lines if not str(line.get_label()).startswith("_")]
    lines = sorted(named, key=lambda line: -_last(line.get_ydata()))  # as they stand at the right edge
    figure.legend(lines, [str(line.get_label()) for line in lines], loc="outside right upper", frameon=False,
                  fontsize=8.5)  # fmt: skip
    head(figure, result, "runs that oscillate: medians; bars: 5 to 95 %" + ("; x: all at rest" if still else ""))
    return figure


def _aside(at: Values, steps: float, even_ratios: bool) -> Values:
    """Return places moved by a share of the axis, so that bars of several signals stand side by side."""
    if even_ratios:
        return np.exp(_aside(np.log(at), steps, False))
    return at + steps * float(np.ptp(at))


def _last(y: ArrayLike) -> float:
    values = np.asarray(y, float)
    values = values[np.isfinite(values)]
    return float(values[-1]) if values.size else 0.0


def numbers(axis: Axis, least: int) -> bool:
    """Return whether an axis has at least ``least`` numbers."""
    return bool(axis.law) or (len(axis.values) >= least and not any(isinstance(v, str) for v in axis.values))


def chosen(signals: tuple[str, ...], most: int = SHOWN) -> list[str]:
    """Return some signals spread evenly over the chain, its ends among them.

    >>> chosen(("a", "b", "c", "d", "e"), 3)
    ['a', 'c', 'e']
    """
    return [
        signals[i] for i in np.unique(np.linspace(0, len(signals) - 1, min(most, len(signals))).round().astype(int))
    ]
