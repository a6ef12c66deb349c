"""Stale collection: PV and OP stand still together, bit for bit, because the historian had nothing new.

    held(k) = PV(k) == PV(k-1) and OP(k) == OP(k-1)

A valve cannot do that: while PV stands, a controller with integral action moves OP.  Nor do coarse signals: then either
also stands while the other moves.  Held samples were not measured; ``without_stale`` marks them as bad, so that no
method takes them for a stem at rest, and short holds are bridged as any gap.  The limits are ours.
"""

from dataclasses import replace

import numpy as np
from stickslip.detect.health.fact import Fact
from stickslip.detect.signals.runs import runs
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Mask, Values

HELD_SHARE = 0.02  # of the samples, from which on holds are counted as stale
TOGETHER_SHARE = 0.8  # of the holds of either signal that the other must share
RUNS = 5  # holds that make a habit; a loop at rest stands once, for long
USELESS_SHARE = 0.7  # of the samples held, beyond which too little was measured


def held(record: LoopRecord) -> Mask:
    """True where PV and OP both repeat the sample before, (n,).

    >>> held(LoopRecord.from_arrays(range(4), pv=[1, 1, 2, 2], op=[5, 5, 5, 6])).tolist()
    [False, True, False, False]
    """
    return np.concatenate([[False], _repeats(record.pv) & _repeats(record.op)])


def stale(record: LoopRecord) -> Fact:
    """Share of samples held, where the two signals stand together and seldom alone; methods refuse above 70 %."""
    pv, op = _repeats(record.pv), _repeats(record.op)
    share = int(np.sum(pv & op)) / max(len(record), 1)
    alone, holds = max(int(pv.sum()), int(op.sum())) / max(len(pv), 1), len(runs(pv & op)[0])
    together = share > HELD_SHARE and holds >= RUNS and share >= TOGETHER_SHARE * alone
    if not together:
        text = f"PV and OP stand still together in {share:.0%} of the samples, which is no more than chance or rest."
        return Fact("stale_data", False, share, HELD_SHARE, text)
    text = (
        f"PV and OP stand still together, bit for bit, in {share:.0%} of the samples, {holds} times ({HELD_SHARE:.0%} "
        "allowed): stale collection. These samples are taken as missing."
    )
    remedy = "Log PV and OP at the controller's scan, without exception or caching, on one clock."
    return Fact("stale_data", True, share, HELD_SHARE, text, remedy, forbids=share > USELESS_SHARE)


def without_stale(record: LoopRecord) -> LoopRecord:
    """The record with its stale samples marked as bad; itself where there are none."""
    if not stale(record).present:
        return record
    quality = {**record.log.quality, record.pv_name: record.log.good(record.pv_name) & ~held(record)}
    return replace(record, log=replace(record.log, quality=quality))


def _repeats(x: Values) -> Mask:
    return np.asarray(x[1:] == x[:-1])
