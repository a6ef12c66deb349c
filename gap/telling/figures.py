"""The picture of a latent input: over what it may go with, its rows and their means by groups."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from logs.style import AXIS, ORANGE, WIRE, tidy
from logs.time_axis import time_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gap.telling.latent import LatentInput

Floats = NDArray[np.float64]
GROUPS = 30  # of a panel
DOTS = 3000  # of a panel
WITHIN = (0.01, 0.99)  # parts of the rates that are shown; the steps of a set point beyond stand at the end


def plot_latent(found: "LatentInput") -> "Figure":
    """Return one panel for each thing that the latent input may go with; rising and falling rows apart over a level."""
    from logs.picture import Picture

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


def _means(x: Floats, d: Floats) -> tuple[Floats, Floats]:
    """Return the means of groups of equally many rows in the order of x: of x and of d."""
    if len(x) == 0:
        return x, d
    order = np.argsort(x, kind="stable")
    parts = np.array_split(order, min(GROUPS, len(x)))
    return np.array([x[part].mean() for part in parts]), np.array([d[part].mean() for part in parts])
