"""When a controller scans between the rows of a log, which no clock says where rows are no multiple of its scans."""

import math
from dataclasses import replace

import numpy as np
from stickslip.gap.likelihood.fit import tried
from stickslip.gap.likelihood.hypothesis import Innovations

PHASES = 8  # shares of a scan that are tried
CLEAR = 10.0  # nats that another phase must gain


def in_phase(now: Innovations) -> Innovations:
    """Return a filter of the same values with rows at the likeliest time behind a scan; the same if none is clear."""
    frame = now.hypothesis.frame
    log, scan = frame.record.log, frame.scanned
    if scan == 0.0 or abs(log.dt / scan - round(log.dt / scan)) < 1e-6:
        return now
    first = math.floor(log.t[0] / scan) * scan
    shifted = [replace(log, t=log.t + (first + scan * k / PHASES - log.t[0])) for k in range(PHASES)]
    frames = [replace(frame, record=replace(frame.record, log=one)) for one in shifted]
    left = [tried(now.hypothesis.of(one), now.values) for one in frames]
    likeliest = left[int(np.argmin([math.inf if one is None else one.nll for one in left]))]
    return likeliest if likeliest is not None and likeliest.nll < now.nll - CLEAR else now
