"""Cross-correlation of OP and PV, Horch 1999: an odd function points to the valve, an even one to other causes.

    r(k) = sum of OP(t) PV(t + k) / (n std_OP std_PV)
    d_tau = |tau_l - tau_r| / (tau_l + tau_r),    d_rho = |r(0) - r_opt| / |r(0) + r_opt|

tau_r is the first zero crossing of r at positive lag, -tau_l the first at negative lag, r_opt the value of largest
magnitude between them. In a self-regulating loop under PI control a sticky valve makes OP and PV a quarter of a
period apart, r odd and d_tau near 1; an outside sine or tight tuning makes them a half or no period apart, r even
and d_tau near 0. For two sines apart by an angle phi up to 90 degrees, d_tau = phi / 90 and d_rho = tan^2(phi / 2):
d_rho repeats d_tau, and where the two disagree the waves are no sines, or several, or drifting.

Source: Horch 1999, Control Eng. Practice 7:1221, with the limits 1/3 and 2/3 for d_tau. The limits of d_rho that go
with them, tan^2(15 deg) = 0.072 and tan^2(30 deg) = 1/3, follow from the identity above.

Not for integrating processes, where stiction makes r even too; a controller with strong proportional or derivative
action, or a long dead time, turns the phase, and so does an outside wave that is no sine: hence d_tau below 1/3
says that the phase is not that of a sticky valve, and clears nothing by itself.

An outside wave makes the same quarter of a period wherever the controller's integral action rules: of 92 simulated
self-regulating loops under an outside sine or square 28 were called sticky, as the paper warns for squares.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.pool import Pool, of_record, pooled
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

LAGS: Values = np.linspace(-1.0, 1.0, 401)  # of the period, at which r is kept

CARD = Card(
    name="cross_correlation", title="Cross-correlation", source="Horch 1999, Control Eng. Practice 7:1221",
    signals=("OP", "PV"), process=("self_regulating",),
    assumes=("self-regulating process", "PI controller", "one period, of the loop's own making", "constant set point"),
    finds="stiction against outside sines and tight tuning, from the phase between OP and PV; no amount",
    index=(0.0, 1.0), streams="pooled", stream_bound=0.05, cost="O(n log n)", experimental=True,
    pros=("routine data only", "shrugs off noise", "no shape needed"),
    cons=("blind on levels", "turned by dead time and strong P or D action", "outside waves that are no sines"),
    needs=("oscillation", "own_cycle", "constant_sp", "unsaturated", "raw_pv"),
    cycles=5.0, samples=(10.0, math.inf),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Limits of d_tau [-] as in the paper; d_rho disagrees beyond ``slack`` from tan^2(d_tau 45 deg) [-].

    together : largest |r| within a period, below which OP and PV have nothing to do with each other [-], ours
    """

    tau_stiction: float = 2.0 / 3.0
    tau_none: float = 1.0 / 3.0
    slack: float = 0.25
    together: float = 0.5


class Symmetry(NamedTuple):
    """d_tau, d_rho [-], the crossings tau_l, tau_r [samples], and r at lags -P..P, shape (2 P + 1,)."""

    d_tau: float
    d_rho: float
    tau_l: float
    tau_r: float
    r: Values


def symmetry(op: Values, pv: Values, period: float) -> Symmetry | None:
    """How odd the cross-correlation of two waves (n,) of mean zero is; None where it never crosses zero.

    ``period`` [samples].  Sines 60 degrees apart:

    >>> t = 2 * np.pi * np.arange(5000) / 100
    >>> found = symmetry(np.sin(t), np.sin(t - np.pi / 3), 100.0)
    >>> round(found.d_tau, 2), round(found.d_rho, 2)
    (0.67, 0.33)
    """
    r = correlation(op, pv, period)
    return of_correlation(r)


def correlation(op: Values, pv: Values, period: float) -> Values:
    """r at lags -P..P of two waves (n,) of mean zero, (2 P + 1,), P the ``period`` rounded up [samples]."""
    n, reach = len(op), math.ceil(period)
    size = 2 * n
    product = np.fft.irfft(np.conj(np.fft.rfft(op, size)) * np.fft.rfft(pv, size), size)
    lags = np.arange(-reach, reach + 1)
    r = product[lags] / (n - np.abs(lags)) / (np.std(op) * np.std(pv))  # unbiased: a cut record bends nothing
    return np.asarray(r)


def of_correlation(r: Values) -> Symmetry | None:
    """How odd r at lags -P..P, (2 P + 1,), is; None where it never crosses zero."""
    reach = (len(r) - 1) // 2
    right, left = _first_crossing(r[reach:]), _first_crossing(r[reach::-1])
    if right is None or left is None or left + right == 0.0:
        return None
    inside = r[reach - math.floor(left) : reach + math.floor(right) + 1]
    best = float(inside[np.argmax(np.abs(inside))])
    r_0 = float(r[reach])
    d_rho = abs(r_0 - best) / abs(r_0 + best) if r_0 + best != 0.0 else 1.0
    return Symmetry(abs(left - right) / (left + right), min(d_rho, 1.0), left, right, r)


def _first_crossing(r: Values) -> float | None:
    """The lag [samples] at which r first changes sign."""
    k = np.flatnonzero((r[:-1] > 0) != (r[1:] > 0))
    if not len(k):
        return None
    i = int(k[0])
    return i + float(r[i] / (r[i] - r[i + 1]))


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop.

    >>> t = np.arange(2000.0)
    >>> pv, op = np.sin(t / 8), 50 + np.cos(t / 8)
    >>> quarter = LoopRecord.from_arrays(t, pv=pv, op=op, sp=0 * t, process="self_regulating")
    >>> detect(quarter).verdict, detect(quarter).index > 0.95
    ('stiction', True)
    """
    return of_record(p, record, _seen, _judged)


def _seen(p: Params, loop: Prepared) -> Pool | Verdict:
    """r at ``LAGS`` of the period, once for the stretch, and its length [s]."""
    if refusal := refused(CARD, loop, p.tau_stiction):
        return refusal
    t, period = loop.stretch.t, loop.samples_per_period
    r = correlation(loop.wave("OP"), loop.wave("PV"), period)
    reach = (len(r) - 1) // 2
    at = np.interp(LAGS * period, np.arange(-reach, reach + 1.0), r)
    length = float(t[-1] - t[0])
    return Pool(np.array([t[0] + 0.5 * length]), np.append(at, length)[None, :], float(t[0]), 0.5 * length)


def _judged(p: Params, loop: Prepared, pool: Pool) -> Verdict:
    r = np.average(pool.rows[:, :-1], axis=0, weights=pool.rows[:, -1])
    found = of_correlation(r)
    if found is None:
        reason = "The cross-correlation of OP and PV does not cross zero within a period: they do not swing together."
        return Verdict(CARD.name, "inconclusive", None, p.tau_stiction, reason)
    word, why = _word(found, p)
    reason = f"d_tau = {found.d_tau:.2f}, d_rho = {found.d_rho:.2f}: {why} (period {loop.period:.4g} s)."
    step = loop.period * float(LAGS[1] - LAGS[0])
    evidence: dict[str, Values | float] = {
        "lag": loop.period * LAGS, "r": found.r, "tau_l": step * found.tau_l, "tau_r": step * found.tau_r,
        "d_tau": found.d_tau, "d_rho": found.d_rho,
    }  # fmt: skip
    return Verdict(CARD.name, word, found.d_tau, p.tau_stiction, reason, evidence=evidence, draw=draw)


remember, recall = pooled(_seen, _judged)


def _word(found: Symmetry, p: Params) -> tuple[Word, str]:
    top = float(np.max(np.abs(found.r)))
    if top < p.together:
        return "inconclusive", f"OP and PV do not swing together (|r| {top:.2f} at most, {p.together:g} needed)"
    expected = math.tan(0.25 * math.pi * found.d_tau) ** 2
    if abs(found.d_rho - expected) > p.slack:
        return "inconclusive", f"they contradict each other (d_rho of sines would be {expected:.2f}), as several or "\
                               "drifting waves do"  # fmt: skip
    if found.d_tau > p.tau_stiction:
        return "stiction", "OP and PV are about a quarter of a period apart, as stiction under PI control makes them"
    if found.d_tau < p.tau_none:
        return "inconclusive", (
            "OP and PV are about half a period or none apart, as an outside wave or tight tuning makes them; a sticky "
            "valve behind a long dead time or under strong proportional action does so too, so it is not cleared"
        )
    return "inconclusive", "between the limits of the paper, 1/3 and 2/3"


def draw(v: Verdict, figure: FigureBase) -> None:
    """r over the lag, with the crossings on either side of zero."""
    from stickslip.detect.figures.verdict import finish
    from stickslip.logs.style import INK, SOFT

    ax = figure.subplots()
    ax.axhline(0.0, color=SOFT, lw=0.8)
    ax.axvline(0.0, color=SOFT, lw=0.8)
    ax.plot(v.array("lag"), v.array("r"), color=INK)
    for name, sign in (("tau_l", -1.0), ("tau_r", 1.0)):
        ax.plot(sign * v.array(name), [0.0], "o", color=INK)
    ax.set_title(f"d_tau = {v.array('d_tau')[0]:.2f}: 1 is odd (valve), 0 is even (others)", loc="left")
    finish(ax, "lag of PV behind OP [s]", "cross-correlation r [-]")
