"""Dead travel by likelihood: does a stem that sticks predict PV better than any rival, as the loop itself ran?

    PV(t) from its own past and the past of w,   w = OP, or the stem of a valve with S and J
    G(S)    = log-likelihood of the best stem of size S less that of the best rival, both less what they cost [nats]
    rivals  no input; OP; OP with any delay; OP through a bent characteristic; another answer each way; a sensor with
            hysteresis

OP is logged, so the stem is known but for S, J and where it started, and the likelihood is exact in closed loop:
neither a cycle nor a constant set point is needed, and nothing is learnt.  Dead travel is called where G >= 10 nats,
5 without the best tenth of the record, over four reversals of the stem, at two of three delays.  It is excluded where
every S from 0.15 of OP's travel on loses 10 nats, and PV does answer OP, by a straight line (``likelihood.pooled``).

What is found is dead travel: a jump is called only where it gains.  Real sticky valves look much like play, and a
linkage with play looks like them.  Many days of one valve are pooled by ``likelihood.pooled.evidence_of``.

Source: ours; the likelihood is textbook (Ljung, System Identification, 1999).  Not for records drawn by a historian,
of fewer than 100 rows, or where PV answers within a sample.  Cost: 0.2 s for 750 samples, 0.5 s for 3,000; of a longer
record the last part.
"""

import math
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.likelihood.pooled import GAIN_NATS
from stickslip.detect.likelihood.words import said
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import Log, LoopRecord
from stickslip.logs.arrays import Values

SHOWN = 8.0  # turns of OP in the picture

CARD = Card(
    name="dead_travel", title="Dead travel by likelihood",
    source="ours; likelihood as in Ljung 1999, System Identification",
    signals=("OP", "PV"), process=("self_regulating", "integrating"),
    assumes=("PV answers OP one sample late or more", "linear process in the range seen, but for the rivals"),
    finds="dead travel S with its interval, a jump where it gains, or the S that is excluded; in nats",
    index=(-math.inf, math.inf), streams="window", cost="O(n) for each of some 100 stems",
    stream_note="The likelihood starts the stem anew for every S that it tries, so it needs the samples themselves.",
    pros=("no oscillation needed", "set point may move", "exact in closed loop", "adds up over days"),
    cons=("play looks like stick", "no answer where PV is drawn by a historian"),
    needs=("raw_pv", "raw_op"),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """``gain`` in log likelihood from which on dead travel is called; the other limits are those of
    ``likelihood.pooled``.
    """

    gain: float = GAIN_NATS


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """Return the verdict on one loop."""
    loop = prepared(record)
    if refusal := refused(CARD, loop, p.gain):
        return refusal
    found = loop.dead_travel
    if found is None or loop.stems is None:
        reason = "Too few samples are left in which PV and OP move: 100 rows are needed to weigh a stem."
        return Verdict.not_applicable(CARD.name, "too_few_cycles", reason, p.gain)
    percent = loop.op_percent(1.0) is not None
    word: Word = "stiction" if found.accuses else "no_stiction" if found.clears else "inconclusive"
    if word == "stiction" and found.gain < p.gain:
        word = "inconclusive"
    grid = loop.with_stale.whole
    rows = loop.stems.rows
    evidence: dict[str, Values | float] = {
        "t": grid.t[-len(rows.op) :], "u": rows.op, "x": loop.stems.stem(found.S, found.shapes[0]),
        "S": found.S, "S_low": found.low, "S_high": found.high, "J": found.J, "jump_gain": found.jump,
        "gain": found.gain, "without_best": found.without_best, "turns": float(found.turns),
        "delays": float(found.delays), "excluded": found.excluded, "loss": found.loss, "answers": found.answers,
        "sizes": found.sizes, "curve": found.curve, "tenths": found.tenths, "percent": float(percent),
        "turn": rows.between,
    }  # fmt: skip
    if loop.record.log.start is not None:
        evidence["start"] = loop.record.log.start.replace(tzinfo=UTC).timestamp()
    amount = found.S if percent and word == "stiction" else None
    return Verdict(
        CARD.name,
        word,
        found.gain,
        p.gain,
        said(found, percent),
        amount_percent_op=amount,
        evidence=evidence,
        draw=draw,
    )


def draw(verdict: Verdict, figure: FigureBase) -> None:
    """OP with the likeliest stem, the gain of every S, and what each tenth of the record adds to it."""
    from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter
    from stickslip.detect.figures.verdict import finish
    from stickslip.logs.style import COLOURS, INK, PALE, SHADE, SOFT
    from stickslip.logs.time_axis import TimeAxis

    e = {name: float(value) for name, value in verdict.evidence.items() if np.ndim(value) == 0}
    left, middle, right = figure.subplots(1, 3, width_ratios=[2.0, 1.2, 1.0])
    unit = "% of OP" if e["percent"] else "unit of OP"
    last = slice(-max(int(SHOWN * e["turn"]), 60), None)
    t = verdict.array("t")[last]
    start = datetime.fromtimestamp(e["start"], UTC) if "start" in e else None
    axis = TimeAxis(Log(t=t, signals={"OP": verdict.array("u")[last]}, start=start))
    left.plot(axis.at(t), verdict.array("u")[last], color=SOFT, label="OP")
    left.plot(axis.at(t), verdict.array("x")[last], color=COLOURS["MV"], label="likeliest stem that sticks")
    axis.finish(left, float(t[0]), float(t[-1]))
    middle.axvspan(e["S_low"], e["S_high"], color=SHADE, lw=0)
    middle.axhline(0.0, color=PALE, lw=0.8)
    middle.axhline(GAIN_NATS, color=PALE, lw=0.8, ls=":")
    middle.plot(verdict.array("sizes"), verdict.array("curve"), ".-", color=INK)
    middle.set_xscale("log")
    middle.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    middle.xaxis.set_major_formatter(FormatStrFormatter("%g"))
    middle.xaxis.set_minor_formatter(NullFormatter())
    tenths = verdict.array("tenths")
    right.bar(np.arange(1, len(tenths) + 1), tenths, color=[INK if value > 0.0 else PALE for value in tenths])
    right.axhline(0.0, color=PALE, lw=0.8)
    right.set_xticks(range(2, 11, 2))
    finish(left, "", f"OP [{unit.removesuffix(' of OP')}]", f"S = {e['S']:.2g}, J = {e['J']:.2g} {unit}", named=True)
    finish(middle, f"S [{unit}]", "", "gain over the best rival [nats]")
    finish(right, "tenth of the record", "", "where it is gained [nats]")
