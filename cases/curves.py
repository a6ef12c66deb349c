"""The thesis's pictures of the plant again: figures 5.1 to 5.6, B.1 and B.2, 1000 to 2000 s or one period of the sine.

Errors are set point less measurement, as printed.  Time plots keep every fifth sample.
"""

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from stickslip.cases.kicks import BAR, RPM, Floats
from stickslip.logs.style import COMMAND, STICTION, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from stickslip.diagram.simulation import Run

WIDTHS = {"none": 1.1, "normal": 1.6, "high": 1.0}
PRINTED = {"normal": (0.30, 0.26, 0.12, 0.13), "high": (0.30, 0.44, 0.29, 0.39)}  # table 5.4: m3, bar, bar, rpm
LOOPS = {"pressure": ("VPCS1", "p_1", "SP_PCS11", BAR, "bar"), "volume": ("VLCS1", "V_1", "SP_LCS11", 1.0, "m³")}
WINDOWS = {1: (1000.0, 2000.0), 2: (1400.0, 1900.0)}  # s; the thesis shows one period of the sine


@lru_cache(maxsize=6)
def run(F_s: str, case: int) -> "Run":
    """Return the run of a case; none with constant feed starts at rest, the others as the case says."""
    from stickslip.cases import find

    return find(f"plant_{case}_{F_s}").run(method="stiff")


def panels(rows: int, columns: int, title: str, height: float = 2.4) -> tuple["Figure", list["Axes"]]:
    """Return an empty figure with a grid of axes, row by row."""
    from stickslip.logs.picture import Picture

    figure = Picture(figsize=(10.0, height * rows), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False)
    figure.suptitle(title, fontsize=12, x=0.01, ha="left", fontweight="bold")
    for ax in axes.flat:
        tidy(ax)
    return figure, list(axes.flat)


def label(ax: "Axes", title: str, x: str, y: str) -> None:
    """Set the title and the axis labels of a panel."""
    ax.set_title(title, fontsize=10, loc="left")
    ax.set_xlabel(x, fontsize=9)
    ax.set_ylabel(y, fontsize=9)


def key_variables(case: int) -> "Figure":
    """Return figure 5.1 (case 1) or 5.4 (case 2): level, pressure, outlet pressure and speed, three sizes."""
    number, words = {1: ("5.1", "constant methane fraction"), 2: ("5.4", "sinusoidal methane fraction")}[case]
    figure, axes = panels(4, 1, f"Figure {number}: key process variables, {words}", 1.95)
    first, last = WINDOWS[case]
    for size, colour in STICTION.items():
        log = run(size, case).log
        kept = _between(log.t, first, last)
        t = log.t[kept]
        for ax, y in zip(
            axes,
            ((log["SP_LCS11"] - log["V_1"])[kept], (log["SP_PCS11"] - log["p_1"])[kept] / BAR,
             log["p_out2"][kept] / BAR, log["w"][kept] / RPM),
            strict=True,
        ):  # fmt: skip
            ax.plot(t, y, color=colour, linewidth=WIDTHS[size], label=f"{'no' if size == 'none' else size} stiction")
    titles = (("(a) separator 1, volume control error", "m³"), ("(b) separator 1, pressure control error", "bar"),
              ("(c) compressor 2, outlet pressure", "bar"), ("(d) shaft speed", "rpm"))  # fmt: skip
    for ax, (title, unit) in zip(axes, titles, strict=True):
        label(ax, title, "", unit)
        ax.ticklabel_format(axis="y", useOffset=False)
        ax.set_xlim(first, last)
        if ax is not axes[-1]:
            ax.tick_params(labelbottom=False)
    axes[-1].set_xlabel("time [s]", fontsize=9)
    if case == 1:
        _printed_amplitudes(axes)
    axes[0].legend(ncols=4, fontsize=8, frameon=False, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1)
    return figure


def _printed_amplitudes(axes: list["Axes"]) -> None:
    """Draw table 5.4's amplitudes as bars of two amplitudes beside the panels, about the middle of what is drawn."""
    for k, ax in enumerate(axes):
        for line, (size, place) in zip(ax.lines[1:], (("normal", 1.012), ("high", 1.03)), strict=True):
            y = np.asarray(line.get_ydata())
            middle, half = 0.5 * float(y.min() + y.max()), PRINTED[size][k]
            ax.plot(
                [place, place], [middle - half, middle + half], transform=ax.get_yaxis_transform(),
                color=STICTION[size], linewidth=3.5, solid_capstyle="butt", clip_on=False,
                label="printed, 2 A" if size == "high" else None,
            )  # fmt: skip


def _between(t: Floats, first: float, last: float) -> slice:
    """Return every fifth sample from ``first`` to ``last`` [s]."""
    a, b = np.searchsorted(t, [first - 1e-6, last + 1e-6]).tolist()
    return slice(a, b, 5)


def _four(case: int, number: str, what: str, mv: bool) -> "Figure":
    words = {1: "constant methane fraction", 2: "sinusoidal methane fraction"}[case]
    figure, axes = panels(2, 2, f"Figure {number}: {what} plots, {words}", 3.1)
    cells = [(loop, size) for loop in ("pressure", "volume") for size in ("normal", "high")]
    for ax, (loop, size), letter in zip(axes, cells, "abcd", strict=True):
        valve, pv, sp, unit, name = LOOPS[loop]
        log = run(size, case).log
        late = slice(int(np.searchsorted(log.t, 1000.0 - 1e-6)), None)
        op = 100.0 * log[f"OP_{valve}"][late]
        y = 100.0 * log[f"MV_{valve}"][late] if mv else (log[pv] - log[sp])[late] / unit
        x, y = thinned(op, y)
        ax.plot(x, y, color=STICTION[size], linewidth=0.8)
        label(ax, f"({letter}) {loop} control, {size} stiction", "OP [%]", "MV [%]" if mv else f"PV - SP [{name}]")
    return figure


def thinned(x: Floats, y: Floats, share: float = 0.002) -> tuple[Floats, Floats]:
    """Return a curve without the points that are nearer than ``share`` of its extent to the last one kept."""
    extent = np.array([np.ptp(x) or 1.0, np.ptp(y) or 1.0])
    points = np.column_stack([x, y]) / extent
    kept = [0]
    for i in range(1, len(points)):
        if np.abs(points[i] - points[kept[-1]]).max() >= share:
            if i - 1 > kept[-1]:
                kept.append(i - 1)  # where a jump begins
            kept.append(i)
    return x[kept], y[kept]


def mv_op(case: int) -> "Figure":
    """Return figure 5.2 (case 1) or 5.5 (case 2)."""
    return _four(case, {1: "5.2", 2: "5.5"}[case], "MV-OP", True)


def pv_op(case: int) -> "Figure":
    """Return figure 5.3 (case 1) or 5.6 (case 2)."""
    return _four(case, {1: "5.3", 2: "5.6"}[case], "PV-OP", False)


def valve_trends(case: int) -> "Figure":
    """Return figure B.1 (case 1) or B.2 (case 2): OP and MV over time."""
    words = {1: "constant methane fraction", 2: "sinusoidal methane fraction"}[case]
    figure, axes = panels(4, 1, f"Figure {({1: 'B.1', 2: 'B.2'})[case]}: OP and MV, {words}", 1.95)
    first, last = WINDOWS[case] if case == 1 else (1000.0, 2000.0)
    cells = [(loop, size) for loop in ("volume", "pressure") for size in ("normal", "high")]
    for ax, (loop, size), letter in zip(axes, cells, "abcd", strict=True):
        valve, log = LOOPS[loop][0], run(size, case).log
        kept = _between(log.t, first, last)
        ax.plot(log.t[kept], 100.0 * log[f"OP_{valve}"][kept], color=COMMAND, linewidth=1.1, label="OP")
        ax.plot(log.t[kept], 100.0 * log[f"MV_{valve}"][kept], color=STICTION[size], linewidth=1.1, label="MV")
        label(ax, f"({letter}) {loop} control valve, {size} stiction", "", "% of travel")
        ax.set_xlim(first, last)
        ax.legend(ncols=2, fontsize=8, frameon=False, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1)
        if ax is not axes[-1]:
            ax.tick_params(labelbottom=False)
    axes[-1].set_xlabel("time [s]", fontsize=9)
    return figure
