"""Pictures of a fit and of remedies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from stickslip.logs.picture import Picture
from stickslip.logs.style import COLOURS, INK, PALE, SOFT, tidy
from stickslip.remedy.loop_fit import widened
from stickslip.remedy.process import predicted

if TYPE_CHECKING:
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
    v = y - x - line
    ahead = x + line
    for k, share in enumerate(noise.a, 1):
        ahead[k:] += share * v[:-k]
    figure = Picture(figsize=(9.6, 5.2), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    t = day.t[:n] - day.t[0]
    upper.plot(t[part], day.op[:n][part], color=SOFT, label="OP")
    upper.plot(t[part], day.op[0] + shown[0][part], color=COLOURS["MV"], label="likeliest stem")
    upper.set_ylabel(f"[{fit.op_unit}]")
    lower.plot(t[part], day.pv[:n][part], color=INK, label="PV, logged")
    at = t[: len(y) * day.q].reshape(-1, day.q).mean(axis=1)
    lower.plot(at[rows], ahead[rows], color=COLOURS["MV"], lw=0.9, label="foretold one row ahead")
    lower.plot(at[rows], (x + line)[rows], color=PALE, label="what the stem alone makes of it")
    lower.set_ylabel(f"PV [{fit.pv_unit}]" if fit.pv_unit else "PV")
    lower.set_xlabel("time [s]")
    upper.set_title(f"S = {fit.S} {fit.op_unit}; K J = {fit.KJ} {fit.pv_unit}", fontsize=9, loc="left")
    for axes in (upper, lower):
        axes.legend(loc="upper left", fontsize=8, ncols=3, frameon=False)
        tidy(axes)
    return figure


def plot_advice(advice: Advice) -> Figure:
    """SP - PV now, until the shutdown and at it under the same load; travel against variability of all remedies."""
    fit, day = advice.fit, advice.fit.days[0]
    n = len(advice.none.outcome.pv)
    sp = np.full(n, np.mean(day.pv)) if day.sp is None else day.sp[:n]
    names = [("now", advice.none)]
    names += [(name, advice[name]) for name in dict.fromkeys((advice.until_shutdown, advice.at_shutdown)) if name]
    figure = Picture(figsize=(9.6, 4.6), layout="constrained")
    grid = figure.add_gridspec(len(names), 2, width_ratios=[1.3, 1.0])
    axes = [figure.add_subplot(grid[i, 0]) for i in range(len(names))]
    for ax in axes[1:]:
        ax.sharex(axes[0])
        ax.sharey(axes[0])
    t = (day.t[:n] - day.t[0]) / 60.0
    for ax, (name, one) in zip(axes, names, strict=True):
        ax.plot(t, one.outcome.pv - sp, color=INK if name == "now" else COLOURS["PV"], lw=0.9)
        ax.set_title(f"{name}: {np.median(one.outcome.pv_sd):.3g} {fit.pv_unit}", fontsize=9, loc="left")
        tidy(ax)
    axes[-1].set_xlabel("time [min]")
    axes[len(axes) // 2].set_ylabel(f"PV - SP [{fit.pv_unit}]" if fit.pv_unit else "PV - SP")
    ax = figure.add_subplot(grid[:, 1])
    for one in (advice.none, *advice.tried):
        travel = 24.0 * float(np.median(one.outcome.travel))
        low, middle, high = np.percentile(widened(one.outcome.pv_sd), [5.0, 50.0, 95.0], method="nearest")
        if math.isinf(middle):
            continue
        chosen = one.name in ("none", advice.until_shutdown, advice.at_shutdown)
        colour = INK if one is advice.none else COLOURS["PV"] if chosen else SOFT
        ax.plot([travel] * 2, [low, min(high, MOST * middle)], color=colour, lw=1.0)
        ax.plot(travel, middle, "o", ms=5.0, color=colour)
        ax.annotate(one.name, (travel, middle), fontsize=7, xytext=(5, 2), textcoords="offset points", color=colour)
    ax.set_xscale("symlog", linthresh=max(24.0 * float(np.median(advice.none.outcome.travel)) / 30.0, 1e-9))
    ax.set_xlabel(f"stem travel [{fit.op_unit} a day]")
    ax.set_ylabel("standard deviation of SP - PV")
    ax.margins(x=0.25)
    tidy(ax)
    return figure
