"""Multi-model segmentation, Stenman, Gustafsson and Forsman 2003: at which samples did the stem move at all?

    x(t) = (1 - d(t)) x(t-1) + d(t) OP(t - k),    d in {0, 1}
    PV(t) = a1 PV(t-1) + a2 PV(t-2) + b x(t) + c + e(t)

A bank of hypotheses runs through the record, each with its stem x and its own recursive least squares. At every sample
each lets the stem stay, the best one also lets it move, and the least likely one of those older than three samples is
dropped (adaptive forgetting by multiple models, AFMM). A move has the prior chance q. The index is the share of samples
at which the stem moved on the most likely path: near 1 in a valve that follows, a few per cent in one that sticks.

Stiction: index from 0.02 to 0.5, stays of 5 samples or more in the median, and a likelihood that exceeds that of the
valve that always follows by ln(n) for every move. Amount: the median of the slips that end such a stay, those below
half of the largest left out; a slip may be read as two, and the paper's valve has one size (S = J), so that it is a
lower bound: all of S where J = S, from a fifth of it on where J is smaller (docs/evidence/amounts.md).

No oscillation is needed. It clears nothing: plain least squares of a loop under feedback may find the controller in the
place of the process, and follows that as well. Not for slow sampling (the stem must stay some samples), a noisy PV, or
a deadband without slip.

Measured: of 24 self-regulating loops that cycle by a valve with S = 6, J = 4 %, noise up to 0.1 % of span, 23 were
found, with a size of 4.7 to 5.9 %; none at noise of 0.3 %, 4 of 12 with S = 3 %. None of 36 loops under an outside
sine, with valves that follow, play or stick, was called sticky. A square outside wave whose integral OP is looks as a
sticky valve does. On levels it finds nothing, and refuses them. 30 to 80 ms a record.

Source: Int. J. Adapt. Control Signal Process. 17 (2003) 625. Limits, orders and the number of hypotheses are ours.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

CARD = Card(
    name="segmentation", title="Multi-model segmentation",
    source="Stenman, Gustafsson and Forsman 2003, Int. J. Adapt. Control Signal Process. 17:625",
    signals=("OP", "PV"), process=("self_regulating",),
    assumes=("the stem stays for some samples", "linear process of second order", "little noise on PV"),
    finds="share of the samples at which the stem moved, and the size of its slips",
    index=(0.0, 1.0), streams="window", cost="O(n M) for M hypotheses", experimental=True,
    stream_note="Its recursion could follow every sample, but at 60 us each, three times what all may cost.",
    pros=("no oscillation needed", "causal", "says when the stem moved"),
    cons=("noise hides the slips", "the size is a lower bound of S", "feedback biases the process it finds"),
    needs=("unsaturated", "raw_pv", "fine_pv"),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Settings, all ours.

    hypotheses : kept at a time
    q : prior chance of a move [-]
    young : samples for which a new hypothesis is not dropped
    rate_low, rate_high : share of moves of a sticking valve [-]
    stay : least median length of a stay [samples]
    per_period, samples, samples_min : samples of a period where one is known, most and fewest of the record
    delay_max : longest dead time that is tried [samples]
    """

    hypotheses: int = 16
    q: float = 0.03
    young: int = 3
    rate_low: float = 0.02
    rate_high: float = 0.5
    stay: float = 5.0
    per_period: int = 40
    samples: int = 700
    samples_min: int = 200
    delay_max: int = 8


class Path(NamedTuple):
    """The most likely path: moved (n,) 0 or 1, stem (n,), its gain in ln likelihood over the valve that follows."""

    moved: Values
    stem: Values
    gain: float


def segment(op: Values, pv: Values, p: Params = Params()) -> Path:
    """The most likely path of the stem behind OP and PV (n,), in one pass, causal.

    >>> op = np.linspace(0, 30, 301)
    >>> stem = 3 * np.floor(op / 3)
    >>> pv = np.concatenate([[0, 0], stem[:-2]]) + 0.05 * np.random.default_rng(0).normal(size=301)
    >>> path = segment(op, pv)
    >>> bool(0.02 < path.moved.mean() < 0.1)
    True
    """
    u, y = (op - np.mean(op)) / max(np.std(op), 1e-300), (pv - np.mean(pv)) / max(np.std(pv), 1e-300)
    theta_0, variance, delay = _following(u, y, p.delay_max)
    late = np.concatenate([np.full(delay, u[0]), u[: len(u) - delay]])
    n, m = len(y), p.hypotheses
    theta, P = np.tile(theta_0, (m + 1, 1)), np.tile(1.0 * np.eye(4), (m + 1, 1, 1))
    x, score, age = np.full(m + 1, late[0]), np.full(m + 1, -1e300), np.full(m + 1, n)
    score[0] = 0.0
    moved, stems, wrong = np.zeros((m + 1, n)), np.tile(late, (m + 1, 1)), np.zeros(m + 1)
    stay, move = math.log1p(-p.q), math.log(p.q)
    phi = np.ones((m + 1, 4))
    free = m
    for t in range(2, n):
        best = int(np.argmax(score))
        theta[free], P[free], score[free], wrong[free] = theta[best], P[best], score[best], wrong[best]
        moved[free, :t], stems[free, :t] = moved[best, :t], stems[best, :t]
        score += stay
        score[free] += move - stay
        x[free], age[free] = late[t], 0
        moved[:, t] = 0.0
        moved[free, t] = 1.0
        stems[:, t] = x
        phi[:, 0], phi[:, 1], phi[:, 2] = y[t - 1], y[t - 2], x
        towards = np.einsum("ijk,ik->ij", P, phi)
        spread = 1.0 + np.einsum("ij,ij->i", phi, towards)
        error = y[t] - np.einsum("ij,ij->i", phi, theta)
        square = error**2 / spread
        score -= 0.5 * (square / variance + np.log(spread))
        wrong += square
        gain = towards / spread[:, None]
        theta += gain * error[:, None]
        P -= gain[:, :, None] * towards[:, None, :]
        age += 1
        free = int(np.argmin(np.where(age > p.young, score, np.inf)))
        top = int(np.argmax(score))
        variance += 0.02 * (float(square[top]) - variance) if t > 20 else 0.0
        variance = max(variance, 1e-8)
    top = int(np.argmax(score))
    alone = _rss(u, y, delay)
    stem = stems[top] * max(float(np.std(op)), 1e-300) + float(np.mean(op))
    return Path(moved[top], stem, 0.5 * n * math.log(max(alone, 1e-12) / max(float(wrong[top]), 1e-12)))


def _following(u: Values, y: Values, delay_max: int) -> tuple[Values, float, int]:
    """Process (4,), variance of the noise and dead time of the valve that always follows, by least squares."""
    delay = min(range(delay_max + 1), key=lambda k: _rss(u, y, k))
    phi, target = _regressors(u, y, delay)
    theta = np.asarray(np.linalg.lstsq(phi, target, rcond=None)[0], dtype=np.float64)
    return theta, max(float(np.mean((target - phi @ theta) ** 2)), 1e-8), delay


def _regressors(u: Values, y: Values, delay: int) -> tuple[Values, Values]:
    late = np.concatenate([np.full(delay, u[0]), u[: len(u) - delay]])
    return np.stack([y[1:-1], y[:-2], late[2:], np.ones(len(y) - 2)], axis=1), y[2:]


def _rss(u: Values, y: Values, delay: int) -> float:
    phi, target = _regressors(u, y, delay)
    left = target - phi @ np.linalg.lstsq(phi, target, rcond=None)[0]
    return float(left @ left)


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop.

    >>> t = np.arange(1000.0)
    >>> op = 50 + 5 * np.sin(t / 9)
    >>> follows = LoopRecord.from_arrays(t, pv=op + 0.1 * np.random.default_rng(0).normal(size=1000), op=op, sp=0 * t)
    >>> detect(follows).verdict
    'inconclusive'
    """
    loop = prepared(record)
    if refusal := refused(CARD, loop, p.rate_high):
        return refusal
    grid = loop.whole
    per_period = loop.samples_per_period if math.isfinite(loop.period) else math.nan
    each = max(1, round(per_period / p.per_period) if math.isfinite(per_period) else math.ceil(len(grid) / p.samples))
    op, pv = grid.op[::each][: p.samples], grid.pv[::each][: p.samples]
    if len(op) < p.samples_min:
        few = f"{len(op)} samples without a gap; {p.samples_min} are needed."
        return Verdict.not_applicable(CARD.name, "too_few_cycles", few, p.rate_high)
    path = segment(op, pv, p)
    rate = float(np.mean(path.moved[2:]))
    stays, slips = _runs(path)
    needed = math.log(len(op)) * float(np.sum(path.moved))
    stay, slip = (float(np.median(v)) if len(v) else 0.0 for v in (stays, slips))
    word, why = _word(rate, stay, path.gain, needed, p)
    scale, unit = loop.op_unit
    reason = (
        f"The stem moves at {rate:.0%} of the samples (limits {p.rate_low:.0%} to {p.rate_high:.0%}), stays {stay:.0f} "
        f"samples and slips {scale * slip:.2g} {unit} in the median; ln likelihood {path.gain:.0f} "
        f"above that of a valve that follows ({needed:.0f} needed): {why}."
    )
    evidence: dict[str, Values | float] = {
        "t": grid.t[::each][: p.samples], "op": op, "pv": pv, "stem": path.stem, "moved": path.moved,
        "gain": path.gain, "needed": needed,
    }  # fmt: skip
    amount = loop.op_percent(slip) if word == "stiction" else None
    return Verdict(CARD.name, word, rate, p.rate_high, reason, amount_percent_op=amount, evidence=evidence, draw=draw)


def _runs(path: Path) -> tuple[Values, Values]:
    """Lengths of the stays [samples], and the moves of the stem that end those of five samples or more."""
    at = np.flatnonzero(path.moved > 0.0)
    gaps = np.diff(at) - 1
    slips = np.abs(np.diff(path.stem[at]))[gaps >= 5]
    large = slips[slips > 0.5 * np.max(slips, initial=0.0)]  # the others correct a slip that was placed a sample off
    return gaps[gaps > 0].astype(float), large


def _word(rate: float, stay: float, gain: float, needed: float, p: Params) -> tuple[Word, str]:
    if not p.rate_low <= rate <= p.rate_high:
        return "inconclusive", "it moves too often to stick or hardly at all, which clears nothing under feedback"
    if stay < p.stay:
        return "inconclusive", "it stays too briefly to be called stuck"
    if gain <= needed:
        return "inconclusive", "a valve that follows predicts PV about as well"
    return "stiction", "it sticks and slips"


def draw(v: Verdict, figure: FigureBase) -> None:
    """OP with the stem below it, and PV."""
    from stickslip.detect.figures.verdict import finish
    from stickslip.logs.style import INK, SOFT

    upper, lower = figure.subplots(2, 1, sharex=True)
    t = v.array("t")[:400]
    upper.plot(t, v.array("op")[:400], color=SOFT, lw=1.0, label="OP")
    upper.step(t, v.array("stem")[:400], where="post", color=INK, lw=1.2, label="stem, most likely")
    upper.legend(frameon=False, fontsize=8.5, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)
    lower.plot(t, v.array("pv")[:400], color=INK, lw=0.9)
    finish(upper, "", "OP")
    finish(lower, "time [s]", "PV")
