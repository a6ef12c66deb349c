"""Pictures of a fit and of remedies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from stickslip.logs import Log
from stickslip.logs.picture import Picture
from stickslip.logs.style import COLOURS, INK, PALE, SOFT, tidy
from stickslip.logs.time_axis import TimeAxis
from stickslip.remedy.left import whitened
from stickslip.remedy.process import predicted
from stickslip.remedy.size import widened
from stickslip.remedy.trial import SKIPPED

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from stickslip.remedy.advice import Advice
    from stickslip.remedy.loop_fit import LoopFit

SHOWN = 12.0  # turns of OP in a picture
MOST = 3.0  # medians, to which an interval is drawn


def plot_fit(fit: LoopFit) -> Figure:
    """OP with the likeliest stem; PV with what the loop foretells one row ahead, and with its stem alone."""
    day, noise = fit.days[0], fit.found.noises[0]
    shown = predicted(fit.days, fit.best, fit.found.noises).shown[0]
    n = shown.shape[1]
    part = slice(max(0, n - max(int(SHOWN * day.between), 200)), n)
    rows = slice(part.start // day.q, None)
    answer = fit.best.K * shown[1]
    y, x = day.rows, answer.reshape(-1, day.q).mean(axis=1)
    line = noise.c + noise.d * np.arange(len(y))
    ahead = y.copy()
    ahead[len(noise.a) :] -= whitened(y - x - line, noise.a)
    figure = Picture(figsize=(9.6, 5.2), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    axis = TimeAxis(_log(fit), (part.stop - part.start) * day.dt)
    t = axis.at(day.t[:n])
    upper.plot(t[part], day.op[:n][part], color=SOFT, label="OP")
    upper.plot(t[part], day.op[0] + shown[0][part], color=COLOURS["MV"], label="likeliest stem")
    upper.set_ylabel(f"[{fit.op_unit}]")
    lower.plot(t[part], day.pv[:n][part], color=INK, label="PV, logged")
    at = t[: len(y) * day.q].reshape(-1, day.q).mean(axis=1)
    lower.plot(at[rows], ahead[rows], color=COLOURS["MV"], lw=0.9, label="foretold one row ahead")
    lower.plot(at[rows], (x + line)[rows], color=PALE, label="what the stem alone makes of it")
    lower.set_ylabel(f"PV [{fit.pv_unit}]" if fit.pv_unit else "PV")
    axis.finish(lower, float(day.t[part.start]), float(day.t[part.stop - 1]))
    upper.set_title(f"S = {fit.S} {fit.op_unit}; K J = {fit.KJ} {fit.pv_unit}", fontsize=9, loc="left")
    for axes in (upper, lower):
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, ncols=3, frameon=False)
        tidy(axes)
    return figure


def plot_advice(advice: Advice) -> Figure:
    """SP - PV now, until the shutdown and at it under the same load; variability and travel of all remedies."""
    fit, day = advice.fit, advice.fit.days[0]
    n = len(advice.none.outcome.pv)
    run = slice(int(SKIPPED * n), n)  # the start, which no standard deviation counts, would squeeze the rest
    sp = np.full(n, np.mean(day.pv)) if day.sp is None else day.sp[:n]
    names = [("now", advice.none)]
    names += [(name, advice[name]) for name in dict.fromkeys((advice.until_shutdown, advice.at_shutdown)) if name]
    unit = f" [{fit.pv_unit}]" if fit.pv_unit else ""
    figure = Picture(figsize=(9.6, 4.6), layout="constrained")
    grid = figure.add_gridspec(len(names), 3, width_ratios=[1.3, 0.8, 0.8])
    axes = [figure.add_subplot(grid[i, 0]) for i in range(len(names))]
    for ax in axes[1:]:
        ax.sharex(axes[0])
        ax.sharey(axes[0])
    axis = TimeAxis(_log(fit))
    t = axis.at(day.t[:n])
    for ax, (name, one) in zip(axes, names, strict=True):
        ax.plot(t[run], (one.outcome.pv - sp)[run], color=INK if name == "now" else COLOURS["PV"], lw=0.9)
        ax.set_title(f"{name}: rms {np.median(one.outcome.pv_rms):.3g} {fit.pv_unit}", fontsize=9, loc="left")
        tidy(ax)
    axis.finish(axes[-1], float(day.t[run.start]), float(day.t[n - 1]))
    for ax in axes:
        ax.set_ylabel(f"PV - SP{unit}")
    spread, travel = figure.add_subplot(grid[:, 1]), figure.add_subplot(grid[:, 2])
    _beside(advice, spread, travel)
    spread.set_xlabel(f"root mean square\nof SP - PV{unit}")
    travel.set_xlabel(f"stem travel\n[{fit.op_unit} a day]")
    return figure


def _log(fit: LoopFit) -> Log:
    """The first record of a fit, for its clock."""
    return Log(fit.days[0].t, {"OP": fit.days[0].op}, start=fit.start)


def _beside(advice: Advice, spread: Axes, travel: Axes) -> None:
    """A line for every remedy, the least root mean square on top: that with its 90 % interval, and the travel."""
    from matplotlib.ticker import MaxNLocator

    lines = []
    for one in (advice.none, *advice.tried):
        low, middle, high = np.percentile(widened(one.outcome.pv_rms), [5.0, 50.0, 95.0], method="nearest")
        if math.isinf(middle):
            continue
        chosen = one.name in (advice.until_shutdown, advice.at_shutdown)
        colour = INK if one is advice.none else COLOURS["PV"] if chosen else SOFT
        moved = 24.0 * float(np.median(one.outcome.travel))
        lines.append((float(middle), float(low), float(min(high, MOST * middle)), moved, one.name, colour))
    lines.sort()
    for place, (middle, low, high, moved, _, colour) in enumerate(lines):
        spread.plot([low, high], [place] * 2, color=colour, lw=1.0)
        spread.plot(middle, place, "o", ms=5.0, color=colour, clip_on=False)
        travel.plot(moved, place, "o", ms=5.0, color=colour, clip_on=False)
    spread.set_yticks(range(len(lines)), [name for *_, name, _ in lines], fontsize=8)
    for label, line in zip(spread.get_yticklabels(), lines, strict=True):
        label.set_color(line[-1])
    travel.set_yticks(range(len(lines)), [""] * len(lines))
    for ax in (spread, travel):
        ax.set_ylim(len(lines) - 0.5, -0.5)
        ax.set_xlim(0.0)
        ax.xaxis.set_major_locator(MaxNLocator(4))
        tidy(ax)
