"""A sticky valve before a linear process, fitted to OP and PV: how much better it predicts PV than the process alone.

    OP -> valve(S, J) -> G(q) -> PV,        F(S, J) = 100 (1 - |PV - model| / |PV - mean PV|) %

S runs from 0 to the swing of OP and J from 0 to S (a triangle: in a limit cycle no valve sticks by more than OP swings;
Lee, Ren and Huang 2008); behind each valve stands the best process of a bank (``stem.linear_models``), identified by
output error or ARMAX, with a slow disturbance beside it in the extended models. The index is F of the best valve less F
of the best process without valve [points]. All (S, J) within 2 points of the best F are the region of confidence.

Stiction: the region excludes S = 0, S is at least a tenth of the swing of OP, the index is 5 points or more, F 50 % or
more, and the region holds valves with a slip (J above 0.2 S; without one it is a deadband).

It clears nothing, though a region that holds S = 0 invites to. Measured here: of 216 loops moved by an outside sine,
valve sticking by 1 to 3 %, 129 would have been cleared below a size smaller than their own (region up to half the swing
of OP), because a lag between two sines tells either from the other, valve or not. None of them was called sticky.
On 72 simulated loops that cycle by their valve (noise to 0.7 % of span) 51 were found and 19 refused (no cycle); S was
7 % low in the median (4 to 19 % for 8 of 10) and inside its interval in 92 %; J hangs on the process gain and is poor.

Source: Jelali 2008, J. Process Control 18:632; Lee, Ren and Huang 2008; Karra and Karim 2009, Control Eng. Practice
17:387; Bacci di Capaci, Scali and Pannocchia 2016, J. Process Control 46:11. The limits are ours.

Not where OP hardly moves or saturates, where the process is far from linear, or the dead time is above a quarter of the
period. A disturbance that is no sine and no drift is explained by neither model: F stays low and nothing is decided.
About 50 to 150 ms a record.
"""

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.signals.filters import summits
from stickslip.detect.stem.linear_models import Fit, Linear, bank, fit, near_by
from stickslip.detect.stem.recent import blocks
from stickslip.detect.stem.valve_models import VALVES
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Mask, Values

# Of the swing of OP. In a limit cycle OP turns just after the slip, so that S is often nearly the swing.
SIZES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.88, 0.93, 0.96, 0.98, 0.995)

CARD = Card(
    name="hammerstein", title="Hammerstein model",
    source="Jelali 2008, J. Process Control 18:632; Lee, Ren and Huang 2008; Bacci di Capaci et al. 2016",
    signals=("OP", "PV"), process=("self_regulating", "integrating"),
    assumes=(
        "linear process", "a cycle of the loop's own making", "OP swings by more than S",
        "dead time below a quarter of a period",
    ),
    finds="S and J [% of OP], and how many points of fit the sticky valve gains over the linear process alone",
    index=(-100.0, 100.0), streams="window", cost="O(n) for each of 130 valves", experimental=True,
    stream_note="The search for S and J runs over a whole record, so nothing can be carried from window to window.",
    pros=("sizes S and J with a region", "compared with a linear loop by the same model", "any process"),
    cons=("the slowest of the methods", "J is poorly seen behind a slow process", "non-linear processes"),
    needs=("oscillation", "own_cycle", "unsaturated", "raw_pv", "follows"),
    cycles=5.0, samples=(10.0, math.inf),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Settings; all limits are ours.

    linear : the linear model; an integrating process takes the extended one of its kind
    jumps : steps of J / S
    per_period, samples : samples of a period and of the record that are used
    cut : where OP is smoothed, in frequencies of the oscillation
    region : points of F below the best that the region of confidence takes in
    full : share of the swing of OP from which on S is bounded by nothing but the swing: a model that sticks by nearly
        all of it misses a slip wherever noise takes a little off OP, and F falls for that reason alone
    gain_min, fit_min, size_min : least gain over the linear process [points], least F [%], least S [share of the swing
        of OP]
    jump_min : A valve whose region has no J / S above this is called a deadband
    """

    linear: Linear = "eoe"
    valve: Literal["kano", "he"] = "kano"
    jumps: int = 5
    per_period: int = 40
    samples: int = 1000
    cut: float = 12.0
    region: float = 2.0
    full: float = 0.8
    gain_min: float = 5.0
    fit_min: float = 50.0
    size_min: float = 0.1
    jump_min: float = 0.2


class Search(NamedTuple):
    """Every valve tried: S, J [unit of OP] and F [%], shapes (m,); F of the process alone; the fit of the best.

    valve : (k,), the stem of the best beside ``best.y`` and ``best.simulated``
    """

    S: Values
    J: Values
    F: Values
    F_linear: float
    best: Fit

    @property
    def top(self) -> int:
        """Index of the best valve."""
        return int(np.argmax(self.F))

    def region(self, points: float) -> Mask:
        """Which valves are within so many points of the best, shape (m,)."""
        return np.asarray(np.max(self.F) - points <= self.F)

    def range(self, of: Values, points: float) -> tuple[float, float]:
        """Least and largest S or J of the region, out to the next that were tried and do not belong [unit of OP]."""
        inside = of[self.region(points)]
        low, high = float(np.min(inside)), float(np.max(inside))
        return float(np.max(of[of < low], initial=0.0)), float(np.min(of[of > high], initial=float(np.max(of))))


def search(
    op: Values, pv: Values, period: float, swing: float, sign: float = 0.0, integrating: bool = False,
    p: Params = Params(),
) -> Search:  # fmt: skip
    """Fit every valve of the triangle, then again around the best.

    pv : (n,), op : (n,) or (2 n,), two values of OP for each of PV
    ``period`` [samples of PV], ``swing`` of OP [its unit], ``sign`` of the process gain (0: either)
    """
    model: Linear = p.linear
    if integrating and model not in ("eoe", "earmax"):
        model = "earmax" if model == "armax" else "eoe"

    # Where the stem stood at first is not known; at the first summit or valley of OP it has just come along.
    each = len(op) // len(pv)
    middle = 0.5 * (np.min(op) + np.max(op))
    turn = int(np.argmax(np.abs(op[: round(1.1 * period) * each] - middle))) // each
    op, pv = op[turn * each :], pv[turn:]
    way = 1.0 if op[0] > middle else -1.0

    def stems(S: Values, J: Values) -> Values:
        return np.asarray(VALVES[p.valve](op, S, J, way).reshape(len(S), len(pv), each).mean(axis=2))

    none = np.zeros(1)
    fine = bank(period, model, sign, 25, integrating)
    alone = fit(stems(none, none), pv, period, model, fine)
    alone = fit(stems(none, none), pv, period, model, near_by(fine, alone.processes[0]))

    ratios = np.linspace(0.0, 1.0, p.jumps)
    S = np.repeat(np.array(SIZES) * swing, p.jumps)
    J = S * np.tile(ratios, len(SIZES))
    coarse = bank(period, model, sign, 7, integrating)
    first = fit(stems(S, J), pv, period, model, coarse)

    top = int(np.argmax(first.quality))
    at = top // p.jumps
    sides = (0.0, *SIZES, 1.0)[at : at + 3]
    near = np.unique(np.linspace(sides[0], sides[2], 9)[1:-1]) * swing
    ratio = J[top] / S[top]
    step = 1.0 / (p.jumps - 1)
    around = np.unique(np.clip(ratio + np.linspace(-0.8, 0.8, 5) * step, 0.0, 1.0))
    S_2 = np.repeat(near, len(around))
    J_2 = S_2 * np.tile(around, len(near))
    second = fit(stems(S_2, J_2), pv, period, model, near_by(coarse, first.processes[top]))
    F_linear = float(alone.quality[0])
    return Search(
        np.concatenate([[0.0], S, S_2]), np.concatenate([[0.0], J, J_2]),
        np.concatenate([[F_linear], first.quality, second.quality]), F_linear,
        max((alone, first, second), key=lambda found: float(np.max(found.quality))),
    )  # fmt: skip


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop.

    >>> t = np.arange(3000.0)
    >>> op = 50 + 5 * np.abs(t / 25 % 2 - 1)
    >>> pv = np.where(t // 25 % 2 == 0, 1.0, -1.0) * (1 - 1.97 * np.exp(-(t % 25) / 6))
    >>> slipping = LoopRecord.from_arrays(t, pv=pv, op=op, sp=0 * t)  # PV settles anew at every turn of OP
    >>> detect(slipping).verdict
    'stiction'
    """
    loop = prepared(record)
    if refusal := refused(CARD, loop, p.gain_min):
        return refusal
    grid = loop.stretch
    each = max(1, round(loop.samples_per_period / p.per_period))
    # Noise on OP lets the model slip a sample too early, and then it is out of step for half a cycle.
    smooth = grid.op - loop.wave("OP", 0.0) + loop.wave("OP", p.cut)
    op, pv = _extremes(smooth, each, p.samples), blocks(grid.pv[: each * p.samples], each)
    swing = float(np.ptp(np.percentile(loop.wave("OP", p.cut), [0.5, 99.5])))
    rounded = 1.0 + _shaved(grid.op, smooth, loop.samples_per_period) / swing
    found = search(op, pv, loop.samples_per_period / each, swing, _sign(grid.op, grid.e), bool(loop.integrating), p)
    found, swing = found._replace(S=rounded * found.S, J=rounded * found.J), rounded * swing
    S, J, F = float(found.S[found.top]), float(found.J[found.top]), float(found.F[found.top])
    (S_low, S_high), (J_low, J_high) = found.range(found.S, p.region), found.range(found.J, p.region)
    if S_high >= p.full * swing:
        S_high = swing
    index = F - found.F_linear
    part, unit = loop.op_unit
    word, why = _word(found, swing, p)
    reason = (
        f"The process alone tells {found.F_linear:.0f} % of PV, with a sticky valve {F:.0f} %; S = {part * S:.2g} "
        f"({part * S_low:.2g} to {part * S_high:.2g}), J = {part * J:.2g} ({part * J_low:.2g} to {part * J_high:.2g}) "
        f"{unit}, swing of OP {part * swing:.2g}: {why}."
    )
    evidence: dict[str, Values | float] = {
        "S": part * S, "S_low": part * S_low, "S_high": part * S_high, "J": part * J, "J_low": part * J_low,
        "J_high": part * J_high, "swing": part * swing, "F": F, "F_linear": found.F_linear,
        "all_S": part * found.S, "all_J": part * found.J, "all_F": found.F, "region": p.region,
        "y": found.best.y, "simulated": found.best.simulated, "dt": grid.dt * each,
    }  # fmt: skip
    amount = loop.op_percent(S) if word == "stiction" else None
    return Verdict(CARD.name, word, index, p.gain_min, reason, amount_percent_op=amount, evidence=evidence, draw=draw)


def _word(found: Search, swing: float, p: Params) -> tuple[Word, str]:
    inside = found.region(p.region)
    S, gain = float(found.S[found.top]), float(found.F[found.top]) - found.F_linear
    if found.F[found.top] < p.fit_min:
        return "inconclusive", f"neither tells {p.fit_min:.0f} %, something else moves PV"
    if inside[0]:
        return "inconclusive", "no valve is needed, but an outside wave hides one as well, so it is not cleared"
    if p.size_min * swing > S or gain < p.gain_min:
        return "inconclusive", f"below {p.gain_min:g} points of gain or {p.size_min:.0%} of the swing of OP"
    if np.max(found.J[inside] / found.S[inside]) < p.jump_min:
        return "inconclusive", "a deadband without slip predicts PV best, and that is no stick-slip"
    return "stiction", "the sticky valve is needed to predict PV"


def _sign(op: Values, e: Values) -> float:
    """Sign of the controller gain, which in a closed loop is that of the process: of OP with e, or of its moves with e.

    P action shows in the first, integral action in the second; 0 where neither does.
    """
    e = e - np.mean(e)

    def together(x: Values, y: Values) -> float:
        spread = float(np.std(x) * np.std(y))
        return float(np.mean((x - np.mean(x)) * y)) / spread if spread > 0.0 else 0.0

    stronger = max(together(op, e), together(np.diff(op), e[1:]), key=abs)
    return math.copysign(1.0, stronger) if abs(stronger) > 0.1 else 0.0


def _shaved(op: Values, smooth: Values, period: float) -> float:
    """How much the smoothing takes off the swing of OP, on average over its summits and valleys [unit of OP]."""
    room = max(1, round(0.6 * period))
    tops = [(sign, summits(sign * smooth, room)) for sign in (1.0, -1.0)]
    return max(sum(float(np.mean(sign * (op - smooth)[at])) for sign, at in tops if len(at)), 0.0)


def _extremes(x: Values, each: int, most: int) -> Values:
    """Least and largest of so many samples, in their order: a mean would cut the turns of OP, on which S hangs."""
    n = min(len(x) // each, most)
    rows = x[: n * each].reshape(n, each)
    if each == 1:
        return rows[:, 0]
    ends = np.sort(np.stack([np.argmin(rows, axis=1), np.argmax(rows, axis=1)], axis=1), axis=1)
    return np.take_along_axis(rows, ends, axis=1).ravel()


def draw(v: Verdict, figure: FigureBase) -> None:
    """PV and the model over time, and F over the triangle of S and J with its region of confidence."""
    from stickslip.detect.figures.verdict import finish
    from stickslip.logs.style import INK, SOFT

    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    shown = slice(0, 250)
    t = float(v.array("dt")[0]) * np.arange(len(v.array("y")))
    left.plot(t[shown], v.array("y")[shown], color=SOFT, lw=2.5, alpha=0.6, label="PV")
    left.plot(t[shown], v.array("simulated")[shown], color=INK, lw=1.0, label="model with valve")
    left.legend(frameon=False, fontsize=8.5, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)
    finish(left, "time [s]", "PV, slow part off")
    S, J, F = v.array("all_S"), v.array("all_J"), v.array("all_F")
    order = np.argsort(F)
    points = right.scatter(S[order], J[order], c=F[order], s=28, cmap="viridis")
    inside = float(v.array("F")[0] - v.array("region")[0]) <= F
    right.plot(S[inside], J[inside], "o", ms=8, mfc="none", mec=INK, label="region of confidence")
    right.legend(frameon=False, fontsize=8.5, loc="upper left")
    figure.colorbar(points, ax=right, label="F [%]")
    finish(right, "S [% of OP]", "J [% of OP]")
