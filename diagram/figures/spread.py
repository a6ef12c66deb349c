"""The figure of an ensemble: the spread of a signal over its variants."""

from typing import TYPE_CHECKING

import numpy as np
from stickslip.blocks.ports import nearest
from stickslip.diagram.figures.finding import swing
from stickslip.diagram.figures.starting import to_cycle
from stickslip.logs.style import CYCLE, PALE, RED
from stickslip.logs.time_axis import time_unit
from stickslip.logs.trend import finish_panel

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from stickslip.diagram.ensembles.result import Ensemble

POINTS = 1500  # as fine as the widest figure can show a band
SOME = 12  # variants drawn as lines


def plot_ensemble(result: "Ensemble", signal: str) -> "Figure":
    """Return the spread of a signal over the variants that reached their end: 5 to 95 %, some variants, one of them.

    The one has the median swing of all, and among equal swings the median mean.  The median at each time would be a
    line that no variant follows, and flat where variants cycle out of step.

    Raises ``ValueError`` if the signal was not kept or no variant reached its end.
    """
    from stickslip.logs.picture import Picture

    if signal not in result.values:
        raise ValueError(f"the ensemble kept no signal '{signal}'; {nearest(signal, list(result.values))}")
    whole = np.flatnonzero(result.ok)
    if not whole.size:
        raise ValueError(f"no variant reached its end, there is nothing to plot; the first: {result.hint(0)}")
    stride = -(-result.t.shape[-1] // POINTS)
    t, values = result.t[..., ::stride], result.values[signal][whole, ::stride]
    t = t if t.ndim == 1 else t[0] - t[0, 0]  # windows side by side: time since each began
    low, high = np.percentile(values, [5.0, 95.0], axis=0)
    later = values[:, values.shape[1] // 2 :]  # once started up
    typical = int(np.lexsort((later.mean(axis=1), np.ptp(later, axis=1)))[len(later) // 2])
    scale, unit = time_unit(float(t[-1] - t[0]))
    figure = Picture(figsize=(9.5, 3.6), layout="constrained")
    ax = figure.subplots()
    ax.fill_between(t / scale, low, high, color=CYCLE[0], alpha=0.18, linewidth=0, label="5 to 95 %")
    shown = whole[np.linspace(0, whole.size - 1, min(SOME, whole.size)).astype(int)]
    for k, i in enumerate(shown):
        label = f"{len(shown)} of {len(result)} variants" if k == 0 else None
        ax.plot(t / scale, result.values[signal][i, ::stride], color=PALE, linewidth=0.5, alpha=0.8, label=label)
    label = f"variant {whole[typical]}, of median swing"
    ax.plot(t / scale, values[typical], color=CYCLE[0], linewidth=1.2, label=label)
    finish_panel(ax, [low, high])
    one = result.log(int(whole[typical]))
    if (found := swing(one, signal)) and not found[1]:
        to_cycle(ax, t, np.stack([low, high, *result.values[signal][shown, ::stride], values[typical]]))
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, frameon=False, fontsize=8.5, borderpad=0.1)
    unit_y = result.variants.diagram.signal_units.get(signal, "")
    ax.set_ylabel(f"{signal} [{unit_y}]" if unit_y not in ("", "1") else signal)
    ax.set_xlabel(f"time [{unit}]")
    ax.set_xlim(t[0] / scale, t[-1] / scale)
    failed = len(result) - whole.size
    text = f"{result.variants.diagram.name}: {', '.join([*result.params, *result.start]) or 'seeds'} vary"
    figure.suptitle(text, x=0.01, ha="left", fontsize=11, weight="bold")
    if failed:
        ax.set_title(f"{failed} variants not shown: they did not reach the end", loc="left", fontsize=8.5, color=RED)
    return figure
