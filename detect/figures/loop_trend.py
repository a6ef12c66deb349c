"""The trend of a loop over its whole record, and a few cycles of it with the stem and its sticks."""

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from stickslip.detect.figures.verdict import legend
from stickslip.logs import LoopRecord
from stickslip.logs.picture import Picture
from stickslip.logs.style import COLOURS, EVENT
from stickslip.logs.time_axis import TimeAxis
from stickslip.logs.trend import draw_signal, finish_panel, mark_gaps, shade_bad

if TYPE_CHECKING:
    from stickslip.detect.evidence import StemTrend

CYCLES = 8.0  # in the picture of a few cycles
SAMPLES = 600  # shown where nothing oscillates


def draw_trends(record: LoopRecord, upper: Axes, lower: Axes, *, sticks: "StemTrend | None" = None) -> None:
    """Draw PV with SP above and OP below over the whole record, gaps and samples that do not count shaded.

    With ``sticks`` the stretches in which the stem stood while OP moved are marked below OP.
    """
    log = record.log
    axis = TimeAxis(log)
    if record.sp_name is not None:
        dashed = (0, (4, 2))
        draw_signal(upper, axis, log, record.sp_name, COLOURS["SP"], "SP", record.good, linestyle=dashed, zorder=3)
    draw_signal(upper, axis, log, record.pv_name, COLOURS["PV"], "PV", record.good)
    draw_signal(lower, axis, log, record.op_name, COLOURS["OP"], "OP", record.good)
    for panel, name, part in ((upper, record.pv_name, "PV"), (lower, record.op_name, "OP")):
        mark_gaps(panel, axis, log)
        shade_bad(panel, axis, log, record.good)
        panel.set_ylabel(named(record, name, part))
        finish_panel(panel, [log[name][record.good]])
    if sticks is not None:
        _mark_sticks(lower, axis, sticks)
    for panel in (upper, lower):
        legend(panel)
    axis.finish(lower, float(log.t[0]), float(log.t[-1]))
    upper.tick_params(labelbottom=False)


def _mark_sticks(ax: Axes, axis: TimeAxis, stem: "StemTrend") -> None:
    """A bar at the foot of the panel wherever the stem stood while OP moved."""
    if len(stem.sticks):
        ax.broken_barh(
            [(a, b - a) for a, b in axis.at(stem.sticks).tolist()], (0.0, 0.045), transform=ax.get_xaxis_transform(),
            facecolor=EVENT, alpha=0.8, linewidth=0, label="stem stands while OP moves",
        )  # fmt: skip


def plot_trend(record: LoopRecord, stem: "StemTrend | None" = None) -> Figure:
    """The whole record; a long one as the envelope of its lowest and highest values."""
    figure = Picture(figsize=(9.6, 3.9), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    draw_trends(record, upper, lower, sticks=stem)
    return figure


def shown_cycles(record: LoopRecord, period: float, stem: "StemTrend | None") -> tuple[float, float]:
    """From where to where a few cycles are shown [s]: the last ones, where the stem is known if it is."""
    t0, t1 = (float(record.t[0]), float(record.t[-1])) if stem is None else (float(stem.t[0]), float(stem.t[-1]))
    width = SAMPLES * (record.dt if stem is None else max(record.dt, float(stem.t[1] - stem.t[0])))
    width = CYCLES * period if math.isfinite(period) else width
    return max(t0, t1 - width), t1


def plot_cycles(record: LoopRecord, period: float, stem: "StemTrend | None") -> Figure:
    """The last few cycles: PV with SP, and OP with the stem; dotted where it slips, a bar where it stands."""
    from dataclasses import replace

    t0, t1 = shown_cycles(record, period, stem)
    part = replace(record, log=record.log.between(t0, t1))
    log, axis = part.log, TimeAxis(part.log)
    figure = Picture(figsize=(9.6, 3.9), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    if part.sp_name is not None:
        draw_signal(upper, axis, log, part.sp_name, COLOURS["SP"], "SP", linestyle=(0, (4, 2)), drawstyle="steps-post")
    draw_signal(upper, axis, log, part.pv_name, COLOURS["PV"], "PV", part.good, linewidth=1.1)
    draw_signal(lower, axis, log, part.op_name, COLOURS["OP"], "OP", part.good, linewidth=1.1)
    beside = [log[part.op_name][part.good]]
    if stem is not None:
        inside = (stem.t >= t0) & (stem.t <= t1)
        mv = stem.mv[inside]
        if not stem.logged or _one_scale(mv, beside[0]):
            said = "MV" if stem.logged else "stem, reconstructed"
            lower.plot(axis.at(stem.t[inside]), mv, color=COLOURS["MV"], lw=1.4, label=said, drawstyle="steps-post")
            beside.append(mv)
        _mark_sticks(lower, axis, stem)
        for panel in (upper, lower):
            panel.vlines(
                axis.at(stem.slips[(stem.slips > t0) & (stem.slips < t1)]), 0.0, 1.0, color=EVENT, lw=0.8, ls=":",
                transform=panel.get_xaxis_transform(), zorder=0.9, label="stem slips" if panel is upper else None,
            )  # fmt: skip
    for panel, name, known in ((upper, "PV", [log[part.pv_name][part.good]]), (lower, "OP", beside)):
        mark_gaps(panel, axis, log)
        panel.set_ylabel(named(part, part.pv_name if name == "PV" else part.op_name, name))
        finish_panel(panel, known)
        legend(panel)
    axis.finish(lower, t0, t1)
    upper.tick_params(labelbottom=False)
    return figure


def _one_scale(mv: np.ndarray, op: np.ndarray) -> bool:
    """Whether the stem lies near enough to OP to share its axis."""
    if not len(mv) or not len(op):
        return False
    low, high = min(np.nanmin(mv), np.nanmin(op)), max(np.nanmax(mv), np.nanmax(op))
    return bool(high - low <= 4.0 * max(np.ptp(op), 1e-12))


def named(record: LoopRecord, name: str, part: str) -> str:
    """What stands at the axis of a signal: its part in the loop, and its unit where it is known."""
    unit = record.log.units.get(name)
    return f"{part} [{unit}]" if unit else part
