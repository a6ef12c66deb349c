"""The picture of a diagnosis: trend, PV against OP, and the evidence behind the verdict."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

import numpy as np

from detect.figures.verdict import draw_evidence, legend
from detect.words import WORDS
from logs.figures import COLOURS, time_unit
from logs.style import tidy

if TYPE_CHECKING:
    from matplotlib.figure import Figure, SubFigure

    from detect.diagnosis import Diagnosis

__all__ = ["plot_diagnosis"]


def plot_diagnosis(answer: Diagnosis, words: bool = True) -> Figure:
    """Trend, PV-OP curve and the first evidence that can be drawn, a voter if possible; ``words`` adds the reason."""
    from logs.picture import Picture

    drawn = [v for v in answer.methods if len(v.evidence) and v.draw is not None]
    shown = next(iter(sorted(drawn, key=lambda v: v.experimental)), None)
    figure = Picture(figsize=(11, 8.2 if shown else 4.8), layout="constrained")
    rows = 2 if shown else 1
    parts: list[SubFigure] = list(np.ravel(figure.subfigures(rows, 1)))  # type: ignore[arg-type]
    trend = parts[0]
    if words:
        title = f"{answer.loop or 'loop'}: {WORDS[answer.verdict].spoken}"
        figure.suptitle(title, x=0.01, ha="left", fontsize=12, weight="bold")
    grid = trend.add_gridspec(2, 2, width_ratios=(2.2, 1))
    top = trend.add_subplot(grid[0, 0])
    below = trend.add_subplot(grid[1, 0], sharex=top)
    curve = trend.add_subplot(grid[:, 1])
    record = answer.record
    good = record.good
    scale, unit = time_unit(float(record.t[-1] - record.t[0]))
    t, pv, op = record.t / scale, np.where(good, record.pv, np.nan), np.where(good, record.op, np.nan)
    if record.sp is not None:
        top.plot(t, record.sp, color=COLOURS["SP"], lw=1.1, ls=(0, (4, 2)), label="SP", zorder=3)
    top.plot(t, pv, color=COLOURS["PV"], lw=0.9, label="PV")
    below.plot(t, op, color=COLOURS["OP"], lw=0.9, label="OP")
    for axes in (top, below, curve):
        tidy(axes)
    legend(top)
    legend(below)
    of_pv, of_op = (
        _named("PV", record.log.units.get(record.pv_name)),
        _named("OP", record.log.units.get(record.op_name)),
    )
    top.set_ylabel(of_pv)
    below.set_ylabel(of_op)
    below.set_xlabel(f"time [{unit}]")
    below.set_xlim(t[0], t[-1] if t[-1] > t[0] else None)
    top.tick_params(labelbottom=False)
    curve.plot(op, pv, color=COLOURS["PV"], lw=0.6, alpha=0.7)
    curve.set_xlabel(of_op)
    curve.set_ylabel(of_pv)
    curve.set_title("PV against OP", fontsize=9, loc="left")
    if words:
        trend.suptitle("\n".join(textwrap.wrap(answer.reason, 150)), fontsize=8.5, x=0.01, ha="left")
    if shown is not None:
        draw_evidence(shown, parts[1])
    return figure


def _named(part: str, unit: str | None) -> str:
    return f"{part} [{unit}]" if unit else part
