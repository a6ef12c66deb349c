"""Figures of what was simulated: the trends of a run with its events.

Where single cycles are too narrow to see, the picture has the band that they cover, and a panel with the last cycles.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from stickslip.blocks.block import Block
from stickslip.blocks.declared import STUCK_MODE
from stickslip.diagram.figures.finding import cycles, finding, swing
from stickslip.diagram.figures.panels import choose, heading, parts_played
from stickslip.diagram.figures.starting import to_cycle
from stickslip.diagram.simulation import Run
from stickslip.diagram.wired import UNNAMED
from stickslip.engine.status import Status
from stickslip.logs import Log
from stickslip.logs.style import COLOURS, CYCLE, EVENT, OUTSIDE, RED, SOFT, STUCK, tidy
from stickslip.logs.thinned import envelope, thinned
from stickslip.logs.time_axis import time_unit
from stickslip.logs.trend import finish_panel

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTHS = {"MV": 1.4}  # beside OP on grey paper
POINTS = 20_000  # of a line: a run is seen as it was logged up to there
LEAVES_UNSAID = 2000  # events beyond which single ticks say nothing
DENSE = 45.0  # cycles over a run: more are hatching
CLOSE = 6.0  # cycles in the panels beside
FOOT = 0.05  # of a panel: the height of the bar that says that a stem is stuck


def plot_run(run: Run, names: Sequence[str] | None = None) -> "Figure":
    """Return the trends of a run, SP with PV and OP with MV; at the foot stuck valves have a bar, other events a tick.

    ``names`` chooses the signals; without it all are shown if they fit, else those of controllers and valves.
    A run that failed says so in its title.  Raises ``ValueError`` for an unknown name.

    >>> from stickslip.blocks.sources import Ramp
    >>> from stickslip.diagram import simulate, wire
    >>> figure = plot_run(simulate(wire([Ramp("F", slope=0.1)], outputs=["F"]), 1200.0))
    >>> figure.axes[-1].get_xlabel(), figure.axes[0].get_ylabel()
    ('time [min]', 'F')
    """
    from matplotlib.ticker import MaxNLocator
    from stickslip.logs.picture import Picture

    diagram, log = run.final, run.log
    panels, left_out, squashing = choose(run, names)
    groups = list(dict.fromkeys(s.rpartition("/")[0] for shown in panels for s in shown if "/" in s))
    dense = {s: n for shown in panels for s in shown if (n := cycles(log, s)) > DENSE}
    figure = Picture(figsize=(9.5, 1.15 + 1.45 * len(panels)), layout="constrained")
    columns = figure.subplots(
        len(panels), 2 if dense else 1, sharex="col", sharey="row", squeeze=False,
        width_ratios=(2.4, 1.0) if dense else (1.0,),
    )  # fmt: skip
    scale, unit = time_unit(float(log.t[-1] - log.t[0]))
    begin, end = float(log.t[0]), float(max(log.t[-1], log.t[0] + 1e-9))
    for ax, shown in zip(columns[:, 0], panels, strict=True):
        _panel(ax, run, shown, groups, scale, dense)
        size, named = _unit(log, shown)
        finish_panel(ax, [log[s] / size for s in shown])
        if any((cycle := swing(log, s)) and not cycle[1] for s in shown):
            to_cycle(ax, log.t, np.array([log[s] for s in shown]) / size)
        ax.set_ylabel(heading(shown, named))
        _legend(ax, len(shown))
    columns[-1, 0].set_xlabel(f"time [{unit}]")
    columns[-1, 0].set_xlim(begin / scale, end / scale)
    if dense:
        since = max(begin, end - CLOSE * (end - begin) / float(np.median(list(dense.values()))))
        for ax, shown in zip(columns[:, 1], panels, strict=True):
            _panel(ax, run, shown, groups, scale, {}, since)
            tidy(ax)
        columns[0, 1].set_title("the last cycles", fontsize=8.5, loc="right", color=SOFT)
        columns[-1, 1].set_xlim(since / scale, end / scale)
        columns[-1, 1].set_xlabel(f"time [{unit}]")
        columns[-1, 1].xaxis.set_major_locator(MaxNLocator(3))
    axes = columns[:, 0]
    found = finding(run, [s for shown in panels for s in shown])
    title = ": ".join(word for word in (diagram.name if diagram.name != UNNAMED else "", found) if word)
    figure.suptitle(_wrapped(title or diagram.name, 100), x=0.01, ha="left", fontsize=11, weight="bold")
    notes = []
    if run.status is not Status.OK:
        notes.append((_wrapped(f"{run.status.name}: {run.hint}", 130), RED))
    unsaid = [f"{len(left_out)} more signals: choose with names="] if left_out else []
    if squashing:
        unsaid.append(f"at rest far off the scale: {', '.join(squashing)}")
    if unsaid:
        notes.append(("; ".join(unsaid), SOFT))
    for text, colour in notes[:1]:
        axes[0].set_title(text, loc="left", fontsize=8.5, color=colour, pad=16.0)
    for text, colour in notes[1:]:
        axes[-1].annotate(text, (1.0, 0.0), (0.0, -24.0), xycoords="axes fraction", textcoords="offset points",
                          ha="right", va="top", fontsize=8.5, color=colour)  # fmt: skip
    return figure


def _panel(
    ax: "Axes", run: Run, shown: Sequence[str], groups: Sequence[str], scale: float, dense: Mapping[str, float],
    since: float = -np.inf,
) -> None:  # fmt: skip
    """Draw the signals of a panel from ``since`` [s] on, and the events.

    Those of ``dense`` (signal -> number of cycles) are drawn as the band that they cover.
    """
    diagram, log = run.final, run.log
    size, _ = _unit(log, shown)
    parts = parts_played(diagram, shown)
    inside = log.t >= since
    t = log.t[inside] / scale
    for colour, part, signal in zip(_colours(parts, shown, groups), parts, shown, strict=True):
        y = log[signal][inside] / size
        height = 1.9 if part in ("SP", "OP") else _above(log, signal, shown)
        if signal in dense:
            at, low, high = envelope(t, y, max(20, int(dense[signal] / 1.5)))  # a whole cycle in each
            ax.fill_between(at, low, high, color=colour, alpha=0.35, linewidth=0.0, label=signal, zorder=height)
            continue
        ax.plot(
            *thinned(t, y, POINTS), color=colour, linewidth=WIDTHS.get(part, 0.9), label=signal, zorder=height,
            linestyle=(0, (4, 2)) if part == "SP" and len(shown) > 1 else "-",
        )  # fmt: skip
    for block in diagram.blocks:
        if block.modes and any(signal in shown for signal in block.output_labels):
            _mark(ax, block, run, scale)


def _unit(log: Log, shown: Sequence[str]) -> tuple[float, str]:
    """Return by what to divide a panel's values, and the unit they then have: pressures in bar, fractions in none."""
    units = {log.units.get(s, "") for s in shown}
    unit = units.pop() if len(units) == 1 else ""
    return (1e5, "bar") if unit == "Pa" else (1.0, "" if unit == "1" else unit)


def _above(log: Log, signal: str, shown: Sequence[str]) -> float:
    """Return the height at which a line is drawn: what moves little above what moves much."""
    moves = {s: float(np.nanmax(log[s]) - np.nanmin(log[s])) if np.isfinite(log[s]).any() else 0.0 for s in shown}
    return 2.0 + 0.01 * sum(moves[s] > moves[signal] for s in shown)


def _colours(parts: Sequence[str], shown: Sequence[str], groups: Sequence[str]) -> list[str]:
    """Return a colour for each signal.

    Where each is of another nested diagram, one for each of them, the same in all panels; else the house's for SP, PV,
    OP and MV.
    """
    own = [s.rpartition("/")[0] for s in shown]
    if len(set(own)) == len(own) and len(set(own) - {""}) > 1:
        return [CYCLE[groups.index(group) % len(CYCLE)] if group else OUTSIDE for group in own]
    if "PV" in parts or all(part in COLOURS for part in parts):
        spare = (colour for colour in CYCLE * len(parts) if colour not in COLOURS.values())
        return [COLOURS[p] if p in COLOURS and p not in parts[:i] else next(spare) for i, p in enumerate(parts)]
    return [CYCLE[i % len(CYCLE)] for i in range(len(parts))]


def modes_over_time(block: Block, run: Run) -> list[tuple[float, float, str]]:
    """Return the stretches (from, to, mode) of a block during a run [s]."""
    mine = [event for event in run.events if event.block == block.name]
    t0, t1 = float(run.log.t[0]), float(run.log.t[-1])
    if not mine:
        return [(t0, t1, block.mode or "")]
    times = [t0, *(event.t for event in mine), max(t1, mine[-1].t)]
    return [
        (a, b, mode) for a, b, mode in zip(times, times[1:], [mine[0].before, *(e.after for e in mine)], strict=False)
    ]


def _mark(ax: "Axes", block: Block, run: Run, scale: float) -> None:
    """A bar at the foot of the panel where a valve is stuck; ticks there at the other changes of mode."""
    across = ax.get_xaxis_transform()
    if block.can_stick:
        stuck = [
            (a / scale, (b - a) / scale) for a, b, mode in modes_over_time(block, run) if mode == STUCK_MODE and b > a
        ]
        if stuck:
            always = not any(event.block == block.name for event in run.events)
            ax.broken_barh(
                stuck, (0.0, FOOT), transform=across, facecolor=STUCK, linewidth=0, zorder=1.4,
                label="stuck throughout" if always else "stuck",
            )  # fmt: skip
        return
    times = [event.t / scale for event in run.events if event.block == block.name][:LEAVES_UNSAID]
    if times:
        name = block.name.rpartition("/")[2]
        ax.vlines(
            times, 0.0, 0.07, transform=across, color=EVENT, linewidth=0.7, zorder=1.5, label=f"{name} changes mode"
        )


def _legend(ax: "Axes", signals: int) -> None:
    handles, labels = ax.get_legend_handles_labels()
    if signals > 1 or len(labels) > 1:
        ax.legend(handles, labels, loc="lower right", bbox_to_anchor=(1.0, 0.98), ncols=min(len(labels), 6),
                  frameon=False, fontsize=8.0, borderpad=0.0, handlelength=1.6, columnspacing=1.2)  # fmt: skip


def _wrapped(text: str, width: int) -> str:
    import textwrap

    return "\n".join(textwrap.wrap(text, width))
