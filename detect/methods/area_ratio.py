"""Area before the peak over area after it, Singhal and Salsbury 2005: a sticky valve makes the peak late.

    R = sum A1 / sum A2

A1 is the area of a half cycle of e = SP - PV from the zero crossing to the peak, A2 from the peak to the next
crossing. After a slip PV creeps exponentially to its new level and is near its peak for long; the next slip
throws it back. So R > 1 points to stiction. For a square MV into a first-order lag tau without dead time, with
h = (half period) / tau and a = tanh(h / 2),

    R = (h - ln(1 + a) - a) / (a - ln(1 + a))

so R measures half period / tau, not the amount of stiction: less stiction can give a larger R.

R near 1 is no acquittal. The paper reads it as aggressive control, under assumptions that a record alone does not
show: h = 0.5 gives a sticky valve R = 1.4 and h = 0.2 gives it 1.13, noise and slow sensors draw R towards 1 (table
below), and the thesis finds 0.94 for a sticky valve on a level. Hence the verdict is then "inconclusive", and says
above which time constant a sticky valve would look the same; this method never answers "no_stiction".

An accusation needs both half waves, because a valve that sticks does so either way: R must be beyond its threshold
while PV is above SP and while it is below. A wave that is late on one side only is that of a process that acts one
way, or of an outside disturbance. Measured: of 1200 noise-driven resonances (damping 0.02 to 0.2, 6 to 60
periods, no valve) none is accused, nor of 300 sines with up to 30 % second harmonic and 10 % noise; of 300 sines
with up to 25 % third harmonic in a random phase 64 are, because in the right phase that is the wave of a lag.

Source: J. Process Control 15 (2005) 371; Kvam, NTNU 2009, chapter 6, whose Algorithm 1 is kept as printed in
``algorithm1``. What differs from it here, because the printed form fails on it: crossings and peaks are
interpolated; a bad half cycle is left out, not the end of the run; areas are pooled instead of averaging
ratios, whose tail is heavy; noise is smoothed without phase (``half_waves.cycles``, with the R that it leaves); half
cycles are resampled for a 90 % interval.
"""

import math
from dataclasses import dataclass, field, replace

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.half_waves import cycles
from stickslip.detect.half_waves.cycles import Cycles, Refusal
from stickslip.detect.half_waves.half_cycles import SAMPLES_MIN, HalfCycle
from stickslip.detect.half_waves.lateness import Lateness, lag_of, lateness
from stickslip.detect.half_waves.lateness import closed_form as closed_form
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.signals.order import percentile
from stickslip.detect.stream import Buffer, LoopFacts, Sample
from stickslip.detect.verdict import Code, FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

CARD = Card(
    name="area_ratio", title="Area ratio",
    source="Singhal and Salsbury 2005, J. Process Control 15:371; Kvam, NTNU 2009, chapter 6",
    signals=("SP", "PV"), process=("self_regulating",),
    assumes=(
        "sustained oscillation of the loop's own making",
        "self-regulating process, slower than a tenth of the half period", "OP not at a limit", "constant set point",
    ),
    finds="stiction, from the lateness of the peaks; neither its absence nor its amount",
    index=(0.0, math.inf), streams="exact", stream_bound=0.05, cost="O(n)",
    pros=("needs no OP", "uneven sampling", "one number with a plain meaning", "cheap"),
    cons=(
        "blind on levels: their wave is a triangle, R = 1",
        "an outside disturbance with late peaks looks like stiction",
        "lags slower than the half period and noise give R near 1: it never clears a valve",
        "square waves (very fast processes) have no peak",
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Thresholds and limits.

    R_stiction, R_low : R above the first in both half waves, with the interval above the second, is stiction; R below
        the second, with the interval below the first, is near 1 [-]. Ours: the paper's tolerance is not known to us.
    half_cycles_min : fewest accepted half cycles for a verdict; half as many on either side of SP for an accusation
    usable_min : least share of the half cycles that must be usable to decide [-]
    resamples, seed, coverage :
        Bootstrap of the half cycles for the interval of R.
    block, half_cycles_max : streaming: samples held, and half cycles remembered
    cycles : cycles.Params; drift, noise and the oscillation gate
    """

    R_stiction: float = 1.25
    R_low: float = 1.10
    half_cycles_min: int = 6
    usable_min: float = 0.5
    resamples: int = 500
    seed: int = 2005
    coverage: float = 0.90
    block: int = 2048
    half_cycles_max: int = 400
    cycles: "cycles.Params" = field(default_factory=cycles.Params)

    def __post_init__(self) -> None:
        if not 1 < self.R_low < self.R_stiction:
            raise ValueError(f"R_low = {self.R_low}, R_stiction = {self.R_stiction}; give 1 < R_low < R_stiction")
        if self.block < 64:
            raise ValueError(f"block = {self.block} samples; give at least 64")


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop.

    >>> t = np.arange(1000.0)
    >>> late = np.where(t % 50 < 25, 1.0, -1.0) * (1 - 1.916 * np.exp(-(t % 25) / 8))
    >>> loop = LoopRecord.from_arrays(t, pv=-late, op=50 + np.sin(t), sp=0 * t, process="self_regulating")
    >>> v = detect(loop)
    >>> v.verdict, round(v.index, 1)
    ('stiction', 5.8)
    """
    found = _survey(prepared(record), p)
    return found if isinstance(found, Verdict) else _judge(found.half_cycles, found, p)


def _refuse(code: Code, reason: str, p: Params) -> Verdict:
    return Verdict.not_applicable(CARD.name, code, reason, threshold=p.R_stiction)


def _survey(loop: Prepared, p: Params) -> Cycles | Verdict:
    record = loop.record
    refusal = cycles.preconditions(record, loop.facts)
    if refusal is not None and refusal.code in ("constant_signal", "manual_mode", "signal_missing"):
        return _refuse(*refusal, p)  # a dead signal comes before the kind of process
    if loop.integrating and len(record) >= 20:  # of fewer samples there is nothing to say about any process
        return _refuse(
            "wrong_process_type",
            "The process integrates (a level): with a sticky valve its PV is a triangle, whose areas before and "
            "after the peak are equal, so R = 1 would say nothing. A method for integrating loops is needed, "
            "or a log of the inflow or outflow.",
            p,
        )
    found = loop.cycles if p.cycles == cycles.Params() else cycles.cut(record, p.cycles)
    return _refuse(*found, p) if isinstance(found, Refusal) else found


# ---- from half cycles to a verdict -------------------------------------------------------------------------


def _judge(half_cycles: tuple[HalfCycle, ...], seen: Cycles, p: Params) -> Verdict:
    used = [half for half in half_cycles if not half.fault]
    total = len(half_cycles)
    evidence = _evidence(half_cycles, seen)
    tail = "".join(f"; {note}" for note in seen.notes)
    found = f"period {seen.period:.4g} s, {len(used)} of {total} half cycles usable"
    if len(used) < p.half_cycles_min:
        return _too_few([half.fault for half in half_cycles], seen, p, found, tail, evidence)
    late = lateness(used, p.resamples, p.seed, p.coverage)
    logs = [math.log(half.area_before / half.area_after) for half in used]
    evidence |= {
        "R": late.R, "R_median": math.exp(percentile(np.array(logs), 50.0)), "low": late.low, "high": late.high,
    }  # fmt: skip
    evidence |= {f"R_{side}": of.R for side, of in late.sides.items()}
    triangular = sum(half.triangle_misfit for half in used) < sum(half.sine_misfit for half in used)
    word, why = _word(late, seen, triangular, p)
    if len(used) < p.usable_min * total and word != "inconclusive":
        word, why = "inconclusive", "most half cycles are unusable, so the few that are left do not decide"
    of_side = "".join(f", {of.R:.2f} while PV is {side} {seen.centre}" for side, of in late.sides.items())
    reason = f"R = {late.R:.2f} (90 % interval {late.low:.2f} to {late.high:.2f}{of_side}): {why} ({found}{tail})."
    interval = (late.low, late.high)
    return Verdict(CARD.name, word, late.R, p.R_stiction, reason, interval=interval, evidence=evidence, draw=draw)


def _too_few(
    faults: list[str], seen: Cycles, p: Params, found: str, tail: str, evidence: dict[str, Values | float]
) -> Verdict:
    """The verdict on half cycles of which too few are usable, by the fault that most of them have."""
    worst = max(set(faults) - {""}, key=faults.count, default="")
    if worst == "flat" and faults.count("flat") >= p.half_cycles_min:
        reason = (
            f"The half cycles are flat-topped ({faults.count('flat')} of {len(faults)}; {found}): a square wave has "
            f"no peak to divide it, so R is undefined. PV-OP methods can judge such a fast loop{tail}."
        )
        return Verdict(CARD.name, "inconclusive", None, p.R_stiction, reason, evidence=evidence, draw=draw)
    if worst == "short" and faults.count("short") >= p.half_cycles_min:
        reason = (
            f"{faults.count('short')} of {len(faults)} half cycles have fewer than {SAMPLES_MIN} samples "
            f"({found}, one sample each {seen.dt:.3g} s); log faster{tail}."
        )
        return Verdict.not_applicable(CARD.name, "undersampled", reason, p.R_stiction, evidence, draw)
    why = f", most often refused: {_FAULTS[worst]}" if worst else ""
    reason = f"Too few half cycles: {found}, {p.half_cycles_min} are needed{why}{tail}."
    return Verdict.not_applicable(CARD.name, "too_few_cycles", reason, p.R_stiction, evidence, draw)


_FAULTS = {
    "short": "too few samples", "flat": "flat top", "two_peaks": "two separate peaks",
    "length": "length far from half a period", "low": "too low", "gap": "the peak falls into a gap",
}  # fmt: skip


def _word(late: Lateness, seen: Cycles, triangular: bool, p: Params) -> tuple[Word, str]:
    """The verdict on R, and why; ``triangular`` when the half cycles are nearer to a triangle than to a sine."""
    R, low, high, _ = late
    if p.R_stiction < R and low > p.R_low:
        return _accused(late, seen.centre, p)
    if 1 / p.R_low > R and high < 1 / p.R_low:
        return "inconclusive", "the peaks come early, which neither stiction nor tight tuning explains"
    if p.R_low > R and high < p.R_stiction and low > 1 / p.R_stiction:
        return "inconclusive", _near_one(high, 0.5 * seen.period, triangular)
    if high > 2 * low:
        return "inconclusive", "the half cycles disagree too much to place R against 1"
    return "inconclusive", f"neither clearly above {p.R_stiction:g} nor clearly at 1"


def _accused(late: Lateness, centre: str, p: Params) -> tuple[Word, str]:
    """Stiction when both half waves are late; otherwise which one is not."""
    needed = p.half_cycles_min // 2
    for side in ("above", "below"):
        if side not in late.sides or late.sides[side].half_cycles < needed:
            return "inconclusive", (
                f"the peaks come late, but fewer than {needed} usable half cycles lie {side} {centre}, and a sticky "
                "valve has to show on both sides"
            )
        if p.R_stiction >= late.sides[side].R:
            return "inconclusive", (
                f"the peaks come late on one side only, and R is not above {p.R_stiction:g} while PV is {side} "
                f"{centre}; a sticky valve delays both half waves, a process that acts one way or an outside wave "
                "may delay one"
            )
    return "stiction", "the peaks come late on both sides, as after a slip, then a creep to the new level"


def _near_one(high: float, half_period: float, triangular: bool) -> str:
    """Return the meaning of an R near 1; ``high`` is the upper end of its interval."""
    if triangular:
        return (
            "the peaks sit in the middle of a triangular wave, as in an integrating loop with or without a sticky "
            "valve, so this method cannot tell"
        )
    return (
        "the peaks sit in the middle of a rounded wave, as under tight tuning or an outside wave, but the valve is "
        f"not cleared: behind a process with a time constant above {lag_of(high, half_period):g} s, a slow sensor or "
        "noise, a sticky valve makes the same wave, so this method cannot tell"
    )


def _evidence(half_cycles: tuple[HalfCycle, ...], seen: Cycles) -> dict[str, Values | float]:
    return {
        "t": seen.t, "e": seen.e, "start": np.array([half.start for half in half_cycles]),
        "peak_time": np.array([half.peak_time for half in half_cycles]),
        "end": np.array([half.end for half in half_cycles]), "peak": np.array([half.peak for half in half_cycles]),
        "area_before": np.array([half.area_before for half in half_cycles]),
        "area_after": np.array([half.area_after for half in half_cycles]),
        "used": np.array([float(not half.fault) for half in half_cycles]), "period": seen.period,
        "regularity": seen.regularity,
    }  # fmt: skip


# ---- streaming twin ----------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class State:
    """The last samples (at most ``block``), the half cycles before them (at most ``half_cycles_max``), loop facts.

    Half cycles are cut from the buffer each time it is full, by the batch code; the younger half of the buffer
    stays, so that no half cycle is lost at a seam. Period, noise and drift are those of the buffer, where the
    batch form takes them from the whole record: that is the only difference between the two.
    """

    facts: LoopFacts
    buffer: Buffer = field(default_factory=Buffer)
    half_cycles: tuple[HalfCycle, ...] = ()


def init(p: Params, facts: LoopFacts | None = None) -> State:
    """The state before the first sample; without ``facts``, a loop of which nothing is known but OP in %."""
    return State(facts or LoopFacts())


def update(p: Params, state: State, t: float, sample: Sample) -> State:
    """The state after one more sample at time t [s]; work per sample is constant on average."""
    buffer = state.buffer.append(t, sample)
    if len(buffer) < p.block:
        return replace(state, buffer=buffer)
    past = remember(p, state.half_cycles, Prepared(buffer.record(state.facts)))
    return replace(state, buffer=buffer.last(p.block // 2), half_cycles=past)


def verdict(p: Params, state: State) -> Verdict:
    """The verdict on all half cycles remembered; equal to ``detect`` while the record fits in the buffer."""
    if len(state.buffer) == 0:
        return _refuse("too_few_cycles", "No sample has arrived yet.", p)
    return recall(p, state.half_cycles, Prepared(state.buffer.record(state.facts)))


def remember(p: Params, past: tuple[HalfCycle, ...], loop: Prepared) -> tuple[HalfCycle, ...]:
    """The half cycles to keep when the window ``loop`` is about to lose its older half; see ``LoopStream``."""
    found = _survey(loop, p)
    if isinstance(found, Verdict):  # the loop stopped cycling (or worse): what it did before is another story
        return ()
    return (*past, *_fresh(found, past))[-p.half_cycles_max :]


def recall(p: Params, past: tuple[HalfCycle, ...], loop: Prepared) -> Verdict:
    """The verdict on the half cycles that are kept and those of the window ``loop``."""
    found = _survey(loop, p)
    return found if isinstance(found, Verdict) else _judge((*past, *_fresh(found, past)), found, p)


def _fresh(found: Cycles, past: tuple[HalfCycle, ...]) -> tuple[HalfCycle, ...]:
    done = past[-1].end if past else -math.inf
    return tuple(half for half in found.half_cycles if 0.5 * (half.start + half.end) > done)


# ---- picture -----------------------------------------------------------------------------------------------


def draw(v: Verdict, figure: FigureBase) -> None:
    """e with the areas before (A1) and after (A2) each peak, and R of every half cycle with the interval."""
    from stickslip.detect.figures.verdict import draw_half_cycles

    draw_half_cycles(v, figure)
