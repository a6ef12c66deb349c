"""Pictures of a gap report: the residuals of every logged signal, before and after the causes are put in."""

from typing import TYPE_CHECKING

import numpy as np
from stickslip.logs.style import GREEN, RED, SHADE, tidy
from stickslip.logs.thinned import thinned
from stickslip.logs.time_axis import time_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from stickslip.gap.answers.report import GapReport

HIGHEST = 1e3  # of the scale: beyond, a residual is just large
TICKS = (-1000.0, -100.0, -10.0, -3.0, 0.0, 3.0, 10.0, 100.0, 1000.0)


def plot_residuals(report: "GapReport") -> "Figure":
    """Return one panel a signal: its innovations, 1 = standard deviation without a gap, on a scale linear up to 3."""
    from stickslip.logs.picture import Picture

    figure = Picture(figsize=(9.0, 0.9 + 1.9 * len(report.residuals)), layout="constrained")
    panels = figure.subplots(len(report.residuals), 1, sharex=True, squeeze=False)[:, 0]
    scale, unit = time_unit(float(report.t[-1] - report.t[0]))
    said = _with_what(report)
    for panel, (signal, both) in zip(panels, report.residuals.items(), strict=True):
        made = [("model as it is", RED, both[0])]
        if said:
            made.append((said, GREEN, both[1]))
        for label, colour, values in made:
            shown = np.clip(values, -HIGHEST, HIGHEST)
            panel.plot(*thinned(report.t / scale, shown), color=colour, linewidth=0.6, label=label)
        panel.set_yscale("symlog", linthresh=3.0)
        panel.axhspan(-3.0, 3.0, color=SHADE, linewidth=0, zorder=0.1)
        low, high = panel.get_ylim()
        panel.set_yticks([tick for tick in TICKS if low <= tick <= high])
        panel.set_ylim(low, high)
        panel.yaxis.set_major_formatter("{x:g}")
        panel.set_ylabel(f"residual of {signal}\n[s.d. without a gap]", fontsize=8.5)
        tidy(panel)
    panels[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, fontsize=8, frameon=False, borderpad=0.1)
    panels[-1].set_xlabel(f"time [{unit}]")
    return figure


def _with_what(report: "GapReport") -> str:
    """Return which effects the second residuals are with: the causes, else the nearest effect; "" without a gap."""
    from stickslip.gap.answers.report import UNKNOWN

    names = [cause.effect for cause in report.causes if cause.effect != UNKNOWN]
    if names:
        return f"with {' and '.join(names)}"
    return f"with {report.ranking[0].effect}, the nearest effect" if report.causes and report.ranking else ""
