"""The picture of a scan: how many loops have which verdict, and how fast those swing that oscillate."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from stickslip.detect.words import WORDS
from stickslip.logs.style import BLUE, PALE, tidy

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from stickslip.scan.result import ScanResult

__all__ = ["plot_scan"]


def plot_scan(result: ScanResult) -> Figure:
    """Bars of the verdicts, and a histogram of the periods [s] on a logarithmic axis."""
    from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter
    from stickslip.logs.picture import Picture

    figure = Picture(figsize=(9.0, 3.2), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.2, 1.0))
    counts = result.counts
    rows = [(WORDS[word].spoken, WORDS[word].colour, counts[word]) for word in WORDS if word in counts]
    if counts.get("error"):
        rows.append(("could not be judged", PALE, counts["error"]))
    names, colours, numbers = zip(*rows, strict=True) if rows else ((), (), ())
    left.barh(names, numbers, color=colours, height=0.6)
    left.invert_yaxis()
    for i, number in enumerate(numbers):
        left.text(number, i, f"  {number}", va="center")
    left.set_xlabel("loops")
    left.margins(x=0.12)
    periods = result.table["period_s"].drop_nulls().to_numpy()
    if len(periods):
        edges = np.geomspace(0.9 * periods.min(), 1.1 * periods.max(), 25)
        right.hist(periods, bins=edges, color=BLUE)
        right.set_xscale("log")
        right.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        right.xaxis.set_major_formatter("{x:g}")
        right.xaxis.set_minor_formatter(NullFormatter())
    right.set_xlabel("period of the oscillation [s]")
    right.set_ylabel("loops")
    left.xaxis.set_major_locator(MaxNLocator(integer=True))
    right.yaxis.set_major_locator(MaxNLocator(integer=True))
    for ax in (left, right):
        tidy(ax)
    total = len(result.table)
    swinging = f"{len(periods)} of {total} loops oscillate"
    sticky = result.table.filter(result.table["verdict"] == "stiction")
    both = sticky["period_s"].count()
    of_these = f"; of all {total}, {len(sticky)} called sticky, {both} of them oscillating" if len(sticky) else ""
    figure.suptitle(f"{swinging}{of_these or '; none called sticky'}", x=0.01, ha="left")
    return figure
