"""When a controller scans between the rows of a log, which no clock says where rows are no multiple of its scans."""

import math
from dataclasses import replace

import numpy as np
from stickslip.gap.likelihood.fit import tried
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.hypothesis import Innovations
from stickslip.gap.likelihood.switches import with_switches
from stickslip.logs.arrays import Values

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
    others = {_scans_before(log.t + (start - log.t[0]), scan): _shifted(frame, start) for start in starts}
    others.pop(_scans_before(log.t, scan), None)
    if not others:
        return now
    likeliest, least = now, with_switches(now).nll - CLEAR
    for one in _likely(now, list(others.values())):
        found = _switched(now, one)
        if found is not None and found.nll < least:
            likeliest, least = found, found.nll
    return likeliest


def _scans_before(t: Values, scan: float) -> bytes:
    """Return how many scans lie before each row, and at which rows: phases that do not differ in it are one."""
    scans = t / scan
    near = np.round(scans)
    at = np.abs(scans - near) < 1e-6
    return np.where(at, 2 * near, 2 * np.floor(scans) + 1).tobytes()


def _switched(now: Innovations, frame: Frame) -> Innovations | None:
    """Return what is left in a frame, its inputs switching when that suits it: those of another phase may not."""
    found = tried(now.hypothesis.of(frame), now.values)
    return None if found is None else with_switches(found)


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
    left = [_switched(now, one) for one in heads]
    losses = [math.inf if one is None else one.nll for one in left]
    return [one for one, loss in zip(frames, losses, strict=True) if loss < min(losses) + CLEAR]
