"""Is the controller in charge: does it move OP by itself, and does PV come to the set point?

    copied     |corr(OP, PV)| at the same instant: OP that copies PV is tracking, or the tags are mixed up
    asleep     share of samples in long stands of OP, bit for bit, while PV moves and is off SP: manual without a mode
    untracked  |mean e| / sd(e): a controller with integral action brings it to zero

The limits are ours.
"""

import math

import numpy as np
from stickslip.detect.health.fact import Fact
from stickslip.detect.signals.runs import stands
from stickslip.logs import LoopRecord

STAND_SAMPLES = 30  # samples, from which on a stand of OP is long
END_SHARE = 0.005  # of the span of OP, within which it stands at a limit


def copied(record: LoopRecord, limit: float = 0.9999) -> Fact:
    """Correlation of OP and PV at the same instant [-]; above ``limit`` OP is a copy of PV.

    Methods refuse where OP is PV, number by number; a P controller copies PV too, turned over or to another scale.
    """
    pv, op = record.pv[record.kept], record.op[record.kept]
    y, u = (x - x[:1] for x in (pv, op))  # so that what stands has no spread at all
    size = float(np.std(y) * np.std(u)) if len(pv) >= 50 else 0.0
    alike = abs(float(np.mean((y - y.mean()) * (u - u.mean())))) / size if size > 0.0 else 0.0
    same = size > 0.0 and bool(np.array_equal(pv, op))
    text = f"OP is no copy of PV (correlation {alike:.3f})."
    if alike > limit:
        scale = f"OP is PV but for scale and offset (correlation {alike:.5f}, {limit:g} allowed)"
        text = (
            "OP and PV are the same numbers: OP tracks PV, the controller is not in charge, or a tag is given twice."
            if same
            else f"{scale}: the controller is proportional only, or tracks; its picture with PV shows no valve."
        )
    return Fact("not_in_charge", alike > limit, alike, limit, text, "Log the controller's output in automatic.", same)


def asleep(record: LoopRecord, limit: float = 0.5) -> Fact:
    """Return the share of the samples [-] at which the controller does nothing, though it should.

    OP stands there for 30 samples or more, while PV moves and stays off SP by its swing."""
    remedy = "Log the controller's mode, and a stretch in automatic."
    if record.mode is not None or record.e is None:
        why = "SP is not logged" if record.mode is None else "the mode is logged"
        return Fact("manual_mode", False, 0.0, limit, f"OP is not searched for stands: {why}.", judged=False)
    from stickslip.detect.signals.kernels import spread

    op, pv, e = record.op[record.kept], record.pv[record.kept], record.e[record.kept]
    asleep = 0
    low, high = record.op_span or (-math.inf, math.inf)
    near = END_SHARE * (high - low) if math.isfinite(high - low) else 0.0
    first, length = stands(op)
    for start, end in np.column_stack([first, first + length])[length >= STAND_SAMPLES].tolist():
        if not low + near < op[start] < high - near:
            continue  # at its limit OP is not asleep, but saturated, which another fact says
        off, swing = spread(e[start:end])[0], spread(pv[start:end])[1]
        asleep += end - start if swing > 0.0 and abs(off) > swing else 0
    share = asleep / max(len(op), 1)
    text = (
        f"OP stands while PV moves off SP in {share:.0%} of the samples ({limit:.0%} allowed), "
        f"in stands of {STAND_SAMPLES} samples and more: the controller is in manual, or held."
        if share > limit
        else f"OP stands while PV is off SP in {share:.0%} of the samples."
    )
    return Fact("manual_mode", share > limit, share, limit, text, remedy)


def untracked(record: LoopRecord, limit: float = 3.0) -> Fact:
    """Mean of e over its standard deviation [-]. Reported, not refused: a P controller has an offset by nature."""
    e = record.e
    if e is None or not record.good.any():
        why = "SP is not logged, so that tracking is not seen."
        return Fact("not_in_charge", False, 0.0, limit, why, forbids=False, judged=False)
    from stickslip.detect.signals.kernels import spread

    mean, sd = spread(e[record.kept])
    off = abs(mean)
    ratio = off / sd if sd > 0.0 else (math.inf if off > 0.0 else 0.0)
    text = (
        f"PV keeps {off:.4g} off SP, {ratio:.1f} standard deviations of e ({limit:g} allowed): the set point is not "
        "tracked (no integral action, a limit, or the set point of another loop)."
        if ratio > limit
        else f"PV is {off:.4g} off SP on average."
    )
    return Fact(
        "not_in_charge", ratio > limit, ratio, limit, text, "Log the set point that the controller uses.", False
    )
