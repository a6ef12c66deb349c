"""Pictures of verdicts: the evidence as a sceptic would draw it."""

from __future__ import annotations

import importlib
import textwrap
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from detect.verdict import Verdict

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase

__all__ = ["draw_evidence", "draw_half_cycles", "draw_reason", "plot_verdict"]

BEFORE, AFTER, UNUSED, LINE = "#d1495b", "#30638e", "#c8c8c8", "#333333"


def plot_verdict(v: Verdict) -> Figure:
    """One figure: evidence of the method above, verdict and reason as its title."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4.6), layout="constrained")
    reason = "" if len(v.evidence) == 0 else "\n" + textwrap.fill(v.reason, 150)
    figure.suptitle(f"{v.method}: {v.verdict.replace('_', ' ')}{reason}", x=0.01, ha="left", fontsize=9)
    draw_evidence(v, figure)
    return figure


def draw_evidence(v: Verdict, figure: FigureBase) -> None:
    """The evidence of any method on a figure or subfigure; its reason when there is nothing to draw."""
    module = importlib.import_module(f"detect.{v.method}")
    if len(v.evidence) == 0:
        draw_reason(v.reason, figure)
    else:
        module.draw(v, figure)


def draw_reason(text: str, figure: FigureBase) -> None:
    """A sentence instead of a picture."""
    axes = figure.subplots()
    axes.axis("off")
    axes.text(0.0, 0.9, textwrap.fill(text, 100), va="top", ha="left", transform=axes.transAxes)


def draw_half_cycles(v: Verdict, figure: FigureBase) -> None:
    """e with its half cycles cut at the peaks, beside the ratio of each half cycle."""
    left, right = figure.subplots(1, 2, width_ratios=(3, 1))
    t, e = v.array("t"), v.array("e")
    start, middle, end = v.array("start"), v.array("peak_time"), v.array("end")
    used = v.array("used") > 0
    # Enough cycles to see the shape; a hundred would be a smear.
    last = start[0] + 24 * np.median(end - start) if len(start) else (t[-1] if len(t) else 0.0)
    shown = t <= last
    left.plot(t[shown | np.isnan(t)], e[shown | np.isnan(t)], color=LINE, lw=0.8)
    left.axhline(0, color=LINE, lw=0.5)
    for i in np.flatnonzero(start <= last):
        for a, b, colour in ((start[i], middle[i], BEFORE), (middle[i], end[i], AFTER)):
            inside = t[(t > a) & (t < b)]
            edge = np.concatenate([[a], inside, [b]])
            ok = ~np.isnan(t)
            left.fill_between(
                edge, np.interp(edge, t[ok], e[ok]), color=colour if used[i] else UNUSED, alpha=0.75, lw=0
            )
    left.plot([], [], color=BEFORE, lw=6, label="A1, before the peak")
    left.plot([], [], color=AFTER, lw=6, label="A2, after it")
    if not used.all():
        left.plot([], [], color=UNUSED, lw=6, label="left out")
    left.legend(loc="upper right", fontsize=8, ncols=3)
    left.margins(x=0.01, y=0.2)
    left.set_xlabel("time [s]")
    left.set_ylabel("e, centred [unit of PV]")
    left.set_title("half cycles of e, cut at their peaks", fontsize=8, loc="left")
    _draw_ratios(v, right, used)


def _draw_ratios(v: Verdict, axes: Axes, used: npt.NDArray[np.bool_]) -> None:
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = v.array("area_before") / v.array("area_after")
    up = v.array("peak") > 0
    rng = np.random.default_rng(0)
    for x, side, label in ((0.0, up, "above"), (1.0, ~up, "below")):
        kept = ratio[side & used]
        axes.plot(x + rng.uniform(-0.15, 0.15, len(kept)), kept, "o", ms=4, color=LINE, alpha=0.6, label=label)
    axes.set_xticks([0, 1], ["above SP", "below SP"])
    axes.set_xlim(-0.6, 1.6)
    axes.set_yscale("log")
    if v.interval is not None and v.index is not None:
        axes.axhspan(*v.interval, color=BEFORE, alpha=0.25, lw=0)
        axes.axhline(v.index, color=BEFORE, lw=1.5)
    axes.axhline(1.0, color=LINE, lw=0.8, ls=":")
    if v.threshold is not None:
        axes.axhline(v.threshold, color=LINE, lw=0.8, ls="--")
    seen = [*ratio[used & np.isfinite(ratio) & (ratio > 0)].tolist(), 1.0, v.threshold or 1.0]
    low, high = min(seen) / 1.2, max(seen) * 1.2
    axes.set_ylim(low, high)
    ticks = [r for r in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100) if low <= r <= high]
    axes.set_yticks(ticks, [f"{r:g}" for r in ticks])
    axes.minorticks_off()
    axes.set_title("R = A1 / A2 of each half cycle\ndashed: threshold, band: 90 %", fontsize=8)
