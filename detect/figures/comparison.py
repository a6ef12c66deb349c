"""The picture of a comparison: methods against loops, and the time of each method."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from stickslip.detect.words import WORDS
from stickslip.logs.picture import Picture
from stickslip.logs.style import INK, tidy

if TYPE_CHECKING:
    from stickslip.detect.comparison import Comparison


def plot_comparison(comparison: "Comparison") -> Figure:
    """A cell a loop and method, the combined verdict in the last row, and bars of the median time [ms]."""
    names = [v.method.replace("_", " ") for v in comparison.loops[0].verdicts]
    rows, columns = len(names) + 1, len(comparison.loops)
    width = 4.0 + min(0.45 * columns, 24.0)
    figure = Picture(figsize=(width + 3.0, 1.6 + 0.27 * rows), layout="constrained")
    cells, bars = figure.subplots(1, 2, sharey=True, width_ratios=(max(width - 3.0, 1.5), 3.0))
    for k, judged in enumerate(comparison.loops):
        for i, word in enumerate([*(v.verdict for v in judged.verdicts), judged.combined]):
            said = WORDS[word]
            cells.add_patch(Rectangle((k - 0.46, i - 0.44), 0.92, 0.88, facecolor=said.colour, linewidth=0))
            cells.text(k, i, said.letter, ha="center", va="center", fontsize=8, color=said.ink)
    cells.set_xlim(-0.5, columns - 0.5)
    cells.set_ylim(rows - 0.5, -0.5)
    cells.set_xticks(range(columns), [judged.loop for judged in comparison.loops], rotation=90, fontsize=8)
    cells.set_yticks(range(rows), [*names, "combined"], fontsize=8)
    for edge in cells.spines.values():
        edge.set_visible(False)
    cells.tick_params(length=0)
    figure.suptitle(
        ", ".join(f"{said.letter} = {said.spoken}" for said in WORDS.values()), x=0.01, ha="left", fontsize=9
    )
    spent = np.median([judged.milliseconds for judged in comparison.loops], axis=0)
    bars.barh(range(len(names)), spent, color=INK, height=0.6)
    bars.set_xlabel("median time a record [ms]", fontsize=8.5)
    tidy(bars)
    bars.tick_params(left=False, labelleft=False)
    return figure
