"""The picture of a diagnosis: trend, PV against OP, and what decided the verdict."""

import math
import textwrap
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure, SubFigure
from stickslip.detect.evidence.set_point import set_point_words
from stickslip.detect.figures.deciding import draw_deciding, what_decided
from stickslip.detect.figures.loop_trend import draw_trends, named
from stickslip.detect.words import WORDS
from stickslip.logs.picture import Picture
from stickslip.logs.style import COLOURS
from stickslip.logs.trend import finish_plane

if TYPE_CHECKING:
    from stickslip.detect.diagnosis import Diagnosis

POINTS = 4000  # of PV against OP: more is a blot


def plot_diagnosis(answer: "Diagnosis", words: bool = True) -> Figure:
    """Trend, PV-OP curve and what decided; ``words`` adds the reason."""
    shown = what_decided(answer)
    figure = Picture(figsize=(11, 8.2 if shown else 4.8), layout="constrained")
    rows = 2 if shown else 1
    parts: list[SubFigure] = list(np.ravel(figure.subfigures(rows, 1)))  # type: ignore[arg-type]
    trend = parts[0]
    if words:
        title = f"{answer.loop or 'loop'}: {WORDS[answer.verdict].spoken}"
        figure.suptitle(title, x=0.01, ha="left", fontsize=12, weight="bold")
    grid = trend.add_gridspec(2, 2, width_ratios=(2.2, 1))
    top = trend.add_subplot(grid[0, 0])
    below = trend.add_subplot(grid[1, 0], sharex=top)
    curve = trend.add_subplot(grid[:, 1])
    record = answer.record
    draw_trends(record, top, below)
    good = record.good
    pv, op = np.where(good, record.pv, np.nan), np.where(good, record.op, np.nan)
    if len(op) > POINTS:
        op, pv = op[-POINTS:], pv[-POINTS:]
    curve.plot(op, pv, color=COLOURS["PV"], lw=0.6, alpha=0.7)
    curve.set_xlabel(named(record, record.op_name, "OP"))
    curve.set_ylabel(named(record, record.pv_name, "PV"))
    last = f" (last {POINTS:,} samples)" if len(record) > POINTS else ""
    curve.set_title(f"PV against OP{last}", fontsize=9, loc="left")
    finish_plane(curve, [op], [pv])
    if words:
        trend.suptitle(_in_words(answer), fontsize=8.5, x=0.01, ha="left")
    if shown is not None:
        draw_deciding(answer, parts[1])
        parts[1].suptitle(shown[0], fontsize=9, x=0.01, ha="left", weight="bold")
    return figure


def _in_words(answer: "Diagnosis") -> str:
    """The reason, and below it what decided, each on its own line."""
    numbered = [f"{number}. {why}" for number, why in enumerate(answer.because, 1)]
    moved = set_point_words(answer.record, answer.period or math.nan)
    return "\n".join(row for line in (answer.reason, *numbered, moved) for row in textwrap.wrap(line, 150))
