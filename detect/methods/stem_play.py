"""Stem and OP: where the stem position is logged, S, J, deadband and positioner are read off it.

    stand     the stem keeps its level within the noise; it came to rest at OP = u_s and leaves at OP = u_b
    reversal  it leaves against the way it came:      S = |u_b - u_s|
    restart   it leaves the way it came:              J = |u_b - u_s|, used where there is no reversal
    slip      J = |move of MV| / b - (|u_b - u_s| - S) at a reversal
    MV = a + b OP - d b f_D where it comes to rest, d the way it came, f_D = (S - J) / 2;    deadband = S - J

These are the moves of the valve of Kano et al. 2004; u_b lies between two samples, and the middle is taken.  S and J
are medians over the stands, with 90 % intervals from their scatter and from the step of OP in a sample.  a and b, the
offset and the gain of positioner and transmitter, come from least squares where OP rests at different places, else b is
1.  MV may be up to three samples late: a delay is taken where it halves the scatter of S, if that is more than OP's
sampling makes.

A stick is called where the interval of J lies above ``slip`` and above six sigma of the noise, and where MV does stray
from OP: by S + J over a stick.  No friction makes J larger than S; where J is read ``friction`` times as large, OP is
logged coarser or later than MV, and nothing is called.  Where J lies below, or where OP turned often and far and MV
never strayed from it, the valve does not stick; a deadband that is left is stated: it costs control, but is no stick.

OP may stand at a limit: the stem comes to rest where OP does, and leaves it as from anywhere else.  Stands of the stem
at an end of its own span (``end``) are left out, because its seat or stop may hold it there; where the span is not
known, a saturated OP is refused.

Source: the picture is Choudhury, Thornhill, Shah 2005, Control Eng. Practice 13:641; reading it so and its limits are
ours.  Not for a transmitter that reads the positioner's command; of a slip that takes more than ``SLIP_SAMPLES``
only these are read.  Where tight limits of a stand show no stick, wider ones are tried: friction gives a little
before it breaks away.  Cost: about 8 ms for 7,200 samples, 15 ms where both are tried.
"""

import math
from dataclasses import dataclass

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.prepare.preconditions import refused, too_short
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.stem.logged_stem import LATEST, Stem, band, stem
from stickslip.detect.stem.play import travel_of
from stickslip.detect.stem.stem_noise import stem_noise
from stickslip.detect.stem.stick import turn_time
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

CREEPS, JUMPS = 0.03, 2.0  # of MV's range: a stem that gives so much before it breaks away stands; of that, its jumps
TURN_LATE = 6.0  # samples from turn to turn of OP, over the samples that the stem may be late
STOOD_SHARE = (
    0.5  # share of the samples that such a stem must stand: one that lags behind OP keeps still where OP turns
)
TURNED_SHARE = 0.2  # of the turns of OP: so many must turn the stem, unless they agree

CARD = Card(
    name="stem_play", title="Stem and OP",
    source="ours; picture after Choudhury, Thornhill, Shah 2005, Control Eng. Practice 13:641",
    signals=("OP", "MV"), process=("self_regulating", "integrating"),
    assumes=("MV is the true stem position", "OP reverses"),
    finds="stiction from the stem itself; S, J, deadband, offset and gain of the positioner",
    index=(0.0, math.inf), streams="no", cost="O(n)", experimental=True,
    stream_note="A stream brings PV, OP, SP and the mode, not the stem position that this method reads.",
    pros=("nothing of the process matters", "S and J with intervals", "separates a deadband from a stick"),
    cons=("few plants log the stem",),
    needs=("mv",),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Limits, all ours.

    slip : least J that is a stick [% of OP span, or of OP's travel where the span is unknown]
    end : distance from an end of the span within which the seat or stop may hold the stem [share of the span]
    scatter : largest interquartile range of S over its median [-]
    reversals, turns : fewest of the stem to accuse, of OP to clear; samples : fewest
    friction : largest J over S; friction alone gives at most 1, since S = (F_s + F_c) / k and J = (F_s - F_c) / k
    agreeing, agreement : fewer reversals are enough where their S differs by at most this share [-]
    """

    slip: float = 0.2
    end: float = 0.005
    scatter: float = 0.5
    friction: float = 1.5
    reversals: int = 4
    agreeing: int = 3
    agreement: float = 0.1
    turns: int = 2
    samples: int = 150


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop."""
    loop = prepared(record)
    if refusal := refused(CARD, loop, p.slip):
        return refusal
    limited = next((fact for fact in loop.present if fact.code == "op_saturated"), None)
    if limited is not None and loop.record.op_span is None:
        return Verdict.not_applicable(CARD.name, "op_saturated", limited.text, p.slip)
    grid = loop.whole
    mv = grid.mv
    if refusal := too_short(CARD, grid, p.samples, p.slip):
        return refusal
    if mv is None or not np.all(np.isfinite(mv)) or np.ptp(mv) == 0.0:
        return Verdict.not_applicable(CARD.name, "signal_missing", "MV has bad samples or never moves.", p.slip)
    u = grid.op
    at, turn = turn_time(u, loop.period / grid.dt)
    travel = travel_of(u, turn)
    sigma = stem_noise(grid.t, u, mv)
    free, span = (-math.inf, math.inf), loop.record.op_span
    if span is not None:
        off = p.end * (span[1] - span[0])
        free = (span[0] + off, span[1] - off)
    percent = loop.op_percent(1.0)
    unit = 100.0 / travel if percent is None else percent
    apart = unit * band(u, mv)
    latest = min(LATEST, round(turn / TURN_LATE))
    found = stem(u, mv, sigma, free, latest)
    word, why = _word(found, unit, unit * travel, len(at), apart, unit * 6.0 * sigma / abs(found.gain), p)
    if word != "stiction":
        give = CREEPS * float(np.subtract(*np.percentile(mv, [99.0, 1.0])))
        creeping = stem(u, mv, max(sigma, give / 4.5), free, latest)
        said = _word(creeping, unit, unit * travel, len(at), apart, unit * JUMPS * give / abs(creeping.gain), p)
        stood = float(np.sum(creeping.last - creeping.first + 1)) / len(mv)
        if said[0] == "stiction" and stood >= STOOD_SHARE:
            found, (word, why) = creeping, said
    S, J = (tuple(unit * v for v in triple) for triple in (found.S, found.J))
    evidence: dict[str, Values | float] = {
        "t": grid.t, "u": u, "mv": mv, "S": S[0], "S_low": S[1], "S_high": S[2], "J": J[0], "J_low": J[1],
        "J_high": J[2], "deadband": S[0] - J[0], "offset": found.offset, "gain": found.gain,
        "gain_known": float(found.gain_known), "lag": found.lag * grid.dt, "scatter": found.scatter,
        "S_each": unit * found.S_each, "J_each": unit * found.J_each, "first": grid.t[found.first],
        "last": grid.t[found.last],
    }  # fmt: skip
    decided = word != "inconclusive" and math.isfinite(J[0])
    return Verdict(
        CARD.name, word, J[0] if math.isfinite(J[0]) else None, p.slip, why, interval=(J[1], J[2]) if decided else None,
        amount_percent_op=loop.op_percent(found.S[0]) if word == "stiction" else None, evidence=evidence, draw=draw,
    )  # fmt: skip


def _word(f: Stem, unit: float, travel: float, turned: int, apart: float, noise: float, p: Params) -> tuple[Word, str]:
    m, of = len(f.S_each), "% of OP"
    same = m >= p.agreeing and float(np.ptp(f.S_each)) <= p.agreement * f.S[0]
    needed = p.agreeing if same else max(p.reversals, math.ceil(TURNED_SHARE * turned))
    least = max(p.slip, noise)  # a stand ends where MV leaves the noise, which alone makes a small jump
    if m:  # when the stem left is known to within a sample, in an even cycle always with the same error
        least = max(least, unit * f.step)
    seen = unit * (f.S[0] + f.J[0]) if m else 0.0
    sticks = m >= needed and f.scatter <= p.scatter and unit * f.J[1] > least and apart > 0.5 * seen
    if not sticks and turned >= p.turns and apart < 0.1 * travel:
        size = max(apart, least)
        return "no_stiction", (
            f"MV keeps within {apart:.2g} {of} over {turned} turns of OP by some {travel:.3g} %: S + J below "
            f"{size:.2g} %."
        )
    if m < needed:
        return "inconclusive", (
            f"The stem comes to rest and turns back {m} times, OP turns {turned} times ({needed} are needed), and "
            f"MV strays from OP by {apart:.2g} %."
        )
    S, J = (tuple(unit * v for v in triple) for triple in (f.S, f.J))
    positioner = (
        f"MV = {round(f.offset, 6):.3g} + {f.gain:.3g} OP" if f.gain_known else "the positioner's gain taken as 1"
    )
    fit = (
        f"S = {S[0]:.3g} % ({S[1]:.3g} to {S[2]:.3g}), J = {J[0]:.3g} % ({J[1]:.3g} to {J[2]:.3g}) of OP at {m} "
        f"reversals, deadband {max(S[0] - J[0], 0.0):.3g} %, {positioner}"
    )
    if f.scatter > p.scatter:
        return "inconclusive", f"OP does not say when the stem moves (S scatters by {f.scatter:.0%}): {fit}."
    if sticks and f.J[1] <= p.friction * f.S[2]:
        return "stiction", f"The stem stands and jumps: {fit}."
    if sticks:
        return "inconclusive", f"A jump wider than S is no friction's: OP and MV are not of the same instants: {fit}."
    if J[2] > 0.25 * travel or apart <= 0.5 * seen or J[1] > p.slip:
        return "inconclusive", (
            f"A jump of up to {max(J[2], least):.3g} % would not have shown (noise {noise:.2g} %, MV strays from OP by "
            f"{apart:.2g} %): {fit}."
        )
    band = "; but it has a deadband" if S[1] > p.slip else ""
    return "no_stiction", f"The stem does not jump by more than {max(J[2], least):.2g} {of}: {fit}{band}."


def draw(v: Verdict, figure: FigureBase) -> None:
    """The OP-MV picture, both over time with the stands shaded, and S and J of every stand."""
    from stickslip.detect.figures.verdict import draw_stands, finish
    from stickslip.logs.style import INK, SOFT

    grid = figure.add_gridspec(2, 3, width_ratios=(2, 3, 1))
    left, top, low = (figure.add_subplot(grid[:, 0]), figure.add_subplot(grid[0, 1]), figure.add_subplot(grid[1, 1]))
    right = figure.add_subplot(grid[:, 2])
    u, mv = v.array("u"), v.array("mv")
    left.plot(u[:3000], mv[:3000], color=SOFT, lw=0.6, marker=".", ms=2)
    stands = np.column_stack([v.array("first"), v.array("last")]).tolist()
    draw_stands((top, low), v.array("t")[:600], {"OP": u[:600], "MV": mv[:600]}, stands)
    rng = np.random.default_rng(0)
    for x, name in ((0.0, "S"), (1.0, "J")):
        each = v.array(f"{name}_each")
        right.plot(x + rng.uniform(-0.15, 0.15, len(each)), each, "o", ms=3, color=SOFT)
        right.errorbar([x], v.array(name), color=INK, fmt="_", ms=16)
    right.set_xticks([0, 1], ["S", "J"])
    right.set_ylim(bottom=0.0)
    finish(left, "OP", "MV")
    finish(right, "", "", "% of OP")
