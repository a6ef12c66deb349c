"""The picture of what decided a verdict: learnt pattern, likelihood of dead travel, logged stem, or slips of PV."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import FigureBase
from stickslip.detect.figures.loop_trend import named
from stickslip.detect.figures.verdict import draw_evidence, draw_reason, finish
from stickslip.logs.arrays import Values
from stickslip.logs.style import COLOURS, INK, PALE
from stickslip.logs.time_axis import TimeAxis

if TYPE_CHECKING:
    from stickslip.detect.diagnosis import Diagnosis
    from stickslip.detect.verdict import Verdict

BINS, FEWEST = 16, 6  # of the travel, and points in a bin whose mean is drawn
CYCLES = 8.0  # of the trend
SAMPLES = 600  # of the trend where nothing oscillates
WORDS = {
    "learnt": (
        "The pattern that the model knows",
        "Each dot is a movement of PV, positive the way of OP, over the travel of OP since its turn. Behind a valve "
        "that sticks PV goes on as before up to S and then changes at once; behind one that follows it does so evenly.",
    ),
    "slips": ("The slips of the valve", "The pace of PV jumps where OP has come back by S, and stands before."),
    "still_stem": ("The stem that stands", "The logged stem beside OP."),
}
"""Title and caption of each picture that is of no method."""


def what_decided(answer: "Diagnosis") -> tuple[str, str] | None:
    """Title and caption of the picture; None where there is none."""
    if answer.picture in WORDS:
        return WORDS[answer.picture]
    shown = _method(answer)
    return None if shown is None else (shown.method.replace("_", " ").capitalize(), shown.reason)


def draw_deciding(answer: "Diagnosis", figure: FigureBase) -> None:
    """Draw what decided the verdict on a figure or subfigure; where nothing did, the first method with evidence."""
    if answer.picture == "learnt":
        _draw_learnt(answer, figure)
    elif answer.picture in ("slips", "still_stem"):
        _draw_moves(answer, figure)
    elif (shown := _method(answer)) is not None:
        draw_evidence(shown, figure)
    else:
        draw_reason(answer.reason, figure)


def _method(answer: "Diagnosis") -> "Verdict | None":
    """The method that decided, asked once more where it is not among those of the answer, or any with evidence."""
    drawn = [v for v in answer.methods if v.draw is not None and len(v.evidence)]
    if not answer.picture:
        return next(iter(sorted(drawn, key=lambda v: v.experimental)), None)
    from stickslip.detect.methods import dead_travel, stem_play

    method = stem_play if answer.picture == "stem_play" else dead_travel
    return next((v for v in drawn if v.method == answer.picture), None) or method.detect(answer.record)


def _draw_learnt(answer: "Diagnosis", figure: FigureBase) -> None:
    from stickslip.detect.judge.features.channels import channels
    from stickslip.detect.judge.features.view import view_of
    from stickslip.detect.prepare.prepared import Prepared

    loop = Prepared(answer.record)
    view = view_of(loop)
    if view is None:
        draw_reason(answer.reason, figure)
        return
    _, (new, steps, travel) = channels(view)
    scale = loop.op_percent(1.0)
    unit = "unit of OP" if scale is None else "% of OP"
    x = 0.5 * travel.astype(np.float64) * view.travel * view.op_scale * (1.0 if scale is None else scale)
    left, right = figure.subplots(1, 2)
    S = (answer.amount or {}).get("S")
    for ax, y, title in ((left, steps, "movement of PV"), (right, new, "what is new in PV beside its past")):
        _along(ax, x, y.astype(np.float64))
        if S is not None:
            ax.axvline(S.value, color=INK, lw=0.9, ls="--", label=f"S = {S.value:.2g}")
        finish(ax, f"travel of OP since its turn [{unit}]", "standard deviations, the way of OP", title, named=True)


def _along(ax: Axes, x: Values, y: Values) -> None:
    """Points and their mean in equal parts of x."""
    ax.axhline(0.0, color=PALE, lw=0.8)
    ax.plot(x, y, ".", color=PALE, ms=3.0)
    which = np.minimum((BINS * x / (x.max() or 1.0)).astype(int), BINS - 1)
    parts = [which == k for k in range(BINS) if np.count_nonzero(which == k) >= FEWEST]
    ax.plot([x[p].mean() for p in parts], [y[p].mean() for p in parts], "o-", color=COLOURS["PV"], ms=4, label="mean")


def _draw_moves(answer: "Diagnosis", figure: FigureBase) -> None:
    """OP, and beside it the stem that stands or the pace of PV that jumps."""
    from stickslip.detect.judge.own_slips import rate_of

    record = answer.record
    last = slice(-SAMPLES if answer.period is None else -max(int(CYCLES * answer.period / record.dt), 60), None)
    upper, lower = figure.subplots(2, 1, sharex=True)
    t = record.t[last]
    axis = TimeAxis(record.log, float(t[-1] - t[0]))
    at = axis.at(t)
    upper.plot(at, record.op[last], color=COLOURS["OP"], label="OP")
    if answer.picture == "slips":
        lower.plot(at, rate_of(record.pv)[last], color=COLOURS["PV"], label="change of PV per sample")
    elif record.mv is not None:
        lower.plot(at, record.mv[last], color=COLOURS["MV"], label="MV")
        lower.set_ylim(upper.get_ylim())
    axis.finish(lower, float(t[0]), float(t[-1]))
    finish(upper, "", named(record, record.op_name, "OP"), named=True)
    finish(lower, named=True)
