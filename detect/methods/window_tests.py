"""Window tests, Damarla and Huang 2022 to 2023: windows in which PV stays as it was while OP does not.

    cut OP and PV into windows of w samples side by side; a window is flagged where, at the level alpha,
      means       PV has the mean of the window before, OP has not       (pooled t-test, 2 w - 2 degrees of freedom)
      unequal     the same without equal variances                      (Welch; Hotelling's T^2 for one signal)
      variances   PV has the variance of the window before, OP has not  (F-test, w - 1 and w - 1)
      trends      OP has a trend inside the window, PV has none         (reverse arrangements A, mean w (w - 1) / 4,
                                                                         variance (2 w^3 + 3 w^2 - 5 w) / 72)
    Omega = share of windows flagged

Omega of the test of means is the index; the others stand in the evidence.  The amount is the 95th percentile of the
travel of OP over runs of flagged windows.  PV stands for the stem; MV is taken where it is logged.

Source: Damarla et al. 2022, AdCONIP pp 210-215, and 2023, IECR 62(12), read through a re-implementation by others; they
have w = 8 and call Omega > 0 stiction.  That calls every real loop sticky, and w must follow the period.  Ours: eight
windows a period (8 samples where there is none), a limit of 0.12, and twice as many windows flagged as those where OP
stays and PV does not, because chance, noise and a sine make both alike.  And OP must turn back: under a load ramp the
controller moves OP to hold PV, whatever the valve is like.

And Omega must be 1.3 times that of the record's linear twins (``stem.linear_twins``), because tight tuning and
coloured noise put OP and PV a lag apart.  Measured on 280 simulated loops without stiction, seeds of their own: 1
called sticky, a deadband (19 of 210 without the twins); of 80 sticky ones, many at rest, 13 found.

Not for slow processes without MV, coarse PV, or PV lost in noise.  Cost: about 3 ms for 7,200 samples.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.prepare.preconditions import refused, too_short
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.prepare.stem_signal import stem_signal
from stickslip.detect.signals.runs import runs
from stickslip.detect.stem.controller import controller_sign
from stickslip.detect.stem.linear_twins import linear_twins
from stickslip.detect.stem.recent import blocks
from stickslip.detect.stem.stick import turn_time
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Mask, Values

CARD = Card(
    name="window_tests", title="Window tests", source="Damarla et al. 2022, AdCONIP 210-215; 2023, IECR 62(12)",
    signals=("OP", "MV", "PV"), process=("self_regulating",),
    assumes=("MV logged, or a fast process", "white noise", "constant set point"),
    finds="stiction, from windows in which OP changes and PV does not; the travel of OP in %",
    index=(0.0, 1.0), streams="window", experimental=True,
    stream_note="Its rival, the linear twins of the record, are made of a whole record.",
    pros=("simple", "no oscillation needed", "every limit is a level of significance"),
    cons=(
        "slow processes", "the travel counts in whole windows", "noise hides changes of PV",
        "the published limit of 0 calls every loop",
    ),
    needs=("constant_sp", "unsaturated", "fine_pv", "raw_pv"),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """alpha, window of the papers; the others ours, see the module.

    alpha : level of significance [-]               window : samples a window where there is no period
    reversals : fewest turns of OP by a quarter of its range
    omega : least Omega for stiction [-]            excess : flagged windows over those the other way round [-]
    beyond : Omega over that of the record's linear twins [-]
    per_period : windows a period                   samples : fewest in the record
    """

    alpha: float = 0.05
    window: int = 8
    per_period: float = 8.0
    omega: float = 0.12
    excess: float = 2.0
    beyond: float = 1.3
    reversals: int = 4
    samples: int = 150


class Flags(NamedTuple):
    """Windows (m,) flagged by each test, and by the test of means the other way round: OP stays, PV does not."""

    means: Mask
    unequal: Mask
    variances: Mask
    trends: Mask
    opposite: Mask


def reverse_arrangements(x: Values) -> Values:
    """Pairs of samples in each window (m, w) of which the earlier is the larger, shape (m,).

    >>> reverse_arrangements(np.array([[1.0, 2.0, 3.0], [3.0, 2.0, 1.0]])).tolist()
    [0.0, 3.0]
    """
    first, second = np.triu_indices(x.shape[1], 1)
    return np.asarray(np.sum(x[:, first] > x[:, second], axis=1), dtype=float)


def flags(u: Values, y: Values, w: int, alpha: float = 0.05) -> Flags:
    """Every test on OP u (n,) and PV y (n,) in windows of w samples; the first window has none before it.

    OP always changes; PV is noise, and passes for unchanged in 95 % of the windows:

    >>> noise = np.random.default_rng(0).normal(size=40_000)
    >>> round(float(np.mean(flags(5.0 * np.arange(40_000.0), noise, 8).means)), 2)
    0.95
    """
    from scipy.special import fdtrc, ndtri, stdtr, stdtrit

    m = len(u) // w
    windows = [x[: m * w].reshape(m, w) for x in (u, y)]
    moved, changed, spread, trend = [], [], [], []
    for x in windows:
        tiny = (1e-9 * float(np.max(np.abs(x)) or 1.0)) ** 2
        mean, variance = np.mean(x, axis=1), np.maximum(np.var(x, axis=1, ddof=1), tiny)
        step, both = np.abs(np.diff(mean)), variance[1:] + variance[:-1]
        score = step / np.sqrt(both / w)
        freedom = (w - 1) * both**2 / (variance[1:] ** 2 + variance[:-1] ** 2)
        moved.append(score > stdtrit(2 * w - 2, 1.0 - 0.5 * alpha))
        changed.append(2.0 * stdtr(freedom, -score) < alpha)
        larger = np.maximum(variance[1:], variance[:-1]) / np.minimum(variance[1:], variance[:-1])
        spread.append(2.0 * fdtrc(w - 1, w - 1, larger) < alpha)
        A, middle, sd = reverse_arrangements(x), w * (w - 1) / 4.0, math.sqrt((2 * w**3 + 3 * w**2 - 5 * w) / 72.0)
        flat = np.ptp(x, axis=1) ** 2 <= tiny
        trend.append(((np.abs(A - middle) / sd) > ndtri(1.0 - 0.5 * alpha)) & ~flat)
    return Flags(
        moved[0] & ~moved[1], changed[0] & ~changed[1], spread[0] & ~spread[1], trend[0] & ~trend[1],
        moved[1] & ~moved[0],
    )  # fmt: skip


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop."""
    loop = prepared(record)
    if refusal := refused(CARD, loop, p.omega) or too_short(CARD, loop.stretch, p.samples, p.omega):
        return refusal
    grid = loop.stretch
    name, y = stem_signal(grid)
    u = grid.op
    w = max(round(loop.samples_per_period / p.per_period), 4) if math.isfinite(loop.period) else p.window
    found = flags(u, y, w, p.alpha)
    omega, opposite = float(np.mean(found.means)), float(np.mean(found.opposite))
    travel = _travel(u, found.means, w)
    at, turn = turn_time(u, loop.samples_per_period)
    sign = 1.0 if name == "MV" else controller_sign(u, grid.e)
    chance = max(float(np.mean(flags(u, twin, w, p.alpha).means)) for twin in linear_twins(u, y, turn, sign))
    word, why = _word(omega, opposite, chance, len(at), name, p)
    size = float(np.percentile(travel, 95)) if len(travel) else math.nan
    amount = loop.op_percent(size) if word == "stiction" else None
    reason = (
        f"Omega = {omega:.2f} ({p.omega:g} needed), the other way round {opposite:.2f}, windows of {w} samples: {why}."
    )
    evidence: dict[str, Values | float] = {
        "t": grid.t, "u": u, "y": y, "w": float(w), "flagged": found.means.astype(float), "opposite": opposite,
        "omega_unequal": float(np.mean(found.unequal)), "omega_variances": float(np.mean(found.variances)),
        "omega_trends": float(np.mean(found.trends)), "chance": chance, "travel": travel, "mv": float(name == "MV"),
    }  # fmt: skip
    return Verdict(CARD.name, word, omega, p.omega, reason, amount_percent_op=amount, evidence=evidence, draw=draw)


def _travel(u: Values, flagged: Mask, w: int) -> Values:
    """Travel of OP from the middle of the window before a run of flagged windows to the middle of its last."""
    first, end = runs(flagged)
    middles = blocks(u, w)
    return np.asarray(np.abs(middles[end] - middles[first]))


def _word(omega: float, opposite: float, chance: float, turned: int, name: str, p: Params) -> tuple[Word, str]:
    if omega > p.omega and turned < p.reversals:
        return "inconclusive", f"OP turns back {turned} times ({p.reversals} needed), and a load ramp looks the same"
    if omega > p.omega and omega < p.beyond * chance:
        return "inconclusive", f"a lag without sticking makes {chance:.2f}; {p.beyond:g} times that is needed"
    if omega > p.omega and omega > p.excess * opposite:
        return "stiction", f"{name} stays while OP changes, more than chance would have it"
    if omega > p.omega:
        return "inconclusive", f"{name} stays while OP changes about as often as the other way round"
    return "inconclusive", f"{name} seldom stays while OP changes; a slow process does that too, which clears nothing"


def draw(v: Verdict, figure: FigureBase) -> None:
    """OP and the stem (or PV) over time with the flagged windows shaded."""
    from stickslip.detect.figures.verdict import draw_stands

    t, w = v.array("t")[:800], int(v.array("w")[0])
    signals = {"OP": v.array("u")[:800], "MV" if v.array("mv")[0] else "PV": v.array("y")[:800]}
    first = w * (np.flatnonzero(v.array("flagged")) + 1)
    stands = [(t[a], t[a + w - 1]) for a in first.tolist() if a + w <= len(t)]
    draw_stands(figure.subplots(2, 1, sharex=True), t, signals, stands)
