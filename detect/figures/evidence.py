"""Small pictures of the evidence on a loop: PV and stem against OP, spectrum, correlations, the verdict over time."""

import math
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from stickslip.detect.figures.loop_trend import named, shown_cycles
from stickslip.detect.figures.verdict import finish, legend
from stickslip.detect.words import WORDS
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values
from stickslip.logs.picture import Picture
from stickslip.logs.style import COLOURS, FIT, PALE, SOFT, tidy
from stickslip.logs.time_axis import TimeAxis, time_unit
from stickslip.logs.trend import finish_plane, rests

if TYPE_CHECKING:
    from stickslip.detect.evidence import Correlation, OverTime, Spectrum, StemTrend

SMALL = (4.7, 3.5)  # inch: two beside each other on a page, one on a phone
POINTS = 1500  # of the whole record behind the cycles: a page holds each of them
CELLS = 120  # across a picture: two samples in one cell look like one
MOST = (0.005, 0.995)  # of the record's values, between which the axes span
ROOM = 0.07  # beyond, on both sides
HARMONICS = 6.5  # of the fundamental: as far as the spectrum is drawn


def _small() -> "tuple[Figure, Axes]":
    figure = Picture(figsize=SMALL, layout="constrained")
    return figure, figure.subplots()


def plot_pv_op(record: LoopRecord, period: float, stem: "StemTrend | None") -> Figure:
    """PV against OP: the cycles of the trend in colour on the whole record in grey."""
    figure, ax = _small()
    t0, t1 = shown_cycles(record, period, stem)
    good = record.good
    kept = _seen(record.op[good], record.pv[good])
    ax.plot(record.op[good][kept], record.pv[good][kept], ".", color=PALE, ms=1.6, alpha=0.35)
    ax.plot([], [], ".", color=PALE, ms=6.0, label="whole record")  # seen in the legend, too
    inside = (record.t >= t0) & (record.t <= t1)
    x, y = (np.where(good, values, np.nan)[inside] for values in (record.op, record.pv))
    ax.plot(x, y, color=COLOURS["PV"], lw=0.9, label="the cycles shown")
    ax.set_xlabel(named(record, record.op_name, "OP"))
    ax.set_ylabel(named(record, record.pv_name, "PV"))
    legend(ax)
    finish_plane(ax, [record.op[good]], [record.pv[good]])
    for values, cycles, limits in ((record.op[good], x, ax.set_xlim), (record.pv[good], y, ax.set_ylim)):
        if not rests(values):
            limits(*_widest(values, cycles))
    return figure


def _widest(values: Values, cycles: Values) -> tuple[float, float]:
    """Return limits that hold the cycles and nearly all of the record: a start-up would squeeze both."""
    ends = [*np.quantile(values, MOST).tolist(), *cycles[np.isfinite(cycles)].tolist()]
    room = ROOM * (max(ends) - min(ends))
    return min(ends) - room, max(ends) + room


def _seen(x: Values, y: Values) -> npt.NDArray[np.int64]:
    """Places of samples (n,) that look different in a picture: one of each cell, at most ``POINTS``."""
    cells = [np.floor(CELLS * (v - v.min()) / (np.ptp(v) or 1.0)) for v in (x, y)]
    _, first = np.unique(cells[0] * (2.0 * CELLS) + cells[1], return_index=True)
    return first[:: max(1, -(-len(first) // POINTS))]


def plot_stem_op(record: LoopRecord, period: float, stem: "StemTrend") -> Figure:
    """The stem against OP: level where it sticks, steep where it slips, on the line where it follows."""
    figure, ax = _small()
    t0, t1 = shown_cycles(record, period, stem)
    inside = (stem.t >= t0) & (stem.t <= t1)
    ends = np.array([np.min(stem.op[inside]), np.max(stem.op[inside])])
    if not stem.logged:
        ax.plot(ends, ends, color=FIT, lw=0.8, ls=":", label="a valve that follows")
    label = "MV, logged" if stem.logged else "stem, reconstructed"
    ax.plot(stem.op[inside], stem.mv[inside], color=COLOURS["MV"], lw=1.0, label=label)
    ax.set_xlabel(named(record, record.op_name, "OP"))
    ax.set_ylabel("MV" if stem.logged else named(record, record.op_name, "stem").replace("stem", "estimated MV"))
    legend(ax)
    finish_plane(ax, [stem.op[inside]], [stem.mv[inside]])
    return figure


def plot_spectrum(found: "Spectrum") -> Figure:
    """Amplitudes of OP and PV over frequency, with the fundamental and its harmonics marked."""
    figure, ax = _small()
    known = math.isfinite(found.fundamental)
    scale, unit = _per(found.fundamental if known else float(found.f[int(np.argmax(found.pv))]))
    highest = HARMONICS * found.fundamental if known else float(found.f[-1])
    shown = found.f <= max(highest, float(found.f[min(20, len(found.f) - 1)]))
    for k in range(1, 6 if known else 0):
        if k * found.fundamental <= found.f[shown][-1]:
            at = k * found.fundamental * scale
            ax.axvline(at, color=FIT, lw=0.9 if k == 1 else 0.6, ls="-" if k == 1 else ":", zorder=0.8)
            ax.annotate(
                "period" if k == 1 else f"{k}", (at, 1.0), (2, -2), xycoords=("data", "axes fraction"),
                textcoords="offset points", va="top", fontsize=7.5, color=SOFT,
            )  # fmt: skip
    for values, part in ((found.op, "OP"), (found.pv, "PV")):
        ax.plot(found.f[shown] * scale, np.maximum(values[shown], 1e-5), color=COLOURS[part], lw=1.0, label=part)
    ax.set_yscale("log")
    ax.set_ylim(2e-3, 2.0)
    ax.set_yticks([0.01, 0.1, 1.0], ["1 %", "10 %", "100 %"])
    ax.minorticks_off()
    ax.set_xlim(0.0, float(found.f[shown][-1]) * scale)
    finish(ax, f"frequency [1/{unit}]", "amplitude over the largest line", named=True)
    return figure


def _per(frequency: float) -> tuple[float, str]:
    """What a frequency in Hz is multiplied by, and the unit of time it is then counted in."""
    for seconds, unit in ((1.0, "s"), (60.0, "min"), (3600.0, "h")):
        if frequency * seconds >= 0.2:
            return seconds, unit
    return 86400.0, "d"


def plot_correlation(found: "Correlation") -> Figure:
    """OP and PV each with itself above; PV behind OP below, with the lag of the closest likeness."""
    figure = Picture(figsize=SMALL, layout="constrained")
    upper, lower = figure.subplots(2, 1)
    scale, unit = time_unit(float(found.lags[-1]) * 2.0)
    m = len(found.op)
    for values, part in ((found.op, "OP"), (found.pv, "PV")):
        upper.plot(found.lags[m - 1 :] / scale, values, color=COLOURS[part], lw=1.1, label=part)
    lower.plot(found.lags / scale, found.both, color=FIT, lw=1.1)
    lower.axvline(0.0, color=PALE, lw=0.8)
    lower.plot([found.lag / scale], [found.at_lag], "o", ms=5, color=COLOURS["bad"])
    for ax in (upper, lower):
        ax.axhline(0.0, color=PALE, lw=0.8)
        ax.set_ylim(-1.1, 1.1)
        ax.margins(x=0.0)
        tidy(ax)
    upper.set_ylabel("with itself [-]", fontsize=8.5)
    lower.set_ylabel("PV behind OP [-]", fontsize=8.5)
    lower.set_xlabel(f"lag [{unit}]")
    legend(upper)
    return figure


def plot_over_time(found: "OverTime") -> Figure:
    """Probability of stiction and S with their 90 % intervals, window by window; a panel only for what is known.

    A stem that is logged answers without a probability.
    """
    drawers = [_chances] * any(w.probability is not None for w in found.windows)
    drawers += [_sizes] * any(w.S is not None for w in found.windows)
    figure = Picture(figsize=(9.6, 0.4 + 1.6 * max(len(drawers), 1)), layout="constrained")
    panels = figure.subplots(max(len(drawers), 1), 1, sharex=True, squeeze=False)[:, 0]
    axis = TimeAxis(found.record.log)
    for ax, draw in zip(panels, drawers, strict=False):
        draw(ax, axis, found)
        ax.tick_params(labelbottom=ax is panels[-1])
    for ax in panels:
        tidy(ax)
    axis.finish(panels[-1], float(found.record.t[0]), float(found.record.t[-1]))
    return figure


def _chances(ax: Axes, axis: TimeAxis, found: "OverTime") -> None:
    """The probability of every window."""
    for w in found.windows:
        if w.probability is not None:
            ends = axis.at(np.array([w.start, w.end]))
            ax.plot(ends, [w.probability] * 2, color=WORDS[w.verdict].colour, lw=3.0, solid_capstyle="butt")
    ax.set_ylim(-0.05, 1.05)
    ax.set_yticks([0.0, 0.5, 1.0], ["0", "50 %", "100 %"])
    ax.set_ylabel("probability\nof stiction")


def _sizes(ax: Axes, axis: TimeAxis, found: "OverTime") -> None:
    """S of every window with its interval; the verdict where none is called."""
    for w in found.windows:
        x = float(axis.at(np.array([0.5 * (w.start + w.end)]))[0])
        if w.S is not None:
            ax.plot([x, x], [w.S.low, w.S.high], color=COLOURS["bad"], lw=1.6)
            ax.plot([x], [w.S.value], "o", color=COLOURS["bad"], ms=5)
            continue
        ax.annotate(
            WORDS[w.verdict].spoken, (x, 0.04), xycoords=("data", "axes fraction"), ha="center", fontsize=7.5,
            color=SOFT, rotation=90 if len(found.windows) > 7 else 0,
        )  # fmt: skip
    unit = next(w.S.unit for w in found.windows if w.S is not None)
    ax.set_ylabel(f"S [{unit}]")
    ax.set_ylim(0.0, 1.15 * max(w.S.high for w in found.windows if w.S is not None))
