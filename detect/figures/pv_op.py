"""Pictures of the methods that draw a form of PV against OP."""

import numpy as np
from stickslip.detect.figures.half_waves import OTHER, SINE, WAVE
from stickslip.detect.figures.verdict import finish
from stickslip.detect.verdict import FigureBase, Verdict


def draw_pv_op(v: Verdict, figure: FigureBase, form: str) -> None:
    """The mean cycles of the form of PV against OP, with their mean and the ellipse of the same covariance.

    Reads ``op`` and ``pv`` (g, m) of the evidence.
    """
    op, pv = v.array("op"), v.array("pv")
    ax = figure.subplots()
    ax.plot(np.c_[op, op[:, :1]].T, np.c_[pv, pv[:, :1]].T, color=WAVE, lw=0.6)
    x, y = op.mean(axis=0), pv.mean(axis=0)
    root = np.linalg.cholesky(np.cov(x, y, bias=True))
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    ellipse = root @ np.array([np.cos(turn), np.sin(turn)]) * np.sqrt(2.0)
    ax.plot(ellipse[0] + x.mean(), ellipse[1] + y.mean(), color=SINE, lw=1.4, ls="--", label="ellipse of two sines")
    ax.plot(np.append(x, x[0]), np.append(y, y[0]), color=OTHER, lw=1.6, label="mean cycle")
    finish(ax, "OP, drift off", form, "every curve is the mean of neighbouring cycles", named=True)
