"""From a loop record to the half cycles of its control error: the first leg of every shape method.

    checks -> pieces between gaps and set-point moves -> oscillation gate -> drift off -> noise off -> half cycles

A gap that is much shorter than a period is bridged (see ``gaps``); a half cycle whose peak falls into one is left out.

Each step either says why it cannot go on (``Refusal``) or notes what it did. e = SP - PV; without a logged SP the
mean of PV stands for it, so that the sign of e stays that of -PV.

Smoothing is a moving average over time, as wide as the noise asks for and at most a tenth of a period (see
``Params``). Measured: pooled R of ``area_ratio``, mean (standard deviation) of 12 records of 20 cycles, 50 samples a
period, white noise in % of the signal's standard deviation; the exponential wave has R = 5.87, the sine 1.

    noise                               2 %          10 %         20 %         30 %
    exponential, this moving average    4.52 (0.20)  2.30 (0.05)  2.01 (0.07)  1.82 (0.09)
    exponential, Kalman, q fitted       4.34 (0.17)  2.49 (0.16)  1.93 (0.14)  1.56 (0.05)
    exponential, Kalman at 5 / period   2.20 (0.01)  2.11 (0.03)  1.95 (0.06)  1.78 (0.07)
    exponential, Butterworth 5 / period 2.20 (0.01)  2.13 (0.03)  1.97 (0.06)  1.80 (0.07)
    exponential, not smoothed           4.64 (0.19)  2.85 (0.28)  2.26 (0.24)  1.86 (0.21)
    sine, this moving average           0.99 (0.02)  0.99 (0.02)  0.99 (0.03)  0.99 (0.04)
    sine, not smoothed                  0.99 (0.03)  0.97 (0.03)  0.95 (0.07)  0.99 (0.10)

Noise draws R towards 1 whatever the filter, so it can hide stiction and hardly ever invents it. A cut fixed to
the period blunts the corner of clean data (2.20 at 2 % noise); the filters that look at the noise first do
not. The moving average is the default, being as good as the Kalman smoother and far simpler.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from stickslip.detect.half_waves.half_cycles import SAMPLES_MIN, HalfCycle, in_pieces
from stickslip.detect.health import conditions
from stickslip.detect.health.fact import Fact
from stickslip.detect.oscillation import acf_crossings as oscillation
from stickslip.detect.oscillation.pieces import Pieces, pieces_of
from stickslip.detect.signals.gaps import SINGLE_STEPS, Gap, falls_into, gaps_in
from stickslip.detect.signals.order import median_step
from stickslip.detect.verdict import Code
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values


class Refusal(NamedTuple):
    """Why a record cannot be cut into half cycles: the code of the verdict and a sentence."""

    code: Code
    reason: str


@dataclass(frozen=True)
class Params:
    """Preparation of e.

    smooth_max : widest moving average [share of the period]
    noise_share : noise that smoothing aims to leave [share of the signal's standard deviation]
    drift_share : a baseline that moves by more than this share of the swing's standard deviation is taken off
    gate : oscillation.Params; test for an oscillation
    """

    smooth_max: float = 0.10
    noise_share: float = 0.03
    drift_share: float = 0.15
    gate: oscillation.Params = field(default_factory=oscillation.Params)


@dataclass(frozen=True, eq=False)
class Cycles:
    """The half cycles of a record or a block, and what was found on the way.

    half_cycles : tuple of HalfCycle, in order of time, faulty ones marked
    period, dt : float [s]; mean period and median sampling interval
    regularity : float [-], of the gate
    notes : tuple of str, what was assumed or done, without full stops
    centre : what e is measured from: "SP", or "its mean" when SP is not logged
    t, e : (m,) [s], [unit of PV]; the prepared error, NaN between pieces
    """

    half_cycles: tuple[HalfCycle, ...]
    period: float
    regularity: float
    dt: float
    notes: tuple[str, ...]
    centre: str
    t: Values
    e: Values


def cut(
    record: LoopRecord, p: Params | None = None, pieces: Pieces | None = None, facts: tuple[Fact, ...] | None = None
) -> Cycles | Refusal:
    """The half cycles of a record, or why there are none; ``pieces`` and ``facts`` where they are known already.

    >>> t = np.arange(500.0)
    >>> found = cut(LoopRecord.from_arrays(t, pv=np.sin(t / 8), op=50 + np.cos(t / 8), sp=0 * t))
    >>> len(found.half_cycles), round(found.period, 1)
    (18, 50.3)
    """
    p = p or Params()
    facts = conditions.examine(record) if facts is None else facts
    if refusal := preconditions(record, facts):
        return refusal
    pieces = pieces_of(record, p.gate) if pieces is None else pieces
    t, gate = pieces.longest[0], pieces.gate
    if len(t) < 20:
        return Refusal(
            "too_few_cycles",
            f"The record has {len(record)} samples, {len(t)} in its longest stretch without gaps, bad "
            f"samples or set-point moves: too few for even one cycle{_tail(pieces)}.",
        )
    if not gate.oscillating or gate.period is None:
        return _no_oscillation(pieces, p)
    dt = median_step(t)
    if gate.period / dt < 2 * (SAMPLES_MIN + 1):
        return Refusal(
            "undersampled",
            f"The period of {gate.period:.4g} s has {gate.period / dt:.1f} samples; "
            f"at least {2 * (SAMPLES_MIN + 1)} are needed to see where a peak sits.",
        )
    if refusal := _drawn(record, facts, gate.period, dt):
        return refusal
    notes: list[str] = []
    centre = "SP"
    if record.sp is None:
        centre = "its mean"
        notes.append("SP is not logged: the mean of PV stands for it")
    if record.process == "unknown" and not record.measurement:
        notes.append("the process is taken as self-regulating")
    if len(gate.stretches) > 1:
        periods = [stretch.period for stretch in gate.stretches]
        notes.append(f"the period drifts between {min(periods):.4g} and {max(periods):.4g} s")
    found, t, e, drifts = _cut_pieces(pieces, _long(record), p)
    if drifts:
        notes.append("a drifting baseline was taken off")
    return Cycles(found, gate.period, gate.regularity, dt, (*notes, *pieces.notes), centre, t, e)


def _long(record: LoopRecord) -> tuple[Gap, ...]:
    """The gaps in which a peak is not seen; a single missing sample hides none."""
    return tuple(gap for gap in gaps_in(record) if gap.length > SINGLE_STEPS * record.dt)


def _cut_pieces(pieces: Pieces, gaps: tuple[Gap, ...], p: Params) -> tuple[tuple[HalfCycle, ...], Values, Values, bool]:
    """The half cycles of all pieces that are long enough, their t and e with NaN between, whether a drift came off."""
    read = [
        (t, x, period) for t, x, period in pieces.stretches(p.gate) if len(t) >= 20 and t[-1] - t[0] >= 1.5 * period
    ]
    if not read:
        return (), np.empty(0), np.empty(0), False
    bounds = np.cumsum([0, *(len(t) for t, _, _ in read)])
    t, x = (np.concatenate([piece[k] for piece in read]) for k in (0, 1))
    found, e, drifts = in_pieces(
        t, x, bounds, np.array([period for _, _, period in read]), p.smooth_max, p.noise_share, p.drift_share
    )
    if gaps:
        hidden = (not half.fault and falls_into(gaps, half.peak_time) for half in found)
        found = [half._replace(fault="gap") if gone else half for half, gone in zip(found, hidden, strict=True)]
    shown_t, shown_e = (np.insert(y, bounds[1:], np.nan) for y in (t, e))
    return tuple(found), shown_t, shown_e, drifts


def preconditions(record: LoopRecord, facts: tuple[Fact, ...] | None = None) -> Refusal | None:
    """The first fact of the record that forbids to read its shape, or None; ``facts`` where they are known already."""
    for fact in conditions.examine(record) if facts is None else facts:
        if fact.present and fact.forbids and fact.code != "compressed":
            return Refusal(fact.code, fact.text + _REMEDY.get(fact.code, ""))
    return None


_REMEDY = {
    "manual_mode": " A loop that is not controlled makes no limit cycle of its own.",
    "op_saturated": " A wave cut off by the limit has the shape of the limit.",
    "sp_not_constant": " The wave may be that of the set point; use a window with a fixed set point.",
    "quantised": " The steps of the grid would pass for slips.",
}


def _no_oscillation(pieces: Pieces, p: Params) -> Refusal:
    gate = pieces.gate
    code: Code = "no_oscillation"
    if gate.period is not None and gate.cycles < p.gate.cycles_min:
        code = "too_few_cycles"
    return Refusal(
        code,
        f"{gate.reason.removesuffix('.')}{_tail(pieces)}. Shape methods compare half cycles of a sustained "
        "oscillation; stiction without a limit cycle stays unseen.",
    )


def _tail(pieces: Pieces) -> str:
    return "".join(f"; {note}" for note in pieces.notes)


def _drawn(record: LoopRecord, facts: tuple[Fact, ...], period: float, dt: float) -> Refusal | None:
    """Refuse a compressed log when too few measured points are left in a half cycle."""
    fact = next((fact for fact in facts if fact.code == "compressed"), None) or conditions.compressed(record)
    points = (1 - fact.value) * period / (2 * dt)
    if fact.present and points < SAMPLES_MIN:
        return Refusal(
            "compressed",
            f"{fact.text} {points:.1f} measured points are left in a half cycle, {SAMPLES_MIN} are needed: "
            "the shape is the historian's (or the wave has perfectly straight sides, which looks the same).",
        )
    return None
