"""Square against sine in the control error, Hagglund 2011, with his backlash estimate of 2007: made for streaming.

For each half wave of e = SP - PV of length T, with IAE the integral of |e| over it,

    a_sine = pi IAE / (2 T),   V_sine   = sum (|e| - a_sine sin(pi t / T))^2
    a_square = IAE / T,        V_square = sum (|e| - a_square)^2
    I = (V_sine - V_square) / (V_sine + V_square)

Both shapes have the area of the half wave.  I is 1 for a square and -1 for a sine; its mean over the half waves is the
index, and positive means stiction.  Where the controller is known (K in OP per PV, T_i) and the gain K_p of the
process, a half wave that stands still long enough (T >= 5 T_i, peak below 2 IAE / T) also gives the dead band

    d = K (T / T_i - 1 / (K K_p)) IAE / T        [unit of OP]

It is made for a backlash, and then S.  Of a valve that slips by J, e stands at K_p J / 2, and d is S - J / 2 at most.

Source: Hagglund 2011, Control Eng. Practice 19:782; 2007, J. Process Control 17:489; the formulas as a public
implementation has them, with sums over the half wave instead of its last sample.  Limit 0 in the paper; ours: 0.1 with
an interval above 0, a crossing that counts beyond 0.3 of the mean |e|, ten half waves, regular in length.

The process must be fast: PV of a half wave three time constants long has I = -0.6, so a low index clears nothing.

The streaming twin remembers the samples of the present half wave and 400 half waves; every half wave is worked out
by the same lines in both forms, so that they differ by rounding only.  The batch form asks the autocorrelation for an
oscillation besides.  Measured: 6 ms for 7,200 samples and 120 half waves; 5 us per sample when streaming.
"""

import math
from dataclasses import dataclass
from itertools import starmap
from typing import NamedTuple

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.signals.bootstrap import interval
from stickslip.detect.signals.crossings import crossings
from stickslip.detect.signals.order import percentile
from stickslip.detect.stream import Buffer, LoopFacts, Sample
from stickslip.detect.verdict import Code, FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

CARD = Card(
    name="hagglund2011", title="Hagglund shape index",
    source="Hagglund 2011, Control Eng. Practice 19:782; backlash 2007, J. Process Control 17:489",
    signals=("SP", "PV"), process=("self_regulating",),
    assumes=("sustained oscillation of the loop's own making", "process fast against the half period", "constant SP"),
    finds="whether PV is square, as a sticky valve makes it in a fast loop; a dead band where the controller is known",
    index=(-1.0, 1.0), streams="exact", cost="O(1) per sample", experimental=True,
    pros=("runs in the controller", "no period needed", "a few kB of memory"),
    cons=("misses slow processes", "the dead band is at most S - J / 2", "noise", "an outside square looks the same"),
    needs=("oscillation", "constant_sp", "unsaturated", "fine_pv"),
    cycles=5.0, samples=(16.0, math.inf),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Limits and, where known, the controller.

    I_stiction : index above which the half waves are square [-]
    half_waves_min, half_waves_max : fewest for a verdict (n_lim of Hagglund 1995), and how many are remembered
    band : hysteresis of the crossings [share of the mean |e|]
    memory : samples over which the mean of |e| forgets
    samples_min, block : fewest and most samples of a half wave
    regularity_min : mean / (3 std) of the full periods [-], above which they are those of an oscillation
    K, T_i, K_p : gain [OP per PV] and integral time [s] of the controller, gain of the process [PV per OP]
    """

    I_stiction: float = 0.1
    half_waves_min: int = 10
    half_waves_max: int = 400
    band: float = 0.3
    memory: int = 2000
    samples_min: int = 8
    block: int = 4096
    regularity_min: float = 1.0
    K: float | None = None
    T_i: float | None = None
    K_p: float | None = None

    def __post_init__(self) -> None:
        known = [x for x in (self.K, self.T_i, self.K_p) if x is not None]
        if len(known) not in (0, 3) or 0.0 in known or (self.T_i is not None and self.T_i < 0.0):
            raise ValueError(
                f"K = {self.K}, T_i = {self.T_i}, K_p = {self.K_p}; give all three (T_i > 0, no zero) or none"
            )


class HalfWave(NamedTuple):
    """Start [s], length T [s], IAE [unit s], mean squares V_sine and V_square [unit^2], largest |e|, shape (21,).

    ``fault`` says why it does not count: "gap", "sp" or "long"; ``samples`` is the number of samples inside.
    """

    start: float
    length: float
    iae: float
    v_sine: float
    v_square: float
    peak: float
    samples: int
    shape: Values
    fault: str = ""

    @property
    def shape_index(self) -> float:
        """I of this half wave [-]."""
        return (self.v_sine - self.v_square) / max(self.v_sine + self.v_square, 1e-300)


_PHASE = np.linspace(0.0, 1.0, 21)


def measure(t: Values, e: Values, sp: Values, start: float, end: float, block: int = 4096) -> HalfWave:
    """The half wave between two crossings [s] from the samples between them, (m,).

    >>> t = (np.arange(5000) + 0.5) / 100
    >>> one = measure(t, -3 * np.sin(np.pi * t / 50), 0 * t, 0.0, 50.0, block=5000)
    >>> round(one.iae, 2), round(one.shape_index, 3)
    (95.49, -1.0)
    """
    return measure_all(t, e, sp, np.array([start, end]), block)[0]


def measure_all(t: Values, e: Values, sp: Values, cuts: Values, block: int = 4096) -> list[HalfWave]:
    """The half waves between neighbouring ``cuts`` [s] that have samples inside, as ``measure`` gives one by one."""
    from stickslip.detect.half_waves.half_cycle_kernels import half_waves

    m = max(len(cuts) - 1, 0)
    sums, shapes = np.zeros((m, 7)), np.zeros((m, len(_PHASE)))
    half_waves(*(np.ascontiguousarray(x) for x in (t, e, sp, cuts)), _PHASE, sums, shapes)
    lengths = np.diff(cuts)
    shapes /= np.maximum(sums[:, :1] / lengths[:, None], 1e-300)
    *columns, step, span, samples = sums.T  # IAE, V_sine, V_square, peak
    gap = np.where(step > 0.25 * lengths, "gap", "")
    faults = np.where(samples > block, "long", np.where(span > 0.0, "sp", gap))
    columns = [cuts[:m], lengths, *columns, samples.astype(int)]
    rows = zip(*(column.tolist() for column in columns), shapes, faults.tolist(), strict=True)
    return [half for half in starmap(HalfWave, rows) if half.samples]


# ---- batch -------------------------------------------------------------------------------------------------


def _mean_abs(e: Values, memory: int) -> Values:
    """Mean of |e| up to each sample: of all samples while they are fewer than ``memory``, forgetting afterwards."""
    from stickslip.detect.half_waves.half_cycle_kernels import mean_abs

    found = np.empty(len(e))
    mean_abs(e, memory, found)
    return found


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop.

    >>> t = np.arange(2000.0)
    >>> square = np.tanh(9 * np.sin(t / 12.7)) + 0.02 * np.sin(t**2)
    >>> loop = LoopRecord.from_arrays(t, pv=square, op=50 + np.cos(t / 12.7), sp=0 * t, process="self_regulating")
    >>> detect(loop).verdict, detect(loop).index > 0.5
    ('stiction', True)
    """
    loop = prepared(record)
    if refusal := refused(CARD, loop, p.I_stiction):
        return refusal
    record = loop.record
    if record.sp is None:
        return _no_set_point(p)
    good = record.good
    t, sp = record.t[good], record.sp[good]
    e = sp - record.pv[good]
    cut = crossings(t, e, p.band * _mean_abs(e, p.memory))
    found = measure_all(t, e, sp, cut[-(p.half_waves_max + 1) :], p.block)
    return _judge(tuple(found), LoopFacts.of(record), p)


def _no_set_point(p: Params) -> Verdict:
    return Verdict.not_applicable(
        CARD.name,
        "signal_missing",
        "SP is not logged, and this method reads the control error e = SP - PV.",
        p.I_stiction,
    )


def _judge(halves: tuple[HalfWave, ...], facts: LoopFacts, p: Params) -> Verdict:
    from stickslip.detect.signals.kernels import spread

    def no(code: Code, reason: str) -> Verdict:
        return Verdict.not_applicable(CARD.name, code, reason, p.I_stiction)

    means = [half.iae / half.length for half in halves]
    typical = percentile(np.array(means), 50.0) if halves else 0.0
    used = [half for half, mean in zip(halves, means, strict=True) if mean > 0.5 * typical and not half.fault]
    if len(used) < p.half_waves_min:
        return no("too_few_cycles", f"{len(used)} half waves of e count so far; {p.half_waves_min} are needed.")
    samples = percentile(np.array([float(half.samples) for half in used]), 50.0)
    if samples < p.samples_min:
        return no("undersampled", f"A half wave of e has {samples:g} samples; {p.samples_min} are needed.")
    lengths = np.array([half.length for half in used])
    periods = lengths[1:] + lengths[:-1]  # a wave of unequal half waves is regular too
    period, sd = spread(periods)
    regularity = period / max(3.0 * sd, 1e-3 * period)
    if regularity <= p.regularity_min:
        return no("no_oscillation", f"The periods of e spread too much for an oscillation: regularity {regularity:.2g} "
                                    f"(limit {p.regularity_min:g}).")  # fmt: skip
    v_sine, v_square = np.array([half.v_sine for half in used]), np.array([half.v_square for half in used])
    of_each = np.array([half.shape_index for half in used])
    index = float(of_each.mean())
    low, high = interval(lambda means: means[:, 0], of_each[:, None])
    word, why = _word(index, low, p)
    dead_band = _dead_band(used, p)
    span = facts.op_span
    amount = None if dead_band is None or span is None else 100.0 * dead_band / (span[1] - span[0])
    size = "" if dead_band is None else f"; the dead band is {dead_band:.3g} in the unit of OP (Hagglund 2007)"
    reason = (
        f"I = {index:.2f} (90 % interval {low:.2f} to {high:.2f}, {len(used)} half waves of e, period "
        f"{period:.4g} s): {why}{size}."
    )
    shown = used[:: -(-len(used) // 60)]
    evidence: dict[str, Values | float] = {
        "phase": _PHASE, "waves": np.array([half.shape for half in shown]),
        "sine": 0.5 * np.pi * np.sin(np.pi * _PHASE), "other": np.ones(len(_PHASE)), "error_sine": v_sine,
        "error_other": v_square, "I": of_each,
    }  # fmt: skip
    return Verdict(CARD.name, word, index, p.I_stiction, reason, interval=(low, high), amount_percent_op=amount,
                   evidence=evidence, draw=draw)  # fmt: skip


def _word(index: float, low: float, p: Params) -> tuple[Word, str]:
    if index > p.I_stiction and low > 0.0:
        return "stiction", "the half waves of e are square, as a sticky valve makes them in a fast loop"
    if index < -p.I_stiction:
        return "inconclusive", (
            "the half waves of e are nearer to a sine than to a square; a sticky valve before a process that is not "
            "fast against the half period gives them too, so it is not cleared"
        )
    return "inconclusive", f"the half waves are neither square nor sine (limit {p.I_stiction:g})"


def _dead_band(used: list[HalfWave], p: Params) -> float | None:
    """The mean dead band of the half waves that stood still, at least three [unit of OP]; None without a controller."""
    if p.K is None or p.T_i is None or p.K_p is None:
        return None
    still = [half for half in used if half.length >= 5.0 * p.T_i and half.peak < 2.0 * half.iae / half.length]
    K, K_p = abs(p.K), abs(p.K_p)  # of one sign in a stable loop, whatever the action
    found = [K * (half.length / p.T_i - 1.0 / (K * K_p)) * half.iae / half.length for half in still]
    return float(np.mean(found)) if len(found) >= 3 and np.mean(found) > 0.0 else None


class State(NamedTuple):
    """Facts, samples since the last crossing (the first is ``since`` [s]), half waves, mean |e|, number of samples.

    ``firm`` is the time of the last sample beyond the band and ``side`` its sign.
    """

    facts: LoopFacts
    buffer: Buffer = Buffer()
    since: float = math.nan
    firm: float = math.nan
    side: float = 0.0
    half_waves: tuple[HalfWave, ...] = ()
    mean_abs: float = 0.0
    seen: int = 0
    cut_off: bool = False


def init(p: Params, facts: LoopFacts | None = None) -> State:
    """The state before the first sample."""
    return State(facts or LoopFacts())


def update(p: Params, state: State, t: float, sample: Sample) -> State:
    """The state after one more sample at t [s]; a missing one, or one in manual, is skipped."""
    if not (math.isfinite(sample.pv) and math.isfinite(sample.op) and math.isfinite(sample.sp) and sample.mode >= 1.0):
        return state
    e = sample.sp - sample.pv
    seen = min(state.seen + 1, p.memory)
    mean_abs = state.mean_abs + (abs(e) - state.mean_abs) / seen
    buffer, cut_off = state.buffer.append(t, sample), state.cut_off
    if len(buffer) > p.block + 64:
        buffer, cut_off = buffer.last(p.block // 2), True
    firm, side = state.firm, state.side
    if abs(e) > p.band * mean_abs:
        firm, side = t, math.copysign(1.0, e)
    turned = side != state.side and state.side != 0.0
    new = state._replace(
        buffer=buffer, firm=state.firm if turned else firm, side=side, mean_abs=mean_abs, seen=seen, cut_off=cut_off
    )
    return _close(p, new, t) if turned else new


def _close(p: Params, state: State, t: float) -> State:
    """The state after e went firmly to the other side at t."""
    rows = state.buffer.rows()
    at, e, sp = rows[:, 0], rows[:, 3] - rows[:, 1], rows[:, 3]
    between = at >= state.firm
    band = np.where((at == state.firm) | (at == t), 0.0, math.inf)[between]
    if state.cut_off and at[0] > state.firm:
        band[0] = 0.0
    found = crossings(at[between], e[between], band)
    cut = float(found[0]) if len(found) else t
    first = int(np.searchsorted(at, cut, side="left"))
    halves = state.half_waves
    if math.isfinite(state.since) and first > 0:
        half = measure(at[:first], e[:first], sp[:first], state.since, cut, p.block)
        half = half._replace(fault="long") if state.cut_off else half
        halves = (*halves, half)[-p.half_waves_max :]
    rest = state.buffer.last(len(rows) - first)
    return state._replace(buffer=rest, since=cut, firm=t, half_waves=halves, cut_off=False)


def verdict(p: Params, state: State) -> Verdict:
    """The verdict on the half waves remembered."""
    return _judge(state.half_waves, state.facts, p) if state.facts.has_sp else _no_set_point(p)


def draw(v: Verdict, figure: FigureBase) -> None:
    """The half waves of e with the sine and the square of equal area, and the two errors of each."""
    from stickslip.detect.figures.half_waves import draw_fits

    draw_fits(v, figure, "|e|", "square", "below the diagonal the square fits better")
