"""The picture of the thesis's first question: how far an oscillation spreads from the valve to the shaft."""

from typing import TYPE_CHECKING, Any

import numpy as np
from stickslip.logs.style import BLUE, INK, SHADE, SOFT, tidy
from stickslip.study.findings import Findings
from stickslip.study.frame import DECADES, head, plain_numbers
from stickslip.study.groups import Group, bands, groups

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase

ASIDE = 0.36  # of the distance of two signals: so far the bars of the lines stand apart
LINES = 7  # more share a colour bar
PANELS = 4  # values of the second axis that get a column of their own
STANDS = 1e-6  # % of the operating point: below it nothing moves


def draw_spread(result: Findings) -> "Figure":
    """Return amplitude [% of the operating point] and period [s] along the chain, and how many runs oscillate.

    One line a value of the first varied axis: the median over the runs that oscillate, kicks and all other axes
    together, with a bar from 5 to 95 %.  Runs that come to rest have no place on a logarithmic axis: the lowest panel
    counts them.  One column a value of the second axis where there are at most four; values at which nothing
    oscillates have none.
    """
    from stickslip.logs.picture import Picture

    varied = result.varied()
    first = varied[0] if varied else None
    second = varied[1] if len(varied) > 1 and not varied[1].law and len(varied[1].values) <= PANELS else None
    swings = result.swings()
    columns = groups(result, second)
    alive = [column for column in columns if (column.runs & swings).any()] or columns[:1]
    lines = groups(result, first)
    wide = 1.8 + max(5.0, 0.62 * len(result.signals)) if len(alive) == 1 else 1.8 + len(alive) * _width(result)
    figure = Picture(figsize=(min(max(wide, 6.5), 16.0), 7.4), layout="constrained")
    upper, lower = np.ravel(figure.subfigures(2, 1, height_ratios=(5.6, 1.5)))  # type: ignore[arg-type]
    axes = upper.subplots(2, len(alive), sharex=True, sharey="row", squeeze=False, height_ratios=(1.7, 1.0))
    counts = lower.subplots(1, len(alive), sharey=True, squeeze=False)[0]
    percent = [result.percent(signal) for signal in result.signals]
    period = [result.column(f"{signal}.period") for signal in result.signals]
    colours = shades(len(lines))
    for k, column in enumerate(alive):
        for i, (line, colour) in enumerate(zip(lines, colours, strict=True)):
            both = line.runs & column.runs
            moving = Group(line.label, line.at, both & swings)
            aside = ASIDE * (i - 0.5 * (len(lines) - 1)) / max(len(lines) - 1, 1)
            if moving.runs.any():
                _line(axes[0, k], bands(moving, percent), colour, line.label, aside)
                _line(axes[1, k], bands(moving, period), colour, None, aside)
            if both.any():
                share = 100.0 * float(np.mean(swings[both]))
                counts[k].bar([i], [share], color=colour, width=0.62)
                counts[k].text(i, share + 3.0, f"{share:.0f} %", ha="center", va="bottom", fontsize=7.5, color=SOFT)
        if second is not None:
            axes[0, k].set_title(f"{second.name} = {column.label}", fontsize=9.5, loc="left", color=INK)
        _names(axes[1, k], result)
        _stages(axes[:, k], result)
        tidy(counts[k])
        counts[k].set_xticks(range(len(lines)), [line.label for line in lines], fontsize=7.5,
                             rotation=45 if len(lines) > LINES else 0)  # fmt: skip
        counts[k].set_ylim(0.0, 125.0)
        counts[k].set_yticks([0.0, 50.0, 100.0])
        counts[k].set_xlim(-0.6, len(lines) - 0.4)
        counts[k].set_xlabel(first.name if first is not None else "", fontsize=8.5)
    _scales(axes, [values[swings] for values in percent], [values[swings] for values in period])
    axes[0, 0].set_ylabel("amplitude\n[% of the operating point]", fontsize=9)
    axes[1, 0].set_ylabel("period [s]", fontsize=9)
    counts[0].set_ylabel("runs that\noscillate [%]", fontsize=9)
    if first is not None and len(lines) > 1:
        legend(upper, axes, first.name, lines, colours)
    others = [axis.name for axis in varied[1:] if axis is not second]
    over = _over(result, others)
    subtitle = f"median and 5 to 95 % of the runs that oscillate, over {over}" if over else "one run a point"
    dead = [column.label for column in columns if column not in alive]
    if dead and second is not None:
        subtitle += f"; nothing oscillates at {second.name} = {', '.join(dead)}"
    head(figure, result, subtitle)
    return figure


def _width(result: Findings) -> float:
    """Return how wide one of several columns must be [inch]."""
    return max(2.4, 0.45 * len(result.signals))


def shades(count: int) -> list[Any]:
    """Return colours from light to dark that stay apart in print and for colour-blind eyes."""
    from matplotlib import colormaps

    if count == 1:
        return [BLUE]
    return [colormaps["viridis_r"](0.12 + 0.88 * i / (count - 1)) for i in range(count)]


def legend(figure: "FigureBase", axes: Any, name: str, lines: list[Group], colours: list[Any]) -> None:
    """Name the lines: a legend where they are few, else a colour bar of their values."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import BoundaryNorm, ListedColormap

    if len(lines) <= LINES or not np.isfinite([line.at for line in lines]).all():
        named = dict(zip(*reversed(_handles(axes)), strict=True))
        labels, handles = list(named), list(named.values())
        figure.legend(  # the largest on top, as it mostly lies
            handles[::-1],
            labels[::-1],
            title=name,
            loc="outside right center",
            frameon=False,
            fontsize=8.5,
            title_fontsize=9,
        )
        return
    norm = BoundaryNorm(np.arange(len(lines) + 1) - 0.5, len(lines))
    bar = figure.colorbar(ScalarMappable(norm, ListedColormap(colours)), ax=axes, aspect=40, pad=0.01)
    bar.set_ticks(list(range(len(lines))), labels=[line.label for line in lines])
    bar.set_label(name, fontsize=9)
    bar.ax.tick_params(labelsize=8.5, length=0)
    bar.outline.set_visible(False)


def _handles(axes: Any) -> tuple[list[Any], list[str]]:
    """Lines and labels of all columns."""
    handles: list[Any] = []
    labels: list[str] = []
    for ax in axes[0]:
        more, names = ax.get_legend_handles_labels()
        handles, labels = handles + more, labels + names
    return handles, labels


def _line(ax: "Axes", band: tuple[Any, Any, Any], colour: Any, label: str | None, aside: float) -> None:
    """The median of every signal, joined, and a bar from 5 to 95 %, ``aside`` of the signal's place."""
    middle, low, high = band
    x = np.arange(len(middle)) + aside
    ax.vlines(x, np.maximum(low, 1e-12), high, color=colour, alpha=0.55, linewidth=2.2, zorder=1.6)
    ax.plot(x, middle, color=colour, linewidth=1.3, marker="o", markersize=3.5, label=label)


def _names(ax: "Axes", result: Findings) -> None:
    names = [s + ("\n(% of 1)" if result.about_zero(s) else "") for s in result.signals]
    ax.set_xticks(np.arange(len(names)), names, rotation=45, ha="right", rotation_mode="anchor")


def _stages(column: Any, result: Findings) -> None:
    """Shade every other stage of the chain, and name them at the top of the upper panel."""
    stages = [[result.signals.index(s) for s in own if s in result.signals] for own in result.stages.values()]
    named = [(name, at) for name, at in zip(result.stages, stages, strict=True) if at]
    if len(named) < 2:
        return
    for k, (name, at) in enumerate(named):
        for ax in column:
            if k % 2 == 0:
                ax.axvspan(min(at) - 0.5, max(at) + 0.5, color=SHADE, linewidth=0, zorder=0)
        column[0].text(
            0.5 * (min(at) + max(at)), 0.985, name.replace(" ", "\n"), transform=column[0].get_xaxis_transform(),
            ha="center", va="top", fontsize=7.5, color=SOFT, linespacing=1.0,
        )  # fmt: skip
        column[0].set_xlim(-0.5, len(result.signals) - 0.5)


def _scales(axes: Any, percent: list[Any], period: list[Any]) -> None:
    for ax in axes.ravel():
        tidy(ax)
    for row, columns in ((0, percent), (1, period)):
        known = np.concatenate([c[np.isfinite(c) & (c > STANDS * (row == 0))] for c in columns])
        if not len(known):
            note = "nothing oscillates" if row == 0 else "no cycle was counted twice"
            for ax in axes[row]:
                ax.text(0.5, 0.5, note, transform=ax.transAxes, ha="center", color=SOFT, fontsize=9)
                ax.set_yticks([])
            continue
        top, bottom = float(known.max()), float(known.min())
        for ax in axes[row]:
            ax.set_yscale("log")
            ax.set_ylim(max(bottom, top * 10.0**-DECADES) / 1.5, top * (3.0 if row == 0 else 1.5))
            plain_numbers(ax)


def _over(result: Findings, others: list[str]) -> str:
    kicks = len(result.table["kick"].unique())
    return ", ".join([f"{kicks} kicks"] * (kicks > 1) + others)
