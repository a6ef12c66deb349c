"""Figures of logs and loops: trends with gaps and bad samples shown, and phase plots."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from stickslip.logs.errors import LogError
from stickslip.logs.style import COLOURS, CYCLE
from stickslip.logs.time_axis import TimeAxis
from stickslip.logs.trend import broken_at_gaps, draw_signal, finish_panel, finish_plane, mark_gaps, shade_bad

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from stickslip.logs.log import Log
    from stickslip.logs.loop import LoopRecord

__all__ = ["COLOURS", "plot_log", "plot_loop"]

_MANY = 20_000  # points above which a line is drawn as pixels inside the vector file


def plot_log(log: Log, names: str | Sequence[str] | None = None) -> Figure:
    """One panel a signal over a common time axis.

    Parameters: ``log`` (Log); ``names`` (str or sequence of str, optional) Signals to show, all if not given.

    Missing samples and gaps in time break the line; bad stretches are shaded, bad values marked with a cross.

    Returns a matplotlib Figure. Raises LogError if a name is not in the log or there is nothing to show.

    >>> from stickslip.logs import Log
    >>> figure = plot_log(Log(t=[0, 1, 2], signals={"OP": [50, 51, 52]}, units={"OP": "%"}))
    >>> figure.axes[0].get_ylabel()
    'OP [%]'
    """
    from stickslip.logs.picture import Picture

    shown = [names] if isinstance(names, str) else list(log.names if names is None else names)
    if not shown:
        raise LogError("there is no signal to plot; name one of the log, or log one")
    for name in shown:
        log[name]
    figure = Picture(figsize=(9.0, 0.9 + 1.6 * len(shown)), layout="constrained")
    panels = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    axis = TimeAxis(log)
    for i, (panel, name) in enumerate(zip(panels, shown, strict=True)):
        draw_signal(panel, axis, log, name, COLOURS.get(name, CYCLE[i % len(CYCLE)]))
        shade_bad(panel, axis, log, log.good(name))
        mark_gaps(panel, axis, log)
        panel.set_ylabel(_label(log, name))
        finish_panel(panel, [log[name]])
    axis.finish(panels[-1], float(log.t[0]), float(log.t[-1]))
    if log.origin:
        figure.suptitle(log.origin, fontsize=10, x=0.01, ha="left")
    return figure


def plot_loop(loop: LoopRecord) -> Figure:
    """Trend of SP and PV, trend of OP (and MV), the PV-OP phase plot and, when MV is logged, the MV-OP one.

    In the phase plots, only good samples are joined: a sticky valve draws a parallelogram in MV-OP, and in PV-OP
    where the process is fast.

    Returns a matplotlib Figure.

    >>> from stickslip.logs import LoopRecord
    >>> figure = plot_loop(LoopRecord.from_arrays([0, 1, 2], pv=[1, 2, 3], op=[50, 51, 50]))
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['PV', 'OP [%]', 'PV']
    """
    from stickslip.logs.picture import Picture

    log = loop.log
    figure = Picture(figsize=(10.5, 5.0), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(2.1, 1.0))
    upper = figure.add_subplot(grid[0, 0])
    lower = figure.add_subplot(grid[1, 0], sharex=upper)
    axis = TimeAxis(log)
    if loop.sp_name is not None:
        draw_signal(upper, axis, log, loop.sp_name, COLOURS["SP"], "SP", drawstyle="steps-post")
    draw_signal(upper, axis, log, loop.pv_name, COLOURS["PV"], "PV")
    draw_signal(lower, axis, log, loop.op_name, COLOURS["OP"], "OP")
    if loop.mv_name is not None:
        draw_signal(lower, axis, log, loop.mv_name, COLOURS["MV"], "MV (stem)")
    for panel, name, part in ((upper, loop.pv_name, "PV"), (lower, loop.op_name, "OP")):
        shade_bad(panel, axis, log, loop.good)
        mark_gaps(panel, axis, log)
        panel.set_ylabel(_label(log, name, part))
        finish_panel(panel, [log[name]])
        panel.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=5, frameon=False, fontsize=9, borderpad=0.1)
    upper.tick_params(labelbottom=False)
    axis.finish(lower, float(log.t[0]), float(log.t[-1]))
    if loop.mv_name is None:
        _phase(figure.add_subplot(grid[:, 1]), loop, loop.pv_name, "PV")
    else:
        _phase(figure.add_subplot(grid[0, 1]), loop, loop.pv_name, "PV")
        _phase(figure.add_subplot(grid[1, 1]), loop, loop.mv_name, "MV")
    kind = ", ".join(word for word in (loop.measurement, loop.process.replace("_", "-")) if word != "unknown")
    title = " - ".join(word for word in (loop.name, kind.strip(", ")) if word)
    if title:
        figure.suptitle(title, fontsize=11, x=0.01, ha="left")
    return figure


def _phase(panel: Axes, loop: LoopRecord, name: str, part: str) -> None:
    log = loop.log
    good = loop.good
    x = np.where(good, loop.op, np.nan)
    y = np.where(good, log[name], np.nan)
    panel.plot(
        *broken_at_gaps(log, x, y),
        color=COLOURS[part],
        linewidth=0.6,
        alpha=0.75,
        rasterized=len(log) > _MANY,
    )
    panel.set_xlabel(_label(log, loop.op_name, "OP"))
    panel.set_ylabel(_label(log, name, part))
    panel.set_title(f"{part} over OP", fontsize=10)
    finish_plane(panel, [x], [y])


def _label(log: Log, name: str, part: str = "") -> str:
    unit = log.units.get(name, "")
    shown = part or name
    return f"{shown} [{unit}]" if unit else shown
