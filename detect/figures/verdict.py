"""Pictures of verdicts: the evidence as a sceptic would draw it."""

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from stickslip.detect.verdict import Verdict
from stickslip.detect.words import WORDS
from stickslip.logs.arrays import Mask, Values
from stickslip.logs.picture import Picture
from stickslip.logs.style import AFTER, BEFORE, COLOURS, FIT, INK, SOFT, UNUSED, tidy

PV = COLOURS["PV"]
CYCLES = 24  # drawn: enough to see the shape; a hundred would be a smear
DOTS = 250  # about as many half cycles of either side are drawn one by one


def plot_verdict(v: Verdict) -> Figure:
    """One figure: evidence of the method above, verdict and reason as its title."""
    figure = Picture(figsize=(10, 4.6), layout="constrained")
    reason = "" if v.draw is None or len(v.evidence) == 0 else "\n" + textwrap.fill(v.reason, 150)
    standing = " (on trial)" if v.experimental else ""
    figure.suptitle(f"{v.method}: {WORDS[v.verdict].spoken}{standing}{reason}", x=0.01, ha="left", fontsize=9)
    draw_evidence(v, figure)
    return figure


def draw_evidence(v: Verdict, figure: FigureBase) -> None:
    """The evidence of any method on a figure or subfigure; its reason when there is nothing to draw."""
    if v.draw is None or len(v.evidence) == 0:
        draw_reason(v.reason, figure)
    else:
        v.draw(v, figure)


def draw_stands(panels: Sequence[Axes], t: Values, signals: Mapping[str, Values], stands: Sequence[Any]) -> None:
    """Each signal (n,) over t (n,) [s] in a panel of its own; ``stands``, from where to where [s], are shaded."""
    for axes, (name, y) in zip(panels, signals.items(), strict=True):
        axes.plot(t, y, color=INK)
        for a, b in stands:
            if a < t[-1]:
                axes.axvspan(a, min(b, t[-1]), color=SOFT, alpha=0.3, lw=0)
        finish(axes, "", name)
    panels[-1].set_xlabel("time [s]")


def draw_reason(text: str, figure: FigureBase) -> None:
    """A sentence instead of a picture."""
    axes = figure.subplots()
    axes.axis("off")
    axes.text(0.0, 0.9, textwrap.fill(text, 100), va="top", ha="left", transform=axes.transAxes)


def draw_half_cycles(v: Verdict, figure: FigureBase) -> None:
    """e with its half cycles cut at the peaks, and the ratio of each half cycle."""
    left, right = figure.subplots(1, 2, width_ratios=(3, 1))
    t, e = v.array("t"), v.array("e")
    start, middle, end = v.array("start"), v.array("peak_time"), v.array("end")
    used = v.array("used") > 0
    last = start[0] + CYCLES * np.median(end - start) if len(start) else (t[-1] if len(t) else 0.0)
    drawn = start <= last
    shown = (t <= (end[drawn].max() if drawn.any() else last)) | np.isnan(t)
    t, e = t[shown], e[shown]
    known = ~np.isnan(t)
    left.plot(t, e, color=FIT, lw=0.8)
    left.axhline(0, color=FIT, lw=0.5)
    for i in np.flatnonzero(drawn):
        for a, b, colour in ((start[i], middle[i], BEFORE), (middle[i], end[i], AFTER)):
            inside = t[(t > a) & (t < b)]
            edge = np.concatenate([[a], inside, [b]])
            left.fill_between(
                edge, np.interp(edge, t[known], e[known]), color=colour if used[i] else UNUSED, alpha=0.85, lw=0
            )
    left.plot([], [], color=BEFORE, lw=6, label="A1, before peak")
    left.plot([], [], color=AFTER, lw=6, label="A2, after it")
    if not used.all():
        left.plot([], [], color=UNUSED, lw=6, label="left out: unlike the others")
    if len(start) and start[0] > np.nanmin(t):
        left.plot([], [], color=FIT, lw=0.8, label="not whole")
    left.margins(x=0.01, y=0.05)
    some = f"; the first {CYCLES} of {len(start)} half cycles" if len(start) > CYCLES else ""
    finish(left, f"time [s]{some}", "e = SP - PV, centred", named=True)
    _draw_ratios(v, right, used)


def legend(axes: Axes) -> None:
    """Name the lines of a panel above it, where no data are."""
    axes.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, frameon=False, fontsize=8.5, borderpad=0.1,
        handlelength=1.6, columnspacing=1.2,
    )  # fmt: skip


def finish(axes: Axes, x: str = "", y: str = "", title: str = "", named: bool = False) -> None:
    """Label a panel, name its lines if they are ``named``, and leave it no more lines than it needs."""
    axes.set(**{of: text for of, text in (("xlabel", x), ("ylabel", y)) if text})
    if title:
        axes.set_title(title, fontsize=9, loc="left")
    if named:
        legend(axes)
    tidy(axes)


def _draw_ratios(v: Verdict, axes: Axes, used: Mask) -> None:
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = v.array("area_before") / v.array("area_after")
    below = v.array("peak") > 0  # of e = SP - PV
    rng = np.random.default_rng(0)
    for x, side in ((0.0, below), (1.0, ~below)):
        kept = np.sort(ratio[side & used])
        kept = kept[:: max(1, len(kept) // DOTS)]  # every tenth by size, say, is spread as all are
        axes.plot(x + rng.uniform(-0.15, 0.15, len(kept)), kept, "o", ms=4, color=FIT, alpha=0.5, lw=0)
    axes.set_xticks([0, 1], ["PV below SP", "PV above SP"])
    axes.set_xlim(-0.6, 1.6)
    axes.set_yscale("log")
    if v.interval is not None and v.index is not None:
        axes.axhspan(*v.interval, color=PV, alpha=0.22, lw=0)
        axes.axhline(v.index, color=PV, lw=1.8)
        _at_line(axes, v.index, f"R = {v.index:.2f}")
    axes.axhline(1.0, color=FIT, lw=0.8, ls=":")
    if v.threshold is not None:
        axes.axhline(v.threshold, color=FIT, lw=0.9, ls="--")
        if v.index is None or not 0.85 < v.threshold / v.index < 1.18:  # no room for both names
            _at_line(axes, v.threshold, "threshold")
    seen = [*ratio[used & np.isfinite(ratio) & (ratio > 0)].tolist(), 1.0, v.threshold or 1.0]
    low, high = min(seen) / 1.2, max(seen) * 1.2
    axes.set_ylim(low, high)
    ticks = [r for r in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100) if low <= r <= high]
    axes.set_yticks(ticks, [f"{r:g}" for r in ticks])
    axes.minorticks_off()
    finish(axes, "", "", "R = A1 / A2, with 90 % band")


def _at_line(axes: Axes, height: float, text: str) -> None:
    """Name a level at the right edge, above its line."""
    axes.annotate(
        text, (1.0, height), (-2.0, 2.0), xycoords=("axes fraction", "data"), textcoords="offset points", ha="right",
        fontsize=8, color=FIT, bbox={"facecolor": "white", "alpha": 0.75, "pad": 0.8, "linewidth": 0},
    )  # fmt: skip
