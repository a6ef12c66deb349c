"""Figures of what was simulated: the trends of a run with its events, and the spread of an ensemble."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from blocks.block import Block
from blocks.declared import STUCK_MODE
from blocks.ports import nearest
from diagram.figures.panels import choose, heading, parts_played
from diagram.simulation import Run
from engine.status import Status
from logs import Log
from logs.style import COLOURS, CYCLE, EVENT, OUTSIDE, PALE, RED, SOFT, STUCK, tidy
from logs.time_axis import time_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from diagram.ensembles.result import Ensemble

Floats = NDArray[np.float64]

WIDTHS = {"MV": 1.4}  # beside OP on grey paper
POINTS = 1500  # as fine as the widest figure can show a band
SOME = 12  # variants drawn as lines
LEAVES_UNSAID = 2000  # events beyond which single ticks say nothing


def plot_run(run: Run, names: Sequence[str] | None = None) -> "Figure":
    """Return the trends of a run, SP with PV and OP with MV, stuck valves shaded and other events ticked.

    ``names`` chooses the signals; without it all are shown if they fit, else those of controllers and valves.
    A run that failed says so in its title.  Raises ``ValueError`` for an unknown name.

    >>> from blocks.sources import Ramp
    >>> from diagram import simulate, wire
    >>> figure = plot_run(simulate(wire([Ramp("F", slope=0.1)], outputs=["F"]), 1200.0))
    >>> figure.axes[-1].get_xlabel(), figure.axes[0].get_ylabel()
    ('time [min]', 'F')
    """
    from logs.picture import Picture

    diagram, log = run.final, run.log
    panels, left_out, squashing = choose(run, names)
    groups = list(dict.fromkeys(s.rpartition("/")[0] for shown in panels for s in shown if "/" in s))
    figure = Picture(figsize=(9.5, 1.15 + 1.45 * len(panels)), layout="constrained")
    axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    scale, unit = time_unit(float(log.t[-1] - log.t[0]))
    for ax, shown in zip(axes, panels, strict=True):
        size, named = _unit(log, shown)
        parts = parts_played(diagram, shown)
        for colour, part, signal in zip(_colours(parts, shown, groups), parts, shown, strict=True):
            ax.plot(
                log.t / scale, log[signal] / size, color=colour, linewidth=WIDTHS.get(part, 0.9), label=signal,
                rasterized=len(log) > 20_000, linestyle=(0, (4, 2)) if part == "SP" and len(shown) > 1 else "-",
                zorder=1.9 if part in ("SP", "OP") else _above(log, signal, shown),
            )  # fmt: skip
        for block in diagram.blocks:
            if block.modes and any(signal in shown for signal in block.output_labels):
                _mark(ax, block, run, scale)
        _tidy(ax)
        ax.set_ylabel(heading(shown, named))
        _legend(ax, len(shown))
    axes[-1].set_xlabel(f"time [{unit}]")
    axes[-1].set_xlim(log.t[0] / scale, max(log.t[-1], log.t[0] + 1e-9) / scale)
    figure.suptitle(diagram.name, x=0.01, ha="left", fontsize=11, weight="bold")
    notes = []
    if run.status is not Status.OK:
        notes.append((_wrapped(f"{run.status.name}: {run.hint}"), RED))
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


def _unit(log: Log, shown: Sequence[str]) -> tuple[float, str]:
    """Return by what to divide a panel's values, and the unit they then have: pressures in bar, fractions in none."""
    units = {log.units.get(s, "") for s in shown}
    unit = units.pop() if len(units) == 1 else ""
    return (1e5, "bar") if unit == "Pa" else (1.0, "" if unit == "1" else unit)


def _above(log: Log, signal: str, shown: Sequence[str]) -> float:
    """Return the height at which a line is drawn: what moves little above what moves much."""
    moves = {s: float(np.nanmax(log[s]) - np.nanmin(log[s])) if np.isfinite(log[s]).any() else 0.0 for s in shown}
    return 2.0 + 0.01 * sum(moves[s] > moves[signal] for s in shown)


def plot_ensemble(result: "Ensemble", signal: str) -> "Figure":
    """Return the spread of a signal over the variants that reached their end: median, 5 to 95 %, some variants.

    Raises ``ValueError`` if the signal was not kept or no variant reached its end.
    """
    from logs.picture import Picture

    if signal not in result.values:
        raise ValueError(f"the ensemble kept no signal '{signal}'; {nearest(signal, list(result.values))}")
    whole = np.flatnonzero(result.ok)
    if not whole.size:
        raise ValueError(f"no variant reached its end, there is nothing to plot; the first: {result.hint(0)}")
    stride = -(-result.t.shape[-1] // POINTS)
    t, values = result.t[..., ::stride], result.values[signal][whole, ::stride]
    t = t if t.ndim == 1 else t[0] - t[0, 0]  # windows side by side: time since each began
    low, middle, high = np.percentile(values, [5.0, 50.0, 95.0], axis=0)
    scale, unit = time_unit(float(t[-1] - t[0]))
    figure = Picture(figsize=(9.5, 3.6), layout="constrained")
    ax = figure.subplots()
    ax.fill_between(t / scale, low, high, color=CYCLE[0], alpha=0.18, linewidth=0, label="5 to 95 %")
    some = whole[np.linspace(0, whole.size - 1, min(SOME, whole.size)).astype(int)]
    for k, i in enumerate(some):
        label = f"{len(some)} of {len(result)} variants" if k == 0 else None
        ax.plot(t / scale, result.values[signal][i, ::stride], color=PALE, linewidth=0.5, alpha=0.8, label=label)
    ax.plot(t / scale, middle, color=CYCLE[0], linewidth=1.6, label="median")
    _tidy(ax)
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, frameon=False, fontsize=8.5, borderpad=0.1)
    unit_y = result.variants.diagram.signal_units.get(signal, "")
    ax.set_ylabel(f"{signal} [{unit_y}]" if unit_y not in ("", "1") else signal)
    ax.set_xlabel(f"time [{unit}]")
    ax.set_xlim(t[0] / scale, t[-1] / scale)
    failed = len(result) - whole.size
    told = f"{result.variants.diagram.name}: {', '.join([*result.params, *result.start]) or 'seeds'} vary"
    figure.suptitle(told, x=0.01, ha="left", fontsize=11, weight="bold")
    if failed:
        ax.set_title(f"{failed} variants not shown: they did not reach the end", loc="left", fontsize=8.5, color=RED)
    return figure


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
    """Shade where a valve is stuck; tick the other changes of mode at the foot of the panel."""
    across = ax.get_xaxis_transform()
    if block.can_stick:
        stuck = [
            (a / scale, (b - a) / scale) for a, b, mode in modes_over_time(block, run) if mode == STUCK_MODE and b > a
        ]
        if stuck:
            ax.broken_barh(
                stuck, (0.0, 1.0), transform=across, facecolor=STUCK, alpha=0.55, linewidth=0, zorder=0.5, label="stuck"
            )
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


def _wrapped(text: str, width: int = 130) -> str:
    import textwrap

    return "\n".join(textwrap.wrap(text, width))


def _tidy(ax: Any) -> None:
    tidy(ax)
    ax.margins(y=0.1)
    ax.ticklabel_format(useOffset=False, axis="y")
