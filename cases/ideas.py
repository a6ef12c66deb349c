"""The thesis's two ideas for level loops (figures 7.1 to 7.3) and its ideal loops (figures 6.1, B.3, B.4) as pictures.

Idea 1 plots OP against PV shifted by N samples (eq. 7.1); idea 2 against PV through a high-pass (eq. 7.3).
"""

from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from stickslip.cases.curves import label, panels, run, thinned
from stickslip.cases.ideal import GAIN_READING, HIGH, NORMAL
from stickslip.logs.style import COMMAND, INK, STICTION

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from stickslip.logs import Log

Floats = NDArray[np.float64]

SHIFTS = (0, 50, 100, 200)  # samples of 0.1 s; the thesis does not say which it used
TAUS = (None, 100.0, 50.0, 10.0)  # s


def shifted(op: Floats, pv: Floats, N: int) -> tuple[Floats, Floats]:
    """Return OP(t) and PV(t + N), eq. 7.1, both shorter by ``N`` samples.

    >>> shifted(np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0]), 1)
    (array([1., 2.]), array([5., 6.]))
    """
    return op[: len(op) - N], pv[N:]


def high_passed(x: Floats, tau: float, T_s: float) -> Floats:
    """Return y(t) = a (y(t-1) + x(t) - x(t-1)), a = tau/(tau + T_s), from y = 0: eq. 7.3, a high-pass of corner 1/tau.

    >>> high_passed(np.array([0.0, 1.0, 1.0]), 1.0, 1.0).tolist()
    [0.0, 0.5, 0.25]
    """
    from scipy.signal import lfilter

    a = tau / (tau + T_s)
    return np.asarray(lfilter([a, -a], [1.0, -a], x - x[0]))


def width_at_middle(op: Floats, pv: Floats) -> float:
    """Return the distance of the OPs at mid PV between rising and falling crossings, in units of OP; NaN if none."""
    y = pv - 0.5 * (pv.max() + pv.min())
    rising, falling = (op[np.flatnonzero((s * y[:-1] < 0) & (s * y[1:] >= 0))] for s in (1, -1))
    if not len(rising) or not len(falling):
        return float("nan")
    return abs(float(np.median(rising)) - float(np.median(falling)))


@lru_cache(maxsize=1)
def integrating() -> "Log":
    """Return the loop of eq. 7.4 on its symmetric cycle, 2000 s."""
    from stickslip.cases import find

    return find("ideal_integrating").run().log


def _pictures(title: str, curves: list[tuple[str, Floats, Floats]], unit: str) -> "Figure":
    figure, axes = panels(2, 2, title, 3.1)
    for ax, (name, x, y), letter in zip(axes, curves, "abcd", strict=True):
        width = width_at_middle(x, y)
        ax.plot(*thinned(100.0 * x, y), color=STICTION["high"], linewidth=0.8)
        label(ax, f"({letter}) {name}: {100.0 * width:.1f} % of OP wide at mid PV", "OP [%]", f"PV{unit}")
    return figure


def figure_7_1() -> "Figure":
    """Return figure 7.1: OP against time-shifted PV, ideal integrating process."""
    log = integrating()
    late = log.t >= 500.0
    op, pv = log["OP"][late], log["PV"][late]
    curves = [(f"N = {N}" if N else "as measured", *shifted(op, pv, N)) for N in SHIFTS]
    return _pictures("Figure 7.1: PV-OP with time-shifted PV, ideal integrating process", curves, "")


def _filtered(title: str, t: Floats, op: Floats, pv: Floats, after: float, unit: str) -> "Figure":
    late = t >= after  # the filter's own start has died away
    curves = []
    for tau in TAUS:
        y = pv if tau is None else high_passed(pv, tau, float(t[1] - t[0]))
        curves.append(("not filtered" if tau is None else f"τ = {tau:g} s", op[late], y[late]))
    return _pictures(title, curves, unit)


def figure_7_2() -> "Figure":
    """Return figure 7.2: OP against high-passed PV, ideal integrating process."""
    log = integrating()
    title = "Figure 7.2: PV-OP with high-passed PV, ideal integrating process"
    return _filtered(title, log.t, log["OP"], log["PV"], 1000.0, "")


def figure_7_3() -> "Figure":
    """Return figure 7.3: OP against high-passed PV, level of the plant, constant feed, high stiction."""
    log = run("high", 1).log
    title = "Figure 7.3: PV-OP with high-passed PV, level of the production plant"
    return _filtered(title, log.t, log["OP_VLCS1"], log["V_1"] - log["SP_LCS11"], 1000.0, " [m³]")


def figure_B_4() -> "Figure":
    """Return figure B.4: OP and MV of the ideal integrating loop."""
    log = integrating()
    figure, (ax,) = panels(1, 1, "Figure B.4: OP and MV, ideal integrating process, high stiction", 2.6)
    ax.plot(log.t[::5], 100.0 * log["OP"][::5], color=COMMAND, linewidth=1.1, label="OP")
    ax.plot(log.t[::5], 100.0 * log["MV"][::5], color=STICTION["high"], linewidth=1.1, label="MV")
    label(ax, "", "time [s]", "% of travel")
    ax.legend(ncols=2, fontsize=8, frameon=False, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    return figure


def halves(t: Floats, e: Floats) -> list[tuple[int, int, int]]:
    """Return (first, peak, last) sample of each whole half cycle of the control error."""
    crossings = np.flatnonzero(np.signbit(e[1:]) != np.signbit(e[:-1])) + 1
    return [(int(a), int(a + np.argmax(np.abs(e[a:b]))), int(b)) for a, b in pairwise(crossings)]


def _loop_error(F_s: float, K_p: float, gain: float) -> tuple[Floats, Floats]:
    """Return time [s] and control error of eq. 6.2's loop on its symmetric cycle, 600 s."""
    from stickslip.cases.exact.parameters import ExactLoop
    from stickslip.cases.ideal import on_symmetric_cycle
    from stickslip.diagram import simulate
    from stickslip.plant.loops import self_regulating_loop

    exact = ExactLoop(F_s=F_s, K_p=K_p, K=3.0 * gain, SP=0.5)
    loop = on_symmetric_cycle(self_regulating_loop(F_s=F_s, K_p=K_p, K=3.0 * gain), exact)
    log = simulate(loop, 600.0, every=0.1, rtol=1e-8, atol=1e-11).log
    return log.t, log["SP"] - log["PV"]


def _sine() -> tuple[Floats, Floats]:
    from stickslip.cases import find

    log = find("sine").run().log
    return log.t, log["e"]


def _areas(cells: list[tuple[tuple[Floats, Floats], str]], title: str) -> "Figure":
    from stickslip.cases.ideal import index
    from stickslip.logs.style import AFTER, BEFORE

    figure, axes = panels(len(cells), 1, title, 1.9)
    for ax, ((t, e), words), letter in zip(axes, cells, "abcd", strict=False):
        ax.plot(*thinned(t, e), color=INK, linewidth=0.9)
        for first, peak, last in halves(t, e):
            for a, b, colour in ((first, peak + 1, BEFORE), (peak, last, AFTER)):
                kept = np.unique(np.append(np.arange(a, b, 5), b - 1))
                ax.fill_between(t[kept], e[kept], color=colour, alpha=0.85, linewidth=0)
        mean, std, count = index(t, e)
        label(ax, f"({letter}) {words}: R = {mean:.2f} ± {std:.2f} ({count} values)", "", "SP - PV")
    axes[-1].set_xlabel("time [s]", fontsize=9)
    return figure


def figure_6_1() -> "Figure":
    """Return figure 6.1: areas before (dark) and after (light) each peak; sine, and high stiction in both readings."""
    cells = [
        (_sine(), "sine, printed 1.03"),
        (_loop_error(HIGH, 0.4, 1.0), "high stiction, printed 3.71; the model as printed"),
        (_loop_error(HIGH, 0.4, GAIN_READING), f"the same, loop gain x {GAIN_READING}"),
    ]
    return _areas(cells, "Figure 6.1: Algorithm 1 on ideal data")


def figure_B_3() -> "Figure":
    """Return figure B.3: areas for half controller gain and for normal stiction, in both readings."""
    cells = [
        (_loop_error(HIGH, 0.2, 1.0), "half gain, high stiction, printed 18.40; the model as printed"),
        (_loop_error(NORMAL, 0.2, GAIN_READING), f"half gain, normal stiction, loop gain x {GAIN_READING}"),
        (_loop_error(NORMAL, 0.4, 1.0), "normal stiction, printed 6.40; the model as printed"),
        (_loop_error(NORMAL, 0.4, GAIN_READING), f"the same, loop gain x {GAIN_READING}"),
    ]
    return _areas(cells, "Figure B.3: Algorithm 1 on ideal data, less gain and less stiction")
