"""When a controller scans between the rows of a log, which no clock says where rows are no multiple of its scans."""

import math
from dataclasses import replace

from stickslip.gap.likelihood.fit import tried
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.hypothesis import Innovations

PHASES = 8  # shares of a scan that are tried
CLEAR = 10.0  # nats that another phase must gain
ROWS = 400  # in which phases that lag are left out


def in_phase(now: Innovations) -> Innovations:
    """Return a filter of the same values with rows at the likeliest time behind a scan; the same if none is clear."""
    frame = now.hypothesis.frame
    log, scan = frame.record.log, frame.scanned
    if scan == 0.0 or abs(log.dt / scan - round(log.dt / scan)) < 1e-6:
        return now
    first = math.floor(log.t[0] / scan) * scan
    starts = [first + scan * k / PHASES for k in range(PHASES)]
    likeliest, least = now, now.nll - CLEAR
    for one in _likely(now, [_shifted(frame, t) for t in starts if abs(t - log.t[0]) > 1e-6 * scan]):
        found = tried(now.hypothesis.of(one), now.values)
        if found is not None and found.nll < least:
            likeliest, least = found, found.nll
    return likeliest


def _shifted(frame: Frame, start: float) -> Frame:
    """Return the frame with rows from another time on [s]."""
    log = frame.record.log
    return replace(frame, record=replace(frame.record, log=replace(log, t=log.t + (start - log.t[0]))))


def _likely(now: Innovations, frames: list[Frame]) -> list[Frame]:
    """Return the frames that may be the likeliest: in first rows none is so by more than is clear."""
    share = ROWS / len(now.losses)
    if share >= 0.5:
        return frames
    heads = [replace(one, record=one.record.first_part(share)) for one in frames]
    left = [tried(now.hypothesis.of(one), now.values) for one in heads]
    losses = [math.inf if one is None else one.nll for one in left]
    return [one for one, loss in zip(frames, losses, strict=True) if loss < min(losses) + CLEAR]
