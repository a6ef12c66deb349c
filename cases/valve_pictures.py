"""The valve itself as the thesis draws it: figure 4.1, MV over OP of a sticky stem, and 4.2, friction over speed.

Figure 4.1 is a run: OP rises and falls slowly, and the stem of table A.1 with high stiction follows.  Figure 4.2 is
eq. 4.5: F_v v + F_c sgn(v) in motion, anything up to F_s at rest.
"""

from typing import TYPE_CHECKING

import numpy as np
from stickslip.cases.curves import label, panels
from stickslip.logs.style import COMMAND, INK
from stickslip.logs.style import STICTION as COLOUR
from stickslip.plant.parameters import STICTION, Stem

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PERIOD, LOW, HIGH = 400.0, 0.3, 0.5  # s; OP goes up and down between these


def figure_4_1() -> "Figure":
    """Return figure 4.1: MV over OP, with deadband, stickband and slip jump."""
    from stickslip.blocks import StickSlip, Triangle
    from stickslip.diagram import simulate, wire

    F_s, stem = STICTION["high"], Stem()
    middle, swing = 0.5 * (LOW + HIGH), 0.5 * (HIGH - LOW)
    op = Triangle("OP", swing, PERIOD, mean=middle)
    valve = StickSlip(F_s, stem.F_c, k=stem.k, M=stem.M, F_v=stem.F_v, start=middle)
    log = simulate(wire([op, valve], name="figure_4_1"), 2.0 * PERIOD, every=0.05).log
    late = log.t >= 0.75 * PERIOD  # once round and back
    figure, (ax,) = panels(1, 1, "Figure 4.1: MV-OP plot characteristic for stiction", 4.2)
    ax.plot([100.0 * LOW, 100.0 * HIGH], [100.0 * LOW, 100.0 * HIGH], color=COMMAND, linewidth=0.9, label="no friction")
    ax.plot(100.0 * log["OP"][late], 100.0 * log["MV"][late], color=COLOUR["high"], linewidth=1.3, label="stem")
    f_s, f_c = 100.0 * F_s / stem.k, 100.0 * stem.F_c / stem.k
    low, high = 100.0 * LOW + f_c, 100.0 * HIGH - f_c  # where the stem rests
    corners = {
        "A": (100.0 * LOW, low, -12, -4), "C": (low + f_s, low, 4, -12), "D": (low + f_s, low + f_s - f_c, -12, 4),
        "E": (100.0 * HIGH, high, 6, -4), "F": (high - f_s, high, -4, 6),
        "G": (high - f_s, high - f_s + f_c, 6, -6),
    }  # fmt: skip
    for name, (x, y, right, up) in corners.items():
        ax.annotate(name, (x, y), (right, up), textcoords="offset points", fontsize=10, fontweight="bold")
    _measure(ax, 100.0 * LOW, low + f_s, low - 0.8, f"deadband and stickband S = {f_s + f_c:.1f} %")
    ax.annotate(f"slip jump J = {f_s - f_c:.1f} %", (low + f_s, low + 0.5 * (f_s - f_c)), (10, -4),
                textcoords="offset points", fontsize=9)  # fmt: skip
    label(ax, "", "OP [%]", "MV [%]")
    ax.legend(fontsize=8, frameon=False, loc="upper left")
    return figure


def _measure(ax: "Axes", left: float, right: float, y: float, words: str) -> None:
    """Draw a double arrow from ``left`` to ``right`` at ``y`` with words under it."""
    ax.annotate("", (left, y), (right, y), arrowprops={"arrowstyle": "<->", "color": COMMAND})
    ax.text(0.5 * (left + right), y - 0.25, words, ha="center", va="top", fontsize=9)


def figure_4_2() -> "Figure":
    """Return figure 4.2: friction over the speed of the stem for the three sizes of stiction."""
    stem = Stem()
    figure, (ax,) = panels(1, 1, "Figure 4.2: friction force of the stem", 3.2)
    v = np.linspace(0.0, 2.0, 50)  # travel/s
    for sign in (-1.0, 1.0):
        ax.plot(sign * v, sign * (stem.F_c + stem.F_v * v), color=INK, linewidth=1.3)
    for size, F_s in STICTION.items():
        name = "no" if size == "none" else size
        ax.plot([0.0, 0.0], [-F_s, F_s], "o", color=COLOUR[size], markersize=5, label=f"F_s, {name} stiction")
    top = max(STICTION.values())
    ax.plot([0.0, 0.0], [-top, top], color=COLOUR["high"], linewidth=1.0, zorder=1)
    ax.annotate("F_c + F_v v", (1.2, stem.F_c + 1.2 * stem.F_v), (8, -14), textcoords="offset points", fontsize=9)
    label(ax, "", "speed of the stem [travel/s]", "friction [N]")
    ax.legend(fontsize=8, frameon=False, loc="lower right")
    return figure
