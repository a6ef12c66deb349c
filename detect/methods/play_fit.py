"""Play fit: does PV follow OP through a sticky valve (a play with a slip jump), or just as well without one?

    without   PV(t) = s * sum of g_i OP(lag i) + load,      g_i >= 0
    with      PV(t) = s * sum of g_i  x(lag i) + load,      x = stick(OP; S, J, start)
    ratio     rms of what is left without / rms of what is left with
    gain      n_eff ln(ratio), the rise of the log-likelihood; n_eff = n (1 - a) / (1 + a), a the lag-one
              correlation of what is left with play, but at least one for each turn of OP

    jump      n_eff ln(rms with J = 0 / rms with J): a deadband is not stiction, nor does it keep a self-regulating loop
              in oscillation; only where the loop oscillates, J need not show
    clock     rms with a wave of constant period beside OP through the lag / rms with play

All models have the same lags (``stem.lags``: any chain of lags and dead time, never the controller's inverse) and
the same freedom, so the only difference is the play.  s, the sign of the process gain, is that of the controller:
feedback that holds a loop together has them equal.  The method needs no oscillation and no constant set point: moves
of SP excite the valve.  It asks for reversals of OP with travel beyond S, for the play to win at most of them, for much
the same S at each, for a jump, and for more than a wave of six harmonics of constant period from outside would tell:
outside waves keep time, a valve keeps S.  A one-way drift proves nothing: a load ramp looks the same.

A valve is cleared, "S below x %", only where PV follows OP by less than a quarter of a period: under feedback at a
constant set point OP is made from PV, and any wave passes for its own answer with a longer lag.  Then x is the largest
S whose log-likelihood is not clearly below the best.

Source: ours; the play operator as an estimator is Kano et al. 2004, method B.  All limits are ours.  A limit cycle that
repeats exactly keeps time as well as any outside wave, and is left open.  Not for OP that only follows PV at once
(strong P).

In a steady cycle an earlier slip and a longer lag look alike, and S comes out low by up to a fifth (6 % read
as 4.7 to 5.9 % in the tests); the interval knows nothing of that.

Measured with a throw-away program on about 900 plainly drawn loops (PI; lags, dead time or an integrator; S 2 to 15 %,
J from 0.3 S; half with a walking load): 87 of 200 sticky valves found (many others come to rest and show nothing), none
cleared, S 6 % low in the median; about 2 of 700 others called sticky.  Its limits were set on 360 others.  Under other
friction laws and every fault of the data (``docs/evidence/method_rates.md``) 47 of 300 were found, S
within 10 % in the median, and 4 of 300 others called sticky.

Cost: 50 ms for 7,200 samples on one slow core.  Long records are averaged in blocks to ``points`` samples, but for 8
between two turns, and the search compares 300 to 600 samples; the models are judged by all of them.
"""

import math
from dataclasses import dataclass

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.prepare.preconditions import refused, undersampled
from stickslip.detect.prepare.prepared import Grid, Prepared, prepared
from stickslip.detect.stem.controller import controller_sign
from stickslip.detect.stem.play import Fit, fit
from stickslip.detect.stem.stick import turn_time
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

CARD = Card(
    name="play_fit", title="Play fit", source="ours, after Kano et al. 2004, DYCOPS, method B",
    signals=("OP", "PV"), process=("self_regulating", "integrating"),
    assumes=("linear process in the range seen", "the loop is closed", "OP not saturated"),
    finds="stiction with or without a cycle, set-point moves allowed; S in % of OP, or the largest S that would hide",
    index=(0.9, math.inf), streams="window", cost="O(n) for each of 500 valves", experimental=True,
    stream_note="The fit starts stem and lag anew for every S that it tries, so it needs the samples themselves.",
    pros=("no oscillation needed", "any lag and dead time", "gives S and what would hide", "set point may move"),
    cons=("an exactly even cycle is left open", "needs reversals of OP", "S low in a steady cycle"),
    needs=("unsaturated", "fine_pv", "raw_pv"),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Limits of the verdict, all ours.

    ratio : rms without play over rms with it [-]        gain : rise of the log-likelihood [-]
    share : of the reversals at which play must win [-]  spread : of S over the reversals, relative [-]
    fit, clearing_fit : share of PV's variance that must be explained, to accuse and to clear [-]
    jump : rise of the log-likelihood by the slip jump [-]   jump_share : least J [share of S]
    clock : rms with an outside wave of constant period over rms with play [-]
    reversals, samples : fewest of each
    lag : largest lag of PV for clearing [half periods]  hidden : fall of log-likelihood that S must not reach [-]
    cleared : largest S that clears [share of the OP travel]        points : most points worked on
    """

    ratio: float = 1.15
    gain: float = 10.0
    share: float = 0.85  # of simulated sticky valves 19 in 20 reach 0.98 (Kano), half of the false alarms not 0.85
    spread: float = 0.35
    fit: float = 0.5
    clearing_fit: float = 0.8
    jump: float = 3.0
    jump_share: float = 0.1
    clock: float = 1.05
    reversals: int = 3
    samples: int = 150
    lag: float = 0.4
    hidden: float = 5.0
    cleared: float = 0.5
    points: int = 1200


def _blocks(grid: Grid, turn: float, points: int) -> tuple[int, Values, Values, Values]:
    """OP, PV, e averaged over blocks of k samples, so that about ``points`` are left and 8 between two turns."""
    k = max(1, min(math.ceil(len(grid) / points), int(turn / 8.0)))
    n = min(len(grid) // k, 2 * points) * k
    op, pv, e = (x[len(x) - n :].reshape(-1, k).mean(axis=1) for x in (grid.op, grid.pv, grid.e))
    return k, op, pv, e


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop."""
    loop = prepared(record)
    if refusal := refused(CARD, loop, p.ratio):
        return refusal
    grid = loop.whole
    if len(grid) < p.samples:
        reason = f"The longest piece has {len(grid)} samples; {p.samples} are needed to weigh two models."
        return Verdict.not_applicable(CARD.name, "too_few_cycles", reason, p.ratio)
    at, turn = turn_time(grid.op, loop.period / grid.dt)
    if not len(at) and not math.isfinite(loop.period):
        reason = (
            "OP never turns back by a quarter of its range; a one-way drift proves nothing, because a load ramp looks "
            "the same."
        )
        return Verdict(CARD.name, "inconclusive", None, p.ratio, reason)
    if few := undersampled(loop):
        return Verdict.not_applicable(CARD.name, "undersampled", few, p.ratio)
    k, u, y, e = _blocks(grid, turn, p.points)
    sign = controller_sign(u, e)
    kinds = (False, True) if loop.integrating is None else (loop.integrating,)
    wave = loop.period / grid.dt / k if math.isfinite(loop.period) else None
    found = fit(u, y, max(turn / k, 2.0), sign, kinds, wave)
    word, why = _word(found, turn / k, len(at), loop, p)
    amount = loop.op_percent(found.S) if word == "stiction" else None
    evidence: dict[str, Values | float] = {
        "t": grid.t[-len(found.x) * k :: k], "u": u[-len(found.x) :], "x": found.x, "y": found.y,
        "linear": found.linear, "played": found.played, "S": found.S, "J": found.J, "gain": found.gain,
        "jump_gain": found.jump_gain, "clock": found.clock, "explained": found.explained,
        "explained_without": found.explained_without,
        "wins": found.wins, "spread": found.spread, "lag": found.lag * k * grid.dt, "sizes": found.sizes,
        "loss": found.loss, "S_each": found.S_each, "travel": found.travel,
    }  # fmt: skip
    for name, value in (("S_low", found.low), ("S_high", found.high)):
        evidence[name] = loop.op_percent(value) or value
    return Verdict(CARD.name, word, found.ratio, p.ratio, why, amount_percent_op=amount, evidence=evidence, draw=draw)


def _size(loop: Prepared, amount: float) -> str:
    scale, unit = loop.op_unit
    return f"{scale * amount:.3g} {unit}"


def _word(f: Fit, turn: float, turned: int, loop: Prepared, p: Params) -> tuple[Word, str]:
    r, m = f"ratio {f.ratio:.2f}, log-likelihood gain {f.gain:.3g}", len(f.S_each)
    model = " (integrating)" if f.integrating else ""
    share = f"{max(f.explained, 0.0):.0%} of PV{model} explained"
    if f.explained < p.fit:
        return "inconclusive", (
            f"OP through a lag explains {max(f.explained, 0.0):.0%} of PV{model} with play or without ({p.fit:.0%} "
            "needed): PV moves for other reasons."
        )
    if f.ratio >= p.ratio and f.gain >= p.gain:
        s = f"S = {_size(loop, f.S)}"
        better = f"{s} would predict PV better ({r})"
        if m < p.reversals:
            return "inconclusive", f"{better}, but OP reverses {m} times with travel beyond it."
        if f.wins < p.share:
            return "inconclusive", f"{better}, but play wins at {f.wins:.0%} of {m} reversals only."
        if f.spread > p.spread:
            return "inconclusive", f"{better}, but S scatters by {f.spread:.0%} over {m} reversals."
        if f.low <= 0.0:
            return "inconclusive", f"{better}, but its interval reaches zero."
        if f.clock < p.clock:
            return "inconclusive", (
                f"{better}, but so would a wave of constant period from outside (its rms {f.clock:.2f} times as large, "
                f"{p.clock:g} needed)."
            )
        cycles = math.isfinite(loop.period) and not f.integrating  # which a deadband alone cannot sustain
        if not cycles and (f.jump_gain < p.jump or p.jump_share * f.S > f.J):
            return "inconclusive", (
                f"{better}, but a deadband without slip jump explains as much (gain by the jump "
                f"{max(f.jump_gain, 0.0):.2g}, {p.jump:g} needed), and a deadband is not stiction."
            )
        return "stiction", (
            f"PV follows OP through a play: {s}, 90 % interval {_size(loop, f.low)} to {_size(loop, f.high)}, {r}, "
            f"{share}, the better model at {f.wins:.0%} of {m} reversals, scatter {f.spread:.0%}."
        )
    # The first size of those tried that falls off clearly, with all that are larger: below it a stick could hide.
    hiding = np.flatnonzero(f.loss - np.min(f.loss) < p.hidden)[-1] + 1
    largest = float(f.sizes[hiding]) if hiding < len(f.sizes) else math.inf
    lag = f.lag / turn
    no_better = f"A play does not predict PV clearly better than a lag alone ({r})"
    if f.ratio >= p.ratio:
        return "inconclusive", f"{no_better}: too little of what is left is new noise, so nothing is cleared."
    if lag > p.lag or f.explained_without < p.clearing_fit:
        why = "the lag of any wave under feedback" if lag > p.lag else "too much else moves it"
        return "inconclusive", (
            f"{no_better}; PV follows OP by {lag:.2f} half periods, {share}: {why}, so nothing is cleared."
        )
    if turned < p.reversals and not math.isfinite(loop.period):
        return "inconclusive", (
            f"{no_better}, and OP turns back {turned} times only: a load ramp looks the same as a valve then."
        )
    if largest > p.cleared * f.travel:
        return "inconclusive", (
            f"{no_better}, but S up to {'any size' if math.isinf(largest) else _size(loop, largest)} would hide in OP "
            f"travel of {_size(loop, f.travel)}."
        )
    return "no_stiction", (
        f"PV follows OP by a lag of {lag:.2f} half periods without play ({r}, {share}): S below {_size(loop, largest)}"
        f", where OP travels {_size(loop, f.travel)}."
    )


def draw(v: Verdict, figure: FigureBase) -> None:
    """OP with the fitted stem, PV with both fits, and how the fit worsens away from the best S."""
    from stickslip.detect.figures.verdict import finish
    from stickslip.logs.style import INK, SOFT

    grid = figure.add_gridspec(2, 2, width_ratios=(3, 1))
    top, low, right = (figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[1, 0]), figure.add_subplot(grid[:, 1]))
    shown = slice(0, 600)
    t, y = v.array("t")[shown], v.array("y")[shown]
    top.plot(t, v.array("u")[shown], color=SOFT, label="OP")
    top.plot(t, v.array("x")[shown], color=INK, label="stem, fitted")
    low.plot(t, y, color=SOFT, label="PV, load off")
    low.plot(t, y - v.array("linear")[shown], color=INK, ls=":", label="without play")
    low.plot(t, y - v.array("played")[shown], color=INK, label="with play")
    right.plot(v.array("sizes"), v.array("loss"), ".-", color=INK)
    if np.max(v.array("loss")) > 10.0:
        right.set_yscale("symlog", linthresh=10.0)
    finish(top, "", "OP", named=True)
    finish(low, "time [s]", "PV", named=True)
    finish(right, "S [unit of OP]", "", "loss of log-likelihood")
