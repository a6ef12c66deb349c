"""Parts that pictures of a study share: the heading, and log axes with plain numbers."""

from typing import TYPE_CHECKING

import numpy as np
from stickslip.logs.style import INK
from stickslip.study.findings import Findings

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DECADES = 5.0  # below the largest amplitude an oscillation is rounding


def head(figure: "Figure", result: Findings, subtitle: str) -> None:
    """Write what was studied above a figure."""
    counts = result.counts()
    runs = f"{counts['ok']} runs" + (f" ({len(result) - counts['ok']} without a result)" * (counts["ok"] < len(result)))
    since, until = result.request["measure_from"], result.request["duration"]
    figure.suptitle(
        f"{result.request['subject']}: {runs}, {since:g} to {until:g} s; {subtitle}",
        x=0.01, ha="left", fontsize=10.5, weight="bold", color=INK,
    )  # fmt: skip


def plain_numbers(ax: "Axes", which: str = "y") -> None:
    """Write the ticks of a log axis as plain numbers, with some between where it spans little."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis = ax.yaxis if which == "y" else ax.xaxis
    low, high = ax.get_ylim() if which == "y" else ax.get_xlim()
    few = np.log10(high / low) < 2.2
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,)))
    axis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    axis.set_minor_formatter(NullFormatter())
