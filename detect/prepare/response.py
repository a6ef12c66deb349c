"""Does PV answer OP: no flow, a closed block valve or a dead transmitter leave OP running while PV rests.

    travel     range of OP, 5 to 95 % of its samples
    swing      standard deviation of the means of PV over blocks, over what its noise alone gives (1 for white noise)
    off        |mean e| / sd(e): a loop that works brings e to zero, even where a load ramp lets OP travel and PV rest

PV does not respond where OP travels, the blocks of PV move by no more than noise, and PV stays off SP.  And a frozen
transmitter repeats its last value, bit for bit, while OP moves on.  The limits are ours.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from detect.prepare.fact import Fact
from logs import LoopRecord

__all__ = ["frozen", "unresponsive"]

Values = npt.NDArray[np.float64]
TRAVEL = 2.0  # % of the span of OP that is a travel
BLOCKS = 40


def unresponsive(record: LoopRecord, limit: float = 1.7) -> Fact:
    """Swing of PV over its noise [-]; below ``limit`` with OP that travels and PV off SP, PV does not answer OP."""
    remedy = "Check the block valves, the flow and the transmitter; log a stretch in which the loop works."
    percent, e, good = record.op_percent, record.e, record.good
    n = int(np.count_nonzero(good))
    if percent is None or e is None or n < 4 * BLOCKS:
        text = "Whether PV answers OP is not judged: the span of OP or SP is unknown, or the record short."
        return Fact("pv_unresponsive", False, 0.0, limit, text, remedy)
    each = n // BLOCKS
    pv, off = record.pv[good], e[good]
    low, high = np.percentile(percent[good], [5, 95])
    white = float(np.std(np.diff(pv))) / np.sqrt(2.0 * each)
    swing = float(np.std(pv[: BLOCKS * each].reshape(BLOCKS, each).mean(axis=1))) / max(white, 1e-300)
    away = abs(float(np.mean(off))) > 3.0 * float(np.std(off)) > 0.0
    dead = bool(high - low > TRAVEL and swing < limit and away)
    text = (
        f"OP travels {high - low:.3g} % of its span while PV moves by {swing:.2g} times what its noise gives ("
        f"{limit:g} needed) and stays {abs(float(np.mean(off))):.3g} off SP: PV does not respond to OP (no flow, or no "
        "authority)."
        if dead
        else f"PV moves by {swing:.3g} times what its noise alone gives."
    )
    return Fact("pv_unresponsive", dead, swing, limit, text, remedy)


def frozen(record: LoopRecord, limit: float = 0.2) -> Fact:
    """Share of the record in the longest stand of PV, bit for bit, while OP moves [-]."""
    remedy = "Check the transmitter, and log a stretch in which it lives."
    pv, op = record.pv[record.good], record.op[record.good]
    if len(pv) < 2:
        return Fact("frozen_pv", False, 0.0, limit, "PV is too short to look for a stand.", remedy)
    edges = np.concatenate([[0], np.flatnonzero(np.diff(pv)) + 1, [len(pv)]])
    lengths = np.diff(edges)
    longest = int(np.argmax(lengths))
    start, stop = int(edges[longest]), int(edges[longest + 1])
    moves = int(np.count_nonzero(np.diff(op[start:stop])))
    share = (stop - start) / len(pv)
    ordinary = float(np.percentile(lengths, 90))  # on a coarse grid PV stands often, and as long
    found = bool(share > limit and moves > 0.5 * (stop - start) and stop - start > 10.0 * ordinary)
    text = (
        f"PV repeats {pv[start]:.6g}, bit for bit, over {stop - start} samples ({share:.0%} of the record, {limit:.0%} "
        f"allowed) while OP moves {moves} times: the transmitter or its line is dead there."
        if found
        else f"PV stands for {stop - start} samples at most."
    )
    return Fact("frozen_pv", found, share, limit, text, remedy)
