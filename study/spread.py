"""The picture of the thesis's first question: how far an oscillation spreads from the valve to the shaft."""

from typing import TYPE_CHECKING, Any

import numpy as np

from logs.style import BLUE, INK, SHADE, SOFT, tidy
from study.findings import Findings
from study.frame import DECADES, head, plain_numbers
from study.groups import Group, bands, groups

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BANDS = 3  # lines that all have a band; of more, only the first and the last
LINES = 7  # more are told apart by a colour bar
PANELS = 4  # values of the second axis that get a column of their own
STANDS = 1e-6  # % of the operating point: below it nothing moves


def draw_spread(result: Findings) -> "Figure":
    """Return amplitude [% of the operating point] and period [s] along the chain.

    One line a value of the first varied axis: the median over kicks and all other axes, with the 5 to 95 % band for
    up to three lines, else for the first and the last.  One column
    a value of the second axis where there are at most four.
    """
    from logs.picture import Picture

    varied = result.varied()
    first = varied[0] if varied else None
    second = varied[1] if len(varied) > 1 and not varied[1].law and len(varied[1].values) <= PANELS else None
    columns = groups(result, second)
    lines = groups(result, first)
    wide = 1.8 + max(5.0, 0.62 * len(result.signals)) if len(columns) == 1 else 1.8 + len(columns) * _width(result)
    figure = Picture(figsize=(min(wide, 16.0), 6.6), layout="constrained")
    axes = figure.subplots(2, len(columns), sharex=True, sharey="row", squeeze=False, height_ratios=(1.7, 1.0))
    percent = [result.percent(signal) for signal in result.signals]
    period = [result.column(f"{signal}.period") for signal in result.signals]
    colours = shades(len(lines))
    for k, column in enumerate(columns):
        for i, (line, colour) in enumerate(zip(lines, colours, strict=True)):
            banded = len(lines) <= BANDS or i in (0, len(lines) - 1)
            both = Group(line.label, line.at, line.runs & column.runs)
            if both.runs.any():
                _line(axes[0, k], bands(both, percent), colour, line.label, banded)
                _line(axes[1, k], bands(both, period), colour, None, banded)
        if second is not None:
            axes[0, k].set_title(f"{second.name} = {column.label}", fontsize=9.5, loc="left", color=INK)
        _names(axes[1, k], result)
        _stages(axes[:, k], result)
    _scales(axes, percent, period)
    axes[0, 0].set_ylabel("amplitude\n[% of the operating point]", fontsize=9)
    axes[1, 0].set_ylabel("period [s]", fontsize=9)
    if first is not None:
        legend(figure, axes, first.name, lines, colours)
    others = [axis.name for axis in varied[1:] if axis is not second]
    over = _over(result, others)
    ends = " (first and last line)" if len(lines) > BANDS else ""
    head(figure, result, f"median and 5 to 95 %{ends} over {over}" if over else "one run a point")
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


def legend(figure: "Figure", axes: Any, name: str, lines: list[Group], colours: list[Any]) -> None:
    """Name the lines: a legend where they are few, else a colour bar of their values."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import BoundaryNorm, ListedColormap

    if len(lines) <= LINES or not np.isfinite([line.at for line in lines]).all():
        handles, labels = axes[0, 0].get_legend_handles_labels()
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


def _line(ax: "Axes", band: tuple[Any, Any, Any], colour: Any, label: str | None, banded: bool) -> None:
    middle, low, high = band
    x = np.arange(len(middle))
    if banded:
        ax.fill_between(x, np.maximum(low, 1e-12), high, color=colour, alpha=0.16, linewidth=0)
    ax.plot(x, middle, color=colour, linewidth=1.5, marker="o", markersize=3.5, label=label)


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
