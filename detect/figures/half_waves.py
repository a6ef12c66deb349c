"""Pictures of the methods that fit shapes to half waves: the waves with two shapes, and the error of each fit."""

import numpy as np
from stickslip.detect.figures.verdict import draw_reason, finish
from stickslip.detect.verdict import FigureBase, Verdict
from stickslip.logs.style import BLUE, FIT, ORANGE, PALE

SINE, OTHER, WAVE = BLUE, ORANGE, PALE  # a fitted sine, the rival shape, the waves themselves


def draw_fits(v: Verdict, figure: FigureBase, signal: str, other: str, score: str) -> None:
    """Half waves of ``signal`` with the sine and the shape called ``other``, and both errors of every half wave.

    Reads ``phase`` (m,), ``waves`` (h, m), ``sine`` and ``other`` (m,), ``error_sine`` and ``error_other`` (H,) of the
    evidence; ``score`` is the title of the right panel.
    """
    if "waves" not in v.evidence:
        draw_reason(v.reason, figure)
        return
    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    phase = v.array("phase")
    left.plot(phase, v.array("waves").T, color=WAVE, lw=0.6)
    left.plot(phase, v.array("sine"), color=SINE, lw=1.6, ls="--", label="sine")
    left.plot(phase, v.array("other"), color=OTHER, lw=1.6, label=other)
    each = f"{signal}, each half wave over its best sine [-]"
    finish(left, "phase between two crossings [-]", each, f"half waves of {signal}", named=True)
    a, b = v.array("error_sine"), v.array("error_other")
    unit = max(float(np.max([a.max(), b.max()])), 1e-300)
    right.plot(a / unit, b / unit, "o", ms=4, color=FIT, alpha=0.5, lw=0)
    right.plot([0, 1], [0, 1], color=FIT, lw=0.8, ls=":")
    finish(right, "error of the sine, largest = 1 [-]", f"error of the {other} [-]", score)
