"""High-passed PV against OP for integrating loops: an idea of Kvam, NTNU 2009, chapter 7, as an index and a size.

    y_k = a y_(k-1) + a (x_k - x_(k-1)),    a = tau / (tau + T_s)

Before an integrating process PV and OP of a sticky loop lie half a period apart and draw a line.  The high-pass with
tau far below the period returns the flow through the valve: PV's triangle becomes the square of MV, and the curve over
OP a rectangle as wide as the stick.  The thesis chose tau by trial.  Rule here: tau = period / 30, whose phase lead is
78 degrees.  (The thesis found a tenth and a fifth of its period good and a fiftieth too noisy; here the wave is
smoothed at eight times its frequency and neighbouring cycles are averaged first.)

    index G = A / (2 pi sqrt(det C)),    S = (R + W) / 2

(see ``prepare.pv_op_loops``).  G is 1 for two sines at any phase and 1.10 for the rectangle.  Measured: 1.022 to 1.14
in simulated sticky loops (S 3 and 6 %, J 1.5 to 4 %), at most 1.011 for sines with up to 40 % noise and 10 % second
harmonic; a deadband with hardly any jump (J = S / 4) can lie below the limit.  Limits ours.

An outside flow that steps to and fro draws nearly the same picture.  But a sticking valve lets the flow stand
still between jumps, and a sound valve makes it follow OP.  So the method accuses no valve where the flow follows OP
by more than 15 % of its jump.  Nor does it where the range of OP differs by more than 20 % between cycles (both ours).
Of 100 simulated levels each, unseen before (S 2 to 12 %, J 0.3 S to S, lags, dead time, noise), 41 of the 64 sticky
ones with enough cycles were found, 0 of 100 under outside sines, 12 of 97 under outside squares, and 16 of 46 with a
deadband and no jump; median error of S 5 %.

Source of the idea: Kvam, NTNU 2009, section 7.3, equation 7.3 (its 7.2 is another filter); index, size and rules ours.
S is the apparent one, up to 15 % low, as smoothing rounds the tips of OP.  A round curve clears nothing, for the
controller's lag and dead time round it too.
Measured on the prepared record: 4 ms for 7,200 samples.
"""

import math
from dataclasses import dataclass

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.prepare.pv_op_loops import SMOOTHED_AT, Loops, loops, tilt
from stickslip.detect.signals.bootstrap import interval
from stickslip.detect.signals.filters import first_order
from stickslip.detect.verdict import Draw, FigureBase, Verdict
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

CARD = Card(
    name="high_passed_pv", title="High-passed PV against OP", source="Kvam, NTNU 2009, section 7.3 (idea)",
    signals=("OP", "PV"), process=("integrating",),
    assumes=("integrating process", "sustained oscillation of the loop's own making", "constant set point"),
    finds="stiction before an integrating process, from the picture of OP and the flow; its apparent amount",
    index=(0.0, 2.0), streams="window", cost="O(n)", experimental=True,
    stream_note="The shift and the high-pass are chosen for a whole record, so the window is judged anew each time.",
    pros=("works on levels", "gives an amount", "sines do not matter at any phase"),
    cons=("inflows that step look the same", "the amount is apparent", "dead time rounds the picture"),
    needs=("known_process", "oscillation", "constant_sp", "unsaturated"),
    cycles=5.0, samples=(20.0, math.inf),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Rule and limits, all ours.

    tau : time constant of the high-pass [periods]
    G_stiction : roundness above which the curve is a rectangle [-]
    repeats_min : share of the variance that must return in every cycle [-]
    travel_min : least travel of OP from slip to slip [share of its range]
    tilt_max : most that the flow may follow OP between its jumps [share of the jump]
    spread_max : most that the range of OP may differ from cycle to cycle [standard deviation over mean]
    """

    tau: float = 1.0 / 30.0
    G_stiction: float = 1.02
    repeats_min: float = 0.7
    travel_min: float = 0.5
    tilt_max: float = 0.15
    spread_max: float = 0.2

    def __post_init__(self) -> None:
        if not 0.0 < self.tau <= 0.5:
            raise ValueError(f"tau = {self.tau} periods; give more than 0 and at most 0.5, or nothing is passed")


def high_passed(x: Values, tau: float, dt: float) -> Values:
    """The high-pass of the module on x (n,) with tau [s] and sampling interval dt [s], starting at rest.

    >>> high_passed(np.array([0.0, 1.0, 1.0]), 3.0, 1.0).tolist()
    [0.0, 0.75, 0.5625]
    """
    a = tau / (tau + dt)
    return first_order(x - x[0], a, -a, -a)


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop; refuses any process that is not known to integrate.

    >>> t = np.arange(3000.0)
    >>> saw = 2 * np.abs(2 * ((t / 100) % 1) - 1) - 1
    >>> loop = LoopRecord.from_arrays(t, pv=saw, op=50 - 3 * saw, sp=0 * t, process="integrating")
    >>> v = detect(loop)
    >>> v.verdict, 5.0 < v.amount_percent_op < 6.0
    ('stiction', True)
    """
    loop = prepared(record)
    if refusal := refused(CARD, loop, p.G_stiction):
        return refusal
    found = flow_loops(loop, p.tau)
    return judged(CARD, loop, found, found, p.G_stiction, p, f"with tau = {p.tau * loop.period:.4g} s", draw)


def flow_loops(loop: Prepared, tau: float) -> Loops | None:
    """The curves of high-passed PV, which stands for the flow through the valve, over OP; ``tau`` in periods."""
    flow = high_passed(loop.wave("PV", SMOOTHED_AT), tau * loop.period, loop.stretch.dt)
    return loops(loop, flow)


def judged(
    card: Card,
    loop: Prepared,
    found: Loops | None,
    flow: Loops | None,
    limit: float,
    p: Params,
    how: str,
    picture: Draw,
) -> Verdict:
    """The verdict on the curves: stiction beyond the limit, on the side of 1 where the limit lies.

    The interval of the mean roundness must lie beyond the middle between 1 and the limit, and the ``flow`` must stand
    still while OP travels.
    """
    if found is None or flow is None:
        reason = "Fewer than 3 cycles of OP are whole and inside the record."
        return Verdict.not_applicable(card.name, "too_few_cycles", reason, limit)
    if found.repeats < p.repeats_min:
        reason = (
            f"Only {found.repeats:.0%} of this form of PV returns in every cycle of OP ({p.repeats_min:.0%} are "
            "needed): the two do not swing together."
        )
        return Verdict(card.name, "inconclusive", None, limit, reason)
    index = float(found.roundness.mean())
    low, high = interval(lambda means: means[:, 0], found.roundness[:, None])
    S_low, S_high = interval(lambda means: means[:, 0], found.size[:, None])
    wide = float(np.mean(found.travel) / np.mean(found.range))
    side = math.copysign(1.0, limit - 1.0)
    beyond = side * (index - limit) > 0.0 and side * ((low if side > 0.0 else high) - 0.5 * (1.0 + limit)) > 0.0
    follows = tilt(flow.op, flow.pv)
    spread = float(np.std(found.range) / np.mean(found.range))
    sticks = beyond and wide >= p.travel_min and abs(follows) <= p.tilt_max and spread <= p.spread_max
    size = float(found.size.mean())
    amount = loop.op_percent(size) if sticks else None
    if sticks:
        why = f"no ellipse, but that of a sticky valve, S = {size:.3g} in the unit of OP ({S_low:.3g} to {S_high:.3g})"
    elif beyond and spread > p.spread_max:
        why = (
            f"no ellipse, but the range of OP differs by {spread:.0%} between cycles ({p.spread_max:.0%} allowed), "
            "where the stick sets it in a sticky loop"
        )
    elif beyond and wide >= p.travel_min:
        why = (
            f"no ellipse, but between its jumps the flow follows OP by {follows:.0%} of the jump ({p.tilt_max:.0%} "
            "allowed), as it does under an outside flow that steps and not while a valve sticks"
        )
    elif beyond:
        why = (
            f"no ellipse, but OP travels only {wide:.0%} of its range from slip to slip ({p.travel_min:.0%} are needed)"
        )
    else:
        why = "the curve is as round as that of two sines; dead time rounds that of a sticky valve too: not cleared"
    reason = (
        f"G = {index:.3f} {how} (90 % interval {low:.3f} to {high:.3f}, limit {limit:g}, {len(found.op)} mean cycles, "
        f"period {loop.period:.4g} s): {why}."
    )
    evidence: dict[str, Values | float] = {
        "op": found.op, "pv": found.pv, "G": found.roundness, "S": size, "travel": wide, "tilt": follows,
        "spread": spread, "S_low": loop.op_percent(S_low) or math.nan, "S_high": loop.op_percent(S_high) or math.nan,
    }  # fmt: skip
    return Verdict(card.name, "stiction" if sticks else "inconclusive", index, limit, reason, interval=(low, high),
                   amount_percent_op=amount, evidence=evidence, draw=picture)  # fmt: skip


def draw(v: Verdict, figure: FigureBase) -> None:
    """High-passed PV over OP with the ellipse that sines would draw."""
    from stickslip.detect.figures.pv_op import draw_pv_op

    draw_pv_op(v, figure, "high-passed PV")
