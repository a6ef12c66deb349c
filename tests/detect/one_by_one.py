"""What the detectors do with arrays or a whole stream, asked for one half cycle or one sample after the other."""

import numpy as np
from stickslip.detect.half_waves.half_cycle_kernels import FAULTS, half_cycle
from stickslip.detect.half_waves.half_cycles import FLAT_SHARE, KINK, SAMPLES_MIN, TWO_PEAKS_SHARE, HalfCycle
from stickslip.detect.stream import LoopFacts, Sample


def replay(twin, record, p):
    """Feed a record sample by sample to a streaming twin (``window_twin.twin_of``) and return its final state.

    Bad samples go in as NaN, as a gateway would deliver them.
    """
    state, log = twin.init(p, LoopFacts.of(record)), record.log
    pv = np.where(log.good(record.pv_name), record.pv, np.nan)
    op = np.where(log.good(record.op_name), record.op, np.nan)
    sp = np.full(len(record), np.nan)
    if record.sp is not None and record.sp_name is not None:
        sp = np.where(log.good(record.sp_name), record.sp, np.nan)
    mode = np.ones(len(record)) if record.mode is None else record.mode
    for t, *row in zip(record.t, pv, op, sp, mode, strict=True):
        state = twin.update(p, state, float(t), Sample(*map(float, row)))
    return state


def measure(t, x, start, end, noise=0.0):
    """Return the half cycle of x between the crossings ``start`` and ``end`` [s], with ``noise`` left in x."""
    shares = SAMPLES_MIN, FLAT_SHARE, TWO_PEAKS_SHARE, KINK
    fault, peak_time, *rest = half_cycle(np.ascontiguousarray(t), np.ascontiguousarray(x), start, end, noise, *shares)
    return HalfCycle(start, peak_time, end, *rest, FAULTS[fault])
