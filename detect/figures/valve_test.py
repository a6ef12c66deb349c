"""Pictures of a valve test: OP and the answer over time, the answer over OP, and the large steps on one another."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from stickslip.detect.figures.verdict import finish
from stickslip.logs.picture import Picture
from stickslip.logs.style import COLOURS, CYCLE, FIT, GREEN, PALE
from stickslip.logs.thinned import thinned
from stickslip.logs.time_axis import TimeAxis, time_unit
from stickslip.logs.trend import finish_panel

if TYPE_CHECKING:
    from stickslip.detect.valve_test.analysis import ValveTest

POINTS = 4000  # of the answer over OP
BEFORE, AFTER = 0.2, 4.0  # of T86: how much of a step response is drawn


def plot_valve_test(test: "ValveTest") -> Figure:
    """The trend, and the position of the valve over OP; steps without an answer are grey."""
    figure = Picture(figsize=(9.5, 4.2), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1.7, 1.0))
    upper = figure.add_subplot(grid[0, 0])
    _trend(test, upper, figure.add_subplot(grid[1, 0], sharex=upper))
    right = figure.add_subplot(grid[:, 1])
    record = test.record
    op, answer = record.op_percent, record.pv if record.mv is None else record.mv
    assert op is not None  # or there would be no test
    if test.steps:
        places = np.array(
            [[test.steps[0].before, test.steps[0].place_before]] + [[s.after, s.place_after] for s in test.steps]
        )
        right.plot(places[:, 0], places[:, 1], "-o", color=GREEN, ms=3, lw=0.7)
    else:
        right.plot(op[-POINTS:], answer[-POINTS:], color=GREEN, lw=0.6)
    finish(right, "OP [%]", f"{test.answer} at rest" if test.steps else test.answer)
    figure.suptitle(" ".join((f"{test.name}:", *test.words[:2])), x=0.01, ha="left", fontsize=10)
    return figure


def _trend(test: "ValveTest", upper: Axes, lower: Axes) -> None:
    """OP above, the answer below; grey lines at steps that were not answered, marks at those that were timed."""
    record = test.record
    op, answer = record.op_percent, record.pv if record.mv is None else record.mv
    assert op is not None
    axis = TimeAxis(record.log)
    at = axis.at(record.t)
    upper.plot(*thinned(at, op), color=COLOURS["OP"], lw=1.0)
    lower.plot(*thinned(at, answer), color=COLOURS[test.answer], lw=1.0)
    silent = axis.at(np.array([step.time for step in test.steps if not step.moved]))
    for x in silent.tolist():
        upper.axvline(x, color=PALE, lw=0.6)
    if len(silent):
        upper.set_title("grey: steps without an answer", fontsize=8.5, loc="right", color=PALE)
    timed = axis.at(np.array([response.time for response in test.responses]))
    lower.plot(timed, np.full(len(timed), 0.02), "^", color=FIT, ms=4, transform=lower.get_xaxis_transform())
    finish_panel(upper, [op])
    finish_panel(lower, [answer])
    upper.set_ylabel("OP [%]")
    lower.set_ylabel(test.answer)
    upper.tick_params(labelbottom=False)
    axis.finish(lower, float(record.t[0]), float(record.t[-1]))


def plot_responses(test: "ValveTest") -> Figure | None:
    """The answers to the timed steps on one another, each as a share of its final change; None without any."""
    if not test.responses:
        return None
    record = test.record
    answer = record.pv if record.mv is None else record.mv
    figure = Picture(figsize=(4.7, 3.5), layout="constrained")
    ax = figure.subplots()
    slow = max((response.T86 or 0.0 for response in test.responses), default=0.0) or 10.0 * record.dt
    scale, unit = time_unit(AFTER * slow)
    for k, response in enumerate(test.responses):
        since = record.t - response.time
        shown = (since >= -BEFORE * slow) & (since <= AFTER * slow)
        share = (answer[shown] - response.place_before) / (response.place_after - response.place_before)
        ax.plot(since[shown] / scale, share, color=CYCLE[k % len(CYCLE)], lw=0.9, alpha=0.8)
    for level, name in ((0.632, "63 %"), (0.865, "86 %"), (1.0, "")):
        ax.axhline(level, color=PALE, lw=0.8, ls=":" if name else "-")
        ax.annotate(name, (1.0, level), (-2, 1), xycoords=("axes fraction", "data"), textcoords="offset points",
                    ha="right", fontsize=7.5, color=FIT)  # fmt: skip
    ax.set_xlim(-BEFORE * slow / scale, AFTER * slow / scale)
    ax.set_ylim(-0.25, 1.5)
    finish(ax, f"time since the step [{unit}]", f"{test.answer}, share of its change [-]")
    return figure
