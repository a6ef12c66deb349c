"""The axis of a steady cycle that a short start-up would squeeze: it fits the cycle, and says how far that goes."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from stickslip.diagram.figures.finding import later
from stickslip.logs.style import SOFT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["to_cycle"]

SQUEEZED = 0.6  # of the axis: a cycle that has less of it is squeezed by the start-up
START = 0.15  # of the run: what lies off a cycle later is no start-up, but a part of the story
AROUND = 0.15  # of a cycle, above and below it


def to_cycle(ax: "Axes", t: NDArray[np.float64], values: NDArray[np.float64]) -> None:
    """Give a panel the limits of what it shows in the later half where a short start-up squeezes that.

    ``values`` (lines, rows) are drawn over ``t`` (rows,).
    """
    late = values[:, later(t)]
    low, high = float(np.nanmin(late)), float(np.nanmax(late))
    lowest, highest = float(np.nanmin(values)), float(np.nanmax(values))
    low, high = low - AROUND * (high - low), high + AROUND * (high - low)
    off = t[((values < low) | (values > high)).any(axis=0)]
    if high - low > SQUEEZED * (highest - lowest) or (len(off) and off[-1] - t[0] > START * (t[-1] - t[0])):
        return
    ax.set_ylim(low, high)
    digits = max(0, 1 - int(np.floor(np.log10(high - low))))
    for gone, value, way, height in ((lowest < low, lowest, "down", 0.1), (highest > high, highest, "up", 0.9)):
        if gone:
            label = f"start-up goes {way} to {value:.{digits}f}"
            ax.annotate(label, (0.0, height), (8.0, 0.0), xycoords="axes fraction", textcoords="offset points",
                        va="center", fontsize=8.0, color=SOFT)  # fmt: skip
