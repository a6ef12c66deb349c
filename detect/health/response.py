"""Does PV answer OP: no flow, a closed block valve or a dead transmitter leave OP running while PV rests.

    travel     range of OP, 5 to 95 % of its samples
    swing      standard deviation of the means of PV over blocks, over what its noise alone gives (1 for white noise)
    off        |mean e| / sd(e): a loop that works brings e to zero, even where a load ramp lets OP travel and PV rest

PV does not respond where OP travels, the blocks of PV move by no more than noise, and PV stays off SP.  And a frozen
transmitter repeats its last value, bit for bit, while OP moves on.  The limits are ours.
"""

import math

import numpy as np
from stickslip.detect.health.fact import Fact
from stickslip.detect.signals.runs import stands
from stickslip.logs import LoopRecord

TRAVEL_PERCENT = 2.0  # of the span of OP, from which on it is a travel
BLOCKS = 40
ROUNDING = 1e-9  # of OP: a smaller step is that of a simulated controller whose integral has settled


def unresponsive(record: LoopRecord, limit: float = 1.7) -> Fact:
    """Swing of PV over its noise [-]; below ``limit`` with OP that travels and PV off SP, PV does not answer OP."""
    remedy = "Check the block valves, the flow and the transmitter; log a stretch in which the loop works."
    from stickslip.detect.signals.kernels import spread

    percent, e, kept = record.op_percent, record.e, record.kept
    n = int(np.count_nonzero(record.good))
    if percent is None or e is None or n < 4 * BLOCKS:
        text = "Whether PV answers OP is not judged: the span of OP or SP is unknown, or the record short."
        return Fact("pv_unresponsive", False, 0.0, limit, text, remedy, judged=False)
    each = n // BLOCKS
    pv = record.pv[kept]
    white = spread(np.diff(pv))[1] / np.sqrt(2.0 * each)
    swing = float(spread(pv[: BLOCKS * each].reshape(BLOCKS, each).mean(axis=1))[1] / max(white, 1e-300))
    off, sd = spread(e[kept])
    quiet = swing < limit and abs(off) > 3.0 * sd > 0.0
    travel = float(np.subtract(*np.percentile(percent[kept], [95, 5]))) if quiet else math.nan
    dead = quiet and travel > TRAVEL_PERCENT
    text = (
        f"OP travels {travel:.3g} % of its span while PV moves by {swing:.2g} times what its noise gives ("
        f"{limit:g} needed) and stays {abs(off):.3g} off SP: PV does not respond to OP (no flow, or no authority)."
        if dead
        else f"PV moves by {swing:.3g} times what its noise alone gives."
    )
    return Fact("pv_unresponsive", dead, swing, limit, text, remedy)


def frozen(record: LoopRecord, limit: float = 0.2) -> Fact:
    """Share of the record in the longest stand of PV, bit for bit, while OP moves [-]."""
    remedy = "Check the transmitter, and log a stretch in which it lives."
    pv, op = record.pv[record.kept], record.op[record.kept]
    if len(pv) < 2:
        return Fact("frozen_pv", False, 0.0, limit, "PV is too short to look for a stand.", remedy, judged=False)
    first, lengths = stands(pv)
    start, length = (int(each[np.argmax(lengths)]) for each in (first, lengths))
    share = length / len(pv)
    while_still = op[start : start + length] if share > limit else op[:1]
    moves = int(np.count_nonzero(np.abs(np.diff(while_still)) > ROUNDING * np.max(np.abs(while_still))))
    found = moves > 0.5 * length and length > 10.0 * float(
        np.percentile(lengths, 90)
    )  # on a coarse grid PV stands often, and as long
    text = (
        f"PV repeats {pv[start]:.6g}, bit for bit, over {length} samples ({share:.0%} of the record, {limit:.0%} "
        f"allowed) while OP moves {moves} times: the transmitter or its line is dead there."
        if found
        else f"PV stands for {length} samples at most."
    )
    return Fact("frozen_pv", found, share, limit, text, remedy)
