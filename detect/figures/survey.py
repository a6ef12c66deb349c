"""The picture of a survey: the tags of each group over time, their share of the oscillation, and the first suspect."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from stickslip.detect.figures.verdict import finish
from stickslip.logs.picture import Picture
from stickslip.logs.style import INK, RED, SOFT

if TYPE_CHECKING:
    from stickslip.detect.plantwide.survey import Group, Survey

MOST = 12  # tags of a group that are drawn
CYCLES = 8.0  # of a group that are drawn
POINTS = 2000


def plot_survey(survey: "Survey") -> Figure:
    """A row a group: its strongest tags, and OP of its first suspect against the tag that shows the band."""
    rows = max(len(survey.groups), 1)
    heights = [0.9 + 0.26 * min(len(g.shares), MOST) for g in survey.groups] or [1.0]
    figure = Picture(figsize=(9.5, 0.6 + sum(max(h, 2.6) for h in heights)), layout="constrained")
    panels = figure.subplots(rows, 2, squeeze=False, width_ratios=(3, 2), height_ratios=[max(h, 2.6) for h in heights])
    if not survey.groups:
        for ax in panels[0]:
            ax.axis("off")
        panels[0][0].text(0.0, 0.5, "No two tags share an oscillation.")
    for group, (left, right) in zip(survey.groups, panels, strict=False):
        _tags(left, survey, group)
        _suspect(right, survey, group)
    return figure


def _tags(ax: Axes, survey: "Survey", group: "Group") -> None:
    """The last cycles of the tags, the strongest on top, each brought to the same height."""
    log = survey.log
    inside = log.t >= log.t[-1] - CYCLES * group.period
    first = group.suspects[0].loop if group.suspects else None
    own = set(log.loops[first].parts.values()) if first else set()
    names = list(group.shares)
    shown = [n for n in names if n in own] + [n for n in names if n not in own]
    for row, name in enumerate(shown[:MOST]):
        x = log[name][inside]
        height = float(np.nanmax(x) - np.nanmin(x)) or 1.0
        y = 0.8 * (x - np.nanmin(x)) / height - row
        step = max(1, len(y) // POINTS)
        ax.plot(log.t[inside][::step], y[::step], color=RED if name in own else INK, lw=0.8)
    ax.set_yticks(
        [0.4 - row for row in range(min(len(shown), MOST))], [f"{n}  {group.shares[n]:.0%}" for n in shown[:MOST]]
    )
    more = f", {len(shown) - MOST} more" if len(shown) > MOST else ""
    red = f"; red: {first}" if first else ""
    finish(ax, "time [s]", "", f"{len(shown)} tags share {group.period:.3g} s (share of variance{more}{red})")
    ax.tick_params(axis="y", labelsize=7.5, length=0)


def _suspect(ax: Axes, survey: "Survey", group: "Group") -> None:
    """OP of the first suspect against the tag that shows its band, or the ranking in words where none does."""
    suspect = group.suspects[0] if group.suspects else None
    if suspect is None or suspect.seen_in is None:
        ax.axis("off")
        return
    log = survey.log
    op, x = log[log.loops[suspect.loop].op], log[suspect.seen_in]
    settled = log.t >= log.t[0] + 0.3 * log.duration
    step = max(1, int(settled.sum()) // POINTS)
    ax.plot(op[settled][::step], x[settled][::step], color=SOFT, lw=0.6, marker=".", ms=2)
    finish(ax, f"OP of {suspect.loop}", suspect.seen_in, f"answers after {suspect.S:.2g} % of OP")
