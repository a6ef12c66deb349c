"""Amplitude over two parameters, one map a signal along the chain: where an oscillation passes, and where it dies."""

from typing import TYPE_CHECKING

import numpy as np
from stickslip.logs.style import ON_DARK, ON_LIGHT, RED, SHADE, SOFT, tidy
from stickslip.study.axes import Axis
from stickslip.study.findings import Findings
from stickslip.study.frame import head, plain_numbers
from stickslip.study.groups import Group, groups
from stickslip.study.growth import chosen, numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

MAPS = 4
SLICES = 60  # of a listed axis
TICKS = 12
WRITTEN = 60  # cells: that many have room for their number


def draw_maps(result: Findings) -> "Figure | None":
    """Return maps of the median amplitude [% of the operating point] over the first two axes of numbers.

    Listed axes give cells; if one of the two is random, every run is a dot.
    """
    from stickslip.logs.picture import Picture

    two = [axis for axis in result.varied() if numbers(axis, 2)][:2]
    if len(two) < 2:
        return None
    y, x = two
    signals = chosen(result.signals, MAPS)
    wide = 3 if len(signals) == 3 else 2
    tall = -(-len(signals) // wide)
    figure = Picture(figsize=(10.0, (3.9 if wide == 2 else 3.4) * tall), layout="constrained")
    axes = figure.subplots(tall, wide, sharex=True, sharey=True, squeeze=False).ravel()
    for ax, signal in zip(axes, signals, strict=False):
        drawn = _dots(result, ax, x, y, signal) if x.law or y.law else _cells(result, ax, x, y, signal)
        bar = figure.colorbar(drawn, ax=ax, aspect=30, pad=0.02)
        bar.ax.tick_params(labelsize=8.0)
        bar.outline.set_visible(False)
        ax.set_title(signal, fontsize=9.5)
        tidy(ax)
        ax.grid(False)
    for ax in axes[len(signals) :]:
        ax.set_visible(False)
    for k, ax in enumerate(axes[: len(signals)]):
        if k % wide == 0:
            ax.set_ylabel(y.name, fontsize=9)
        if k >= len(signals) - wide:
            ax.set_xlabel(x.name, fontsize=9)
            ax.tick_params(labelbottom=True)
    drawn_singly = "every run" if x.law or y.law else "median"
    head(figure, result, f"amplitude [% of the operating point], {drawn_singly} of the runs that oscillate")
    return figure


def _cells(result: Findings, ax: "Axes", x: Axis, y: Axis, signal: str) -> "ScalarMappable":
    """Draw a cell for every pair of values; equal cells, because the values need not be even."""
    values = result.percent(signal)
    rows, columns = groups(result, y, SLICES), groups(result, x, SLICES)
    swings = result.swings()
    grid = np.full((len(rows), len(columns)), np.nan)
    for i, row in enumerate(rows):
        for j, column in enumerate(columns):
            both = row.runs & column.runs
            found = values[both & swings]
            found = found[np.isfinite(found)]
            if len(found):
                grid[i, j] = np.median(found)
            elif both.any() and len(rows) * len(columns) <= WRITTEN:
                ax.text(j + 0.5, i + 0.5, "at rest", ha="center", va="center", fontsize=8, color=SOFT)
    _ticks(ax.set_xticks, columns)
    _ticks(ax.set_yticks, rows)
    ax.set_facecolor(SHADE)
    ax.set_xlim(0, len(columns))
    ax.set_ylim(0, len(rows))
    drawn = ax.pcolormesh(grid, cmap="viridis", edgecolors="white", linewidth=0.4)
    if grid.size <= WRITTEN and np.isfinite(grid).any():
        bottom = float(np.nanmin(grid))
        for i, j in zip(*np.nonzero(np.isfinite(grid)), strict=True):
            dark = grid[i, j] < bottom + 0.6 * (float(np.nanmax(grid)) - bottom)
            ax.text(j + 0.5, i + 0.5, f"{grid[i, j]:.3g}", ha="center", va="center", fontsize=8,
                    color=ON_DARK if dark else ON_LIGHT)  # fmt: skip
    return drawn


def _ticks(put: "Callable[..., object]", values: "Sequence[Group]") -> None:
    stride = -(-len(values) // TICKS)
    put([k + 0.5 for k in range(0, len(values), stride)], [values[k].label for k in range(0, len(values), stride)])


def _dots(result: Findings, ax: "Axes", x: Axis, y: Axis, signal: str) -> "ScalarMappable":
    """Draw a dot a run; a cross where there is no result."""
    percent, across, up = result.percent(signal), result.column(x.column), result.column(y.column)
    ok = np.isfinite(percent)
    ax.scatter(across[~ok], up[~ok], s=10, color=RED, marker="x", linewidth=0.7)
    drawn = ax.scatter(across[ok], up[ok], s=14, c=percent[ok], cmap="viridis", linewidth=0)
    if x.even_ratios:
        ax.set_xscale("log")
        plain_numbers(ax, "x")
    if y.even_ratios:
        ax.set_yscale("log")
        plain_numbers(ax)
    return drawn
