"""The picture of a diagnosis: trend, PV against OP, and the evidence behind the verdict."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

import numpy as np

from detect.plots import AFTER, BEFORE, LINE, draw_evidence

if TYPE_CHECKING:
    from matplotlib.figure import Figure, SubFigure

    from detect.diagnose import Diagnosis

__all__ = ["plot_diagnosis"]


def plot_diagnosis(answer: Diagnosis, words: bool = True) -> Figure:
    """Trend, PV-OP curve and the first evidence there is, on one figure; ``words`` writes verdict and reason on it."""
    from matplotlib.figure import Figure

    shown = next((v for v in answer.methods if len(v.evidence)), None)
    figure = Figure(figsize=(11, 8.2 if shown else 4.8), layout="constrained")
    rows = 2 if shown else 1
    parts: list[SubFigure] = list(np.ravel(figure.subfigures(rows, 1)))  # type: ignore[arg-type]
    trend = parts[0]
    if words:
        title = f"{answer.loop or 'loop'}: {answer.verdict.replace('_', ' ')}"
        figure.suptitle(title, x=0.01, ha="left", fontsize=12, weight="bold")
    grid = trend.add_gridspec(2, 2, width_ratios=(2.2, 1))
    top = trend.add_subplot(grid[0, 0])
    below = trend.add_subplot(grid[1, 0], sharex=top)
    curve = trend.add_subplot(grid[:, 1])
    record = answer.record
    good = record.good
    units = record.log.units
    t, pv, op = record.t, np.where(good, record.pv, np.nan), np.where(good, record.op, np.nan)
    if record.sp is not None:
        top.plot(t, record.sp, color=BEFORE, lw=1, label="SP", zorder=3)
    top.plot(t, pv, color=AFTER, lw=0.9, label="PV")
    top.set_ylabel(f"PV [{units.get(record.pv_name, '-')}]")
    top.legend(loc="upper right", fontsize=8, ncols=2)
    below.plot(t, op, color=LINE, lw=0.9)
    below.set_ylabel(f"OP [{units.get(record.op_name, '-')}]")
    below.set_xlabel("time [s]")
    top.tick_params(labelbottom=False)
    curve.plot(op, pv, color=AFTER, lw=0.6, alpha=0.7)
    curve.set_xlabel(f"OP [{units.get(record.op_name, '-')}]")
    curve.set_ylabel(f"PV [{units.get(record.pv_name, '-')}]")
    curve.set_title("PV against OP", fontsize=8)
    if words:
        top.set_title("\n".join(textwrap.wrap(answer.reason, 118)), fontsize=8, loc="left")
    if shown is not None:
        draw_evidence(shown, parts[1])
    return figure
