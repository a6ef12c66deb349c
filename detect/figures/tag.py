"""The picture of one valve over its records: S of each, what each adds, and the gain of every S over all."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from stickslip.detect.likelihood.pooled import GAIN_NATS
from stickslip.logs.picture import Picture
from stickslip.logs.style import INK, PALE, SHADE

if TYPE_CHECKING:
    from stickslip.detect.tag import Tag


def plot_tag(tag: "Tag") -> Figure:
    """Return the picture; without evidence it holds the reason only."""
    from stickslip.detect.figures.verdict import draw_reason, finish

    figure = Picture(figsize=(9.6, 3.4), layout="constrained")
    e = tag.evidence
    if e is None:
        draw_reason(tag.answer.reason, figure)
        return figure
    left, middle, right = figure.subplots(1, 3, width_ratios=[1.4, 1.4, 1.2])
    unit = "unit of OP" if tag.answer.S is None else tag.answer.S.unit.removeprefix("in the ")
    number = np.arange(1, len(e.days) + 1)
    speaks = [INK if day.gain > 0.0 else PALE for day in e.days]
    if e.accuses:  # else the best S is none
        left.axhspan(e.low, e.high, color=SHADE, lw=0)
        right.axvspan(e.low, e.high, color=SHADE, lw=0)
    left.scatter(number, [day.S for day in e.days], color=speaks, s=22)
    left.set_ylim(0.0, None)
    adds = [day.adds for day in e.days]
    middle.bar(number, adds, color=[INK if value > 0.0 else PALE for value in adds])
    middle.axhline(0.0, color=PALE, lw=0.8)
    for axes in (left, middle):
        axes.set_xlabel("record")
        axes.set_xticks(number if len(number) <= 12 else number[:: len(number) // 6])
    right.axhline(0.0, color=PALE, lw=0.8)
    right.axhline(GAIN_NATS, color=PALE, lw=0.8, ls=":")
    right.plot(e.sizes, e.curve, ".-", color=INK)
    right.set_xscale("log")
    finish(left, "", "", f"S of each record [{unit}]")
    finish(middle, "", "", "what each adds to the gain [nats]")
    finish(right, f"S [{unit}]", "", "gain of all together [nats]")
    return figure
