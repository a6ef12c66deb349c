"""Pictures of a gap report: the residuals of every logged signal, before and after the causes are put in."""

from typing import TYPE_CHECKING

import numpy as np

from logs.style import GREEN, RED, tidy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gap.report import GapReport

MOST = 4000  # points of a line; more are thinned
HIGHEST = 1e3  # of the scale: beyond, a residual is just large


def plot_residuals(report: "GapReport") -> "Figure":
    """Return one panel a signal: its innovations, 1 = standard deviation without a gap, on a scale linear up to 3."""
    from logs.picture import Picture

    figure = Picture(figsize=(9.0, 0.9 + 1.9 * len(report.residuals)), layout="constrained")
    panels = figure.subplots(len(report.residuals), 1, sharex=True, squeeze=False)[:, 0]
    every = max(1, len(report.t) // MOST)
    for panel, (signal, both) in zip(panels, report.residuals.items(), strict=True):
        for values, colour, label in zip(both, (RED, GREEN), ("model as it is", "with the cause"), strict=True):
            if label == "with the cause" and not report.causes:
                continue
            shown = np.clip(values[::every], -HIGHEST, HIGHEST)
            panel.plot(report.t[::every] / 60.0, shown, color=colour, linewidth=0.6, label=label)
        panel.set_yscale("symlog", linthresh=3.0)
        panel.set_ylabel(f"residual of {signal}\n[s.d. without a gap]", fontsize=8.5)
        tidy(panel)
    panels[0].legend(loc="upper right", fontsize=8, frameon=False)
    panels[-1].set_xlabel("time [min]")
    return figure
