"""Figures of what was simulated: the trends of a run with its events, and the spread of an ensemble."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from blocks.block import Block
from blocks.ports import Port, nearest
from engine.status import Status
from plant.diagram import Diagram
from plant.simulate import Run
from records import Log
from records.plots import COLOURS, time_unit
from records.style import SOFT, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from plant.portfolio import Ensemble

Floats = NDArray[np.float64]

PANELS = 8  # most panels when nobody says which signals to show
TOGETHER = 4  # most signals on one axis that share no more than a unit
ALIKE = 5.0  # how far the ranges of two signals may differ to share an axis for their unit alone
CYCLE = ("#1f4e79", "#c55a11", "#2e7d32", "#6a3d9a", "#00798c", "#7f6000")
STUCK, EVENT, FAILED = "#f3d9b8", "#8a5a2b", "#b00020"
POINTS = 1500  # as fine as the widest figure can show a band
SOME = 12  # members drawn as lines
LEAVES_UNSAID = 2000  # events beyond which single ticks say nothing


def plot_run(run: Run, names: Sequence[str] | None = None) -> "Figure":
    """Return the trends of a run, SP with PV and OP with MV, stuck valves shaded and other events ticked.

    ``names`` chooses the signals; without it all are shown if they fit, else those of controllers and valves.
    A run that failed says so in its title.  Raises ``ValueError`` for an unknown name.

    >>> from blocks.sources import Ramp
    >>> from plant import simulate, wire
    >>> figure = plot_run(simulate(wire([Ramp("F", slope=0.1)], outputs=["F"]), 1200.0))
    >>> figure.axes[-1].get_xlabel(), figure.axes[0].get_ylabel()
    ('time [min]', 'F')
    """
    from matplotlib.figure import Figure

    diagram, log = run.final, run.log
    panels, left_out = _panels(diagram, log, names)
    figure = Figure(figsize=(9.5, 1.15 + 1.45 * len(panels)), layout="constrained")
    axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    scale, unit = time_unit(float(log.t[-1] - log.t[0]))
    for ax, shown in zip(axes, panels, strict=True):
        parts = _parts(diagram, shown)
        for colour, port, signal in zip(_colours(parts), parts, shown, strict=True):
            ax.plot(
                log.t / scale, log[signal], color=colour, linewidth=0.9, label=signal, rasterized=len(log) > 20_000,
                linestyle=(0, (4, 2)) if port == "SP" and len(shown) > 1 else "-",
                zorder=1.9 if port in ("SP", "OP") else 2.0,
            )  # fmt: skip
        for block in diagram.blocks:
            if block.modes and any(signal in shown for signal in block.output_labels):
                _mark(ax, block, run, scale)
        _tidy(ax)
        ax.set_ylabel(_title(shown, log))
        _legend(ax, len(shown))
    axes[-1].set_xlabel(f"time [{unit}]")
    axes[-1].set_xlim(log.t[0] / scale, max(log.t[-1], log.t[0] + 1e-9) / scale)
    figure.suptitle(diagram.name, x=0.01, ha="left", fontsize=11, weight="bold")
    notes = []
    if run.status is not Status.OK:
        notes.append((_wrapped(f"{run.status.name}: {run.hint}"), FAILED))
    if left_out:
        notes.append((f"{left_out} more signals: choose with names=", SOFT))
    for text, colour in notes[:1]:
        axes[0].set_title(text, loc="left", fontsize=8.5, color=colour, pad=16.0)
    for text, colour in notes[1:]:
        axes[-1].annotate(text, (1.0, 0.0), (0.0, -24.0), xycoords="axes fraction", textcoords="offset points",
                          ha="right", va="top", fontsize=8.5, color=colour)  # fmt: skip
    return figure


def plot_ensemble(result: "Ensemble", signal: str) -> "Figure":
    """Return the spread of a signal over the members that reached their end: median, 5 to 95 %, some members.

    Raises ``ValueError`` if the signal was not kept or no member reached its end.
    """
    from matplotlib.figure import Figure

    if signal not in result.values:
        raise ValueError(f"the ensemble kept no signal '{signal}'; {nearest(signal, list(result.values))}")
    whole = np.flatnonzero(result.ok)
    if not whole.size:
        raise ValueError(f"no member reached its end, there is nothing to plot; the first: {result.hint(0)}")
    stride = -(-len(result.t) // POINTS)
    t, values = result.t[::stride], result.values[signal][whole, ::stride]
    low, middle, high = np.percentile(values, [5.0, 50.0, 95.0], axis=0)
    scale, unit = time_unit(float(result.t[-1] - result.t[0]))
    figure = Figure(figsize=(9.5, 3.6), layout="constrained")
    ax = figure.subplots()
    ax.fill_between(t / scale, low, high, color=CYCLE[0], alpha=0.18, linewidth=0, label="5 to 95 %")
    some = whole[np.linspace(0, whole.size - 1, min(SOME, whole.size)).astype(int)]
    for k, i in enumerate(some):
        label = f"{len(some)} of {len(result)} members" if k == 0 else None
        ax.plot(t / scale, result.values[signal][i, ::stride], color="#8896a5", linewidth=0.5, alpha=0.8, label=label)
    ax.plot(t / scale, middle, color=CYCLE[0], linewidth=1.6, label="median")
    _tidy(ax)
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, frameon=False, fontsize=8.5, borderpad=0.1)
    unit_y = result.members.diagram.signal_units.get(signal, "")
    ax.set_ylabel(f"{signal} [{unit_y}]" if unit_y not in ("", "1") else signal)
    ax.set_xlabel(f"time [{unit}]")
    ax.set_xlim(t[0] / scale, t[-1] / scale)
    failed = len(result) - whole.size
    told = f"{result.members.diagram.name}: {', '.join([*result.params, *result.start]) or 'seeds'} vary"
    figure.suptitle(told, x=0.01, ha="left", fontsize=11, weight="bold")
    if failed:
        ax.set_title(f"{failed} members not shown: they did not reach the end", loc="left", fontsize=8.5, color=FAILED)
    return figure


def _panels(diagram: Diagram, log: Log, names: Sequence[str] | None) -> tuple[list[list[str]], int]:
    """Return the signals of each panel, and how many signals were left out."""
    chosen = list(log.names) if names is None else ([names] if isinstance(names, str) else list(names))
    for signal in chosen:
        if signal not in log:
            raise ValueError(f"the run logged no signal '{signal}'; {nearest(signal, list(log.names))}")
    if not chosen:
        raise ValueError("there is no signal to plot; name one, or log one")
    panels = _together(diagram, log, chosen)
    if names is not None or len(panels) <= PANELS:
        return panels, 0
    main = main_signals(diagram)
    panels = ([p for p in panels if main.intersection(p)] or panels)[:PANELS]
    return panels, len(chosen) - sum(len(p) for p in panels)


def main_signals(diagram: Diagram) -> set[str]:
    """Return the signals an operator looks at: SP, PV and OP of controllers, and what valves give.

    >>> from blocks.sources import Step
    >>> from plant import wire
    >>> main_signals(wire([Step("SP", 0.5)], outputs=["SP"]))
    set()
    """
    found: set[str] = set()
    for block in diagram.blocks:
        ports = {port.name for port in (*block.ports_in, *block.ports_out)}
        if {"SP", "PV"} <= ports or {"OP", "MV"} <= ports:
            found |= {*block.input_labels, *block.output_labels}
    return found


def _together(diagram: Diagram, log: Log, chosen: Sequence[str]) -> list[list[str]]:
    """Return which signals share a panel: SP with PV, OP with MV, then what has one unit and a similar range."""
    panel = {signal: [signal] for signal in chosen}

    def join(signals: Iterable[str]) -> None:
        present = [s for s in signals if s in panel]
        for other in present[1:]:
            if panel[other] is not panel[present[0]]:
                merged = [*panel[present[0]], *panel[other]]
                panel.update(dict.fromkeys(merged, merged))

    for block in diagram.blocks:
        by_port = dict(zip([p.name for p in (*block.ports_in, *block.ports_out)],
                           (*block.input_labels, *block.output_labels), strict=True))  # fmt: skip
        for pair in (("SP", "PV"), ("OP", "MV")):
            if all(port in by_port for port in pair):
                join(by_port[port] for port in pair)
    for i, signal in enumerate(chosen):
        for other in chosen[:i]:
            one, two = panel[signal], panel[other]
            alone = len(one) == 1 and len(two) < TOGETHER and one is not two
            if (
                alone
                and log.units.get(signal)
                and log.units.get(signal) == log.units.get(other)
                and _alike(log, signal, other)
            ):
                join((other, signal))
    return list({id(shown): shown for shown in panel.values()}.values())


def _alike(log: Log, a: str, b: str) -> bool:
    sizes = [float(np.ptp(log[s][np.isfinite(log[s])])) if np.isfinite(log[s]).any() else 0.0 for s in (a, b)]
    both = np.concatenate([log[a], log[b]])
    whole = float(np.nanmax(both) - np.nanmin(both)) if np.isfinite(both).any() else 0.0
    return whole <= ALIKE * max(min(sizes), 1e-12)


def _parts(diagram: Diagram, shown: Sequence[str]) -> list[str]:
    """Return the part each signal plays in its panel: SP, PV, OP, MV for controllers and valves, else its name."""
    played: dict[str, list[str]] = {signal: [] for signal in shown}
    ends = [
        (port.name, label) for block in diagram.blocks for port, label in _wired(block.ports_out, block.output_labels)
    ]
    ends += [
        (port.name, label) for block in diagram.blocks for port, label in _wired(block.ports_in, block.input_labels)
    ]
    for name, label in ends:  # outputs first: a signal is what drives it
        if label in played and name in COLOURS:
            played[label].append(name)
    loop = any("PV" in parts for parts in played.values())
    found = []
    for signal, parts in played.items():
        own = signal.rpartition("/")[2]
        if own in COLOURS:
            found.append(own)
        elif loop and "SP" in parts:  # the output of one controller is the set point of the next
            found.append("SP")
        else:
            found.append(parts[0] if parts else signal)
    return found


def _wired(ports: Sequence[Port], labels: Sequence[str]) -> Iterable[tuple[Port, str]]:
    return zip(ports, labels, strict=True)


def _colours(parts: Sequence[str]) -> list[str]:
    """Return a colour for each signal: the house's for SP, PV, OP, MV where they tell the signals apart."""
    if len(set(parts)) == len(parts) and all(part in COLOURS for part in parts):
        return [COLOURS[part] for part in parts]
    return [CYCLE[i % len(CYCLE)] for i in range(len(parts))]


def _title(shown: Sequence[str], log: Log) -> str:
    """Return what stands at the axis: names (behind their common nested diagram) and the unit they share."""
    group = shown[0].rpartition("/")[0]
    within = group and all(s.rpartition("/")[0] == group for s in shown)
    names = [s.rpartition("/")[2] for s in shown] if within else list(shown)
    text = ", ".join(names) if sum(map(len, names)) < 16 else f"{names[0]}, ..."
    units = {log.units.get(s, "") for s in shown}
    unit = units.pop() if len(units) == 1 else ""
    return (f"{group}\n" if within else "") + text + (f" [{unit}]" if unit not in ("", "1") else "")


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
    if "stuck" in block.modes:
        stuck = [
            (a / scale, (b - a) / scale) for a, b, mode in modes_over_time(block, run) if mode == "stuck" and b > a
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
