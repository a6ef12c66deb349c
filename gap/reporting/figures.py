"""The pictures of a log and a model: both over time with the gap as a bar, and the missing input."""

from typing import TYPE_CHECKING

import numpy as np
from stickslip.logs.arrays import Values
from stickslip.logs.style import AXIS, GREEN, INK, ORANGE, RED, SOFT, WIRE, tidy
from stickslip.logs.thinned import thinned
from stickslip.logs.time_axis import time_unit
from stickslip.logs.trend import finish_panel

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from stickslip.gap.reporting.latent import LatentInput
    from stickslip.gap.reporting.replayed import Replayed

GROUPS = 30  # of a panel
DOTS = 3000  # of a panel
WITHIN = (0.01, 0.99)  # parts of the rates that are shown; the steps of a set point beyond stand at the end


def plot_replayed(found: "Replayed") -> "Figure":
    """Return the log against the model, as it is above and with the cause below, under one bar of the gap's shrinkage.

    Where no cause can be put in there is one panel; without a number for the shrinkage there is no bar.
    """
    from stickslip.logs.picture import Picture

    made = [("the model as it is", found.as_it_is, RED)]
    if found.with_cause is not None:
        made.append((f"with {found.cause}", found.with_cause, GREEN))
    bar = found.shrinkage is not None and found.with_cause is not None
    figure = Picture(figsize=(9.6, 0.7 + 2.2 * len(made) + 0.75 * bar), layout="constrained")
    heights = [0.3] * bar + [1.0] * len(made)
    axes = figure.subplots(len(heights), 1, squeeze=False, height_ratios=heights)[:, 0]
    if bar:
        _bar(axes[0], found)
    panels = axes[1:] if bar else axes
    scale, unit = time_unit(float(found.t[-1] - found.t[0]))
    t = found.t / scale
    for panel, (said, values, colour) in zip(panels, made, strict=True):
        panel.fill_between(t, found.logged, values, color=colour, alpha=0.18, linewidth=0.0)
        panel.plot(*thinned(t, found.logged), color=INK, linewidth=1.6, label=f"{found.signal} as logged")
        panel.plot(*thinned(t, values), color=colour, linewidth=1.1, label=said)
        finish_panel(panel, [found.logged, *(values for _, values, _ in made)])
        panel.set_ylabel(f"{found.signal} [{found.unit}]" if found.unit not in ("", "1") else found.signal)
        panel.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False, fontsize=9, borderpad=0.1)
        panel.set_xlim(float(t[0]), float(t[-1]))
    lowest, highest = (f([panel.get_ylim() for panel in panels]) for f in (np.min, np.max))
    for panel in panels:
        panel.set_ylim(lowest, highest)  # one scale: what is left is seen for what it is
        panel.tick_params(labelbottom=panel is panels[-1])
    panels[-1].set_xlabel(f"time [{unit}]")
    return figure


def _bar(ax: "Axes", found: "Replayed") -> None:
    """Draw the gap as one bar: all of it, and what the cause leaves, on rows that the fit has not seen."""
    assert found.shrinkage is not None
    gone = float(np.clip(found.shrinkage.fraction, 0.0, 1.0))
    ax.barh([0.0], [gone], color=GREEN, height=1.0)
    ax.barh([0.0], [1.0 - gone], left=[gone], color=RED, height=1.0)
    low, high = _percent(found.shrinkage.low), _percent(found.shrinkage.high)
    sure = f" ({low.removesuffix(' %')} to {high})" if low != high else ""
    ax.text(0.0, 0.75, f"The gap shrinks by {_percent(gone)}{sure}", fontsize=13, weight="bold", color=INK, va="bottom")
    ax.text(1.0, 0.75, "green: what is explained; red: what is left", fontsize=8.5, color=SOFT, va="bottom", ha="right")
    ax.set_xlim(0.0, 1.0)
    ax.set_ylim(-0.5, 1.9)
    ax.set_axis_off()


def _percent(share: float) -> str:
    """Return a share in percent: what is not all is never said to be all."""
    return f"{100.0 * share:.0f} %" if share <= 0.995 or share >= 0.9999 else f"{100.0 * share:.1f} %"


def plot_latent(found: "LatentInput") -> "Figure":
    """Return one panel for each thing that the latent input may go with; rising and falling rows apart over a level."""
    from stickslip.logs.picture import Picture

    figure = Picture(figsize=(9.0, 5.6), layout="constrained")
    panels = figure.subplots(2, 2, sharey=True)
    moves = found.against[f"the direction of {found.signal}"]
    names = [name for name in found.against if not name.startswith("the direction")]
    few = slice(None, None, max(len(found.t) // DOTS, 1))
    for panel, name in zip(panels.ravel(), names, strict=True):
        values = found.against[name]
        label = name.removeprefix("the ")
        if name == "time":
            scale, unit = time_unit(float(values[-1] - values[0]))
            values, label = values / scale, f"time [{unit}]"
        if name.startswith("the rate"):
            values = np.clip(values, *np.quantile(values, WITHIN))
        panel.plot(values[few], found.values[few], ".", color=AXIS, markersize=1.5, alpha=0.4)
        apart = name == f"the level of {found.signal}"
        for way, colour in ((1.0, ORANGE), (-1.0, WIRE)) if apart else ((None, WIRE),):
            mine = np.ones(len(values), dtype=bool) if way is None else moves == way
            said = {1.0: f"{found.signal} rising", -1.0: f"{found.signal} falling"}.get(way) if way else None
            panel.plot(*_means(values[mine], found.values[mine]), color=colour, linewidth=1.6, label=said)
        if apart:
            panel.legend(fontsize=8, frameon=False)
        panel.set_xlabel(label, fontsize=9)
        panel.locator_params(axis="x", nbins=7)
        panel.set_title(f"{100.0 * found.shares[name]:.0f} % goes with {name}", fontsize=9)
        tidy(panel)
    for panel in panels[:, 0]:
        panel.set_ylabel(f"to be added to {found.signal}", fontsize=9)
    return figure


def _means(x: Values, d: Values) -> tuple[Values, Values]:
    """Return the means of groups of equally many rows in the order of x: of x and of d."""
    if len(x) == 0:
        return x, d
    order = np.argsort(x, kind="stable")
    parts = np.array_split(order, min(GROUPS, len(x)))
    return np.array([x[part].mean() for part in parts]), np.array([d[part].mean() for part in parts])
