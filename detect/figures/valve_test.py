"""The picture of a valve test: OP and the answer over time, and the answer over OP."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from logs.style import COLOURS, GREEN, PALE, tidy
from logs.time_axis import time_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from detect.valve_test.analysis import ValveTest

__all__ = ["plot_valve_test"]


def plot_valve_test(test: ValveTest) -> Figure:
    """Trend beside the place of the valve over OP; steps without an answer are grey."""
    from logs.picture import Picture

    record = test.record
    op = record.op_percent
    assert op is not None  # or there would be no test
    answer = record.pv if record.mv is None else record.mv
    figure = Picture(figsize=(9.5, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.6, 1.0))
    scale, unit = time_unit(float(record.t[-1] - record.t[0]))
    left.plot(record.t / scale, op, color=COLOURS["OP"], lw=1.0, label="OP [%]")
    beside = left if test.answer == "MV" else left.twinx()
    beside.plot(record.t / scale, answer, color=COLOURS[test.answer], lw=1.0, label=test.answer)
    for step in test.steps:
        if not step.moved:
            left.axvline(step.time / scale, color=PALE, lw=0.6)
    left.set_xlabel(f"time [{unit}]")
    left.set_ylabel("OP [%]" if test.answer == "PV" else "OP, MV [%]")
    left.legend(loc="upper left", frameon=False)
    if beside is not left:
        beside.set_ylabel("PV")
        beside.legend(loc="upper right", frameon=False)
    if test.steps:
        places = np.array(
            [[test.steps[0].before, test.steps[0].place_before]] + [[s.after, s.place_after] for s in test.steps]
        )
        right.plot(places[:, 0], places[:, 1], "-o", color=GREEN, ms=3, lw=0.7)
    else:
        right.plot(op, answer, color=GREEN, lw=0.6)
    right.set_xlabel("OP [%]")
    right.set_ylabel(f"{test.answer} at rest" if test.steps else test.answer)
    for ax in (left, right):
        tidy(ax)
    figure.suptitle(" ".join((f"{test.name}:", *test.words[:2])), x=0.01, ha="left", fontsize=10)
    return figure
