"""Figures of logs and loops: trends with gaps and bad samples shown, and phase plots."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from logs.errors import LogError
from logs.style import COLOURS, CYCLE, tidy
from logs.thinned import thinned

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from logs.arrays import Mask, Values
    from logs.log import Log
    from logs.loop import LoopRecord

__all__ = ["COLOURS", "plot_log", "plot_loop", "time_unit"]

_LINE = 0.9
_MANY = 20_000  # points above which a line is drawn as pixels inside the vector file


def plot_log(log: Log, names: str | Sequence[str] | None = None) -> Figure:
    """One panel a signal over a common time axis.

    Parameters: ``log`` (Log); ``names`` (str or sequence of str, optional) Signals to show, all if not given.

    Missing samples and gaps in time break the line; bad stretches are shaded, bad values marked with a cross.

    Returns a matplotlib Figure. Raises LogError if a name is not in the log or there is nothing to show.

    >>> from logs import Log
    >>> figure = plot_log(Log(t=[0, 1, 2], signals={"OP": [50, 51, 52]}, units={"OP": "%"}))
    >>> figure.axes[0].get_ylabel()
    'OP [%]'
    """
    from logs.picture import Picture

    shown = [names] if isinstance(names, str) else list(log.names if names is None else names)
    if not shown:
        raise LogError("there is no signal to plot; name one of the log, or log one")
    for name in shown:
        log[name]
    figure = Picture(figsize=(9.0, 0.9 + 1.6 * len(shown)), layout="constrained")
    panels = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    scale, unit = time_unit(log.duration)
    for i, (panel, name) in enumerate(zip(panels, shown, strict=True)):
        _trend(panel, log, name, COLOURS.get(name, CYCLE[i % len(CYCLE)]), scale)
        _shade_bad(panel, log.t, log.good(name), log.dt, scale)
        panel.set_ylabel(_label(log, name))
        _tidy(panel)
    panels[-1].set_xlabel(_time_label(log, unit))
    panels[-1].set_xlim(*_limits(log, scale))
    if log.origin:
        figure.suptitle(log.origin, fontsize=10, x=0.01, ha="left")
    return figure


def plot_loop(loop: LoopRecord) -> Figure:
    """Trend of SP and PV, trend of OP (and MV), the PV-OP phase plot and, when MV is logged, the MV-OP one.

    In the phase plots, only good samples are joined: a sticky valve draws a parallelogram in MV-OP, and in PV-OP
    where the process is fast.

    Returns a matplotlib Figure.

    >>> from logs import LoopRecord
    >>> figure = plot_loop(LoopRecord.from_arrays([0, 1, 2], pv=[1, 2, 3], op=[50, 51, 50]))
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['PV', 'OP [%]', 'PV']
    """
    from logs.picture import Picture

    log = loop.log
    figure = Picture(figsize=(10.5, 5.0), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(2.1, 1.0))
    upper = figure.add_subplot(grid[0, 0])
    lower = figure.add_subplot(grid[1, 0], sharex=upper)
    scale, unit = time_unit(log.duration)
    if loop.sp_name is not None:
        _trend(upper, log, loop.sp_name, COLOURS["SP"], scale, label="SP", step=True)
    _trend(upper, log, loop.pv_name, COLOURS["PV"], scale, label="PV")
    _trend(lower, log, loop.op_name, COLOURS["OP"], scale, label="OP")
    if loop.mv_name is not None:
        _trend(lower, log, loop.mv_name, COLOURS["MV"], scale, label="MV (stem)")
    for panel, name, part in ((upper, loop.pv_name, "PV"), (lower, loop.op_name, "OP")):
        _shade_bad(panel, log.t, loop.good, log.dt, scale)
        panel.set_ylabel(_label(log, name, part))
        _tidy(panel)
        panel.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, frameon=False, fontsize=9, borderpad=0.1)
    upper.tick_params(labelbottom=False)
    lower.set_xlabel(_time_label(log, unit))
    lower.set_xlim(*_limits(log, scale))
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


def time_unit(duration: float) -> tuple[float, str]:
    """Seconds in the unit that suits a record of ``duration`` [s], and its name.

    >>> time_unit(90.0), time_unit(7200.0), time_unit(3e5)
    ((1.0, 's'), (60.0, 'min'), (3600.0, 'h'))
    """
    if duration < 600:
        return 1.0, "s"
    if duration < 6 * 3600:
        return 60.0, "min"
    return (3600.0, "h") if duration < 10 * 86400 else (86400.0, "d")


def _trend(panel: Axes, log: Log, name: str, colour: str, scale: float, label: str = "", *, step: bool = False) -> None:
    good = log.good(name)
    x, y = thinned(*_broken_at_gaps(log, log.t / scale, np.where(good, log[name], np.nan)))
    panel.plot(
        x,
        y,
        color=colour,
        linewidth=_LINE,
        label=label or None,
        drawstyle="steps-post" if step else "default",
        marker="." if len(log) < 2 else "",
    )
    doubtful = ~good & np.isfinite(log[name])
    if doubtful.any():
        t, values = log.t[doubtful] / scale, log[name][doubtful]
        panel.plot(t, values, linestyle="", marker="x", markersize=3.5, color=COLOURS["bad"])


def _broken_at_gaps(log: Log, x: Values, y: Values) -> tuple[Values, Values]:
    """A missing point after the last sample before each gap, so that the line is not drawn across it."""
    after = np.searchsorted(log.t, [t1 for _, t1 in log.gaps()])
    return np.insert(x, after, x[after - 1]), np.insert(y, after, np.nan)


def _shade_bad(panel: Axes, t: Values, good: Mask, dt: float, scale: float) -> None:
    edges = np.flatnonzero(np.diff(np.concatenate([[True], good, [True]]).astype(np.int8)))
    reach = 0.5 * dt if np.isfinite(dt) else 0.0
    for i, (first, stop) in enumerate(zip(edges[::2], edges[1::2], strict=True)):
        panel.axvspan(
            (t[first] - reach) / scale,
            (t[stop - 1] + reach) / scale,
            color=COLOURS["bad"],
            alpha=0.10,
            linewidth=0,
            label="not good" if i == 0 else None,
        )


def _phase(panel: Axes, loop: LoopRecord, name: str, part: str) -> None:
    log = loop.log
    good = loop.good
    x = np.where(good, loop.op, np.nan)
    y = np.where(good, log[name], np.nan)
    panel.plot(
        *_broken_at_gaps(log, x, y),
        color=COLOURS[part],
        linewidth=0.6,
        alpha=0.75,
        rasterized=len(log) > _MANY,
    )
    panel.set_xlabel(_label(log, loop.op_name, "OP"))
    panel.set_ylabel(_label(log, name, part))
    panel.set_title(f"{part} over OP", fontsize=10)
    _tidy(panel)


def _tidy(panel: Axes) -> None:
    tidy(panel)
    panel.margins(y=0.08)
    panel.ticklabel_format(useOffset=False)


def _label(log: Log, name: str, part: str = "") -> str:
    unit = log.units.get(name, "")
    shown = part or name
    return f"{shown} [{unit}]" if unit else shown


def _time_label(log: Log, unit: str) -> str:
    if log.start is None:
        return f"time [{unit}]"
    return f"time [{unit}] from {log.start.isoformat(sep=' ', timespec='seconds')}"


def _limits(log: Log, scale: float) -> tuple[float, float]:
    low, high = float(log.t[0]) / scale, float(log.t[-1]) / scale
    return (low, high) if high > low else (low - 0.5, high + 0.5)
