"""The record of a loop in a historian: rounding, compression, tags; and the truth of the run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from stickslip.calibration.crossed.drawing import Drawn
from stickslip.calibration.crossed.loops import run
from stickslip.calibration.crossed.tuning import tuned
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values


@dataclass(frozen=True)
class Seen:
    """A record, what was drawn, OP's travel over S and how often the stem turned round.

    ``shows``: the stem turns at least four times and OP travels at least 0.8 S, so that something can be seen.
    """

    record: LoopRecord
    drawn: Drawn
    travel: float
    turns: int

    @property
    def shows(self) -> bool:
        """Whether there is something to be seen of a stick."""
        return self.turns >= 4 and self.travel >= 0.8


def seen(d: Drawn) -> Seen:
    """Simulate a drawn loop and log it."""
    made = tuned(d)
    n = made.numbers
    out = np.zeros((4, n.steps // made.every))
    run(np.random.default_rng(d.seed), n, made.every, out)
    sp, pv, op, stem = (np.asarray(x, dtype=np.float64) for x in out[:, min(20, out.shape[1] // 10) :])
    dt = made.every * n.h
    t: Values = dt * np.arange(float(len(pv)))
    pv = np.minimum(np.maximum(pv, -50.0), 50.0)
    if d.rounded > 0.0:
        step = d.rounded * max(float(np.ptp(pv)), 1e-9)
        pv = step * np.floor(pv / step + 0.5)  # to the nearest
    if d.compressed == "swinging_door":
        pv, op = (_swinging_door(t, x, door) for x, door in ((pv, d.door), (op, 0.5 * d.door)))
    elif d.compressed == "exceptions":
        pv, op = _exceptions(pv, d.door), _exceptions(op, 0.5 * d.door)
    tag = {"flow": "F", "pressure": "P", "temperature": "T", "level": "L"}[d.process] if d.tagged else "X"
    record = LoopRecord.from_arrays(
        t, pv=50.0 + pv, op=50.0 + op, sp=50.0 + sp if d.sp_logged else None, op_span=(0.0, 100.0),
        name=f"{tag}IC{d.seed % 1000:03d}" if d.tagged else "",
    )  # fmt: skip
    travel = float(np.subtract(*np.percentile(op, [99, 1]))) / d.S
    return Seen(record, d, travel, _turns(stem, 0.2 * min(d.S, float(np.ptp(stem)) + 1e-12)))


def _turns(x: Values, least: float) -> int:
    """How often x turns round by more than ``least``."""
    turned, way, high, low = 0, 0, float(x[0]), float(x[0])
    for value in x.tolist():
        high, low = max(high, value), min(low, value)
        if way >= 0 and high - value >= least:
            turned, way, low = turned + (way > 0), -1, value
        if way <= 0 and value - low >= least:
            turned, way, high = turned + (way < 0), 1, value
    return turned


def _exceptions(x: Values, door: float) -> Values:
    """What is held until the signal is ``door`` of its range away."""
    band, kept, out = door * float(np.ptp(x)), float(x[0]), np.empty_like(x)
    for i, value in enumerate(x.tolist()):
        if abs(value - kept) > band:
            kept = value
        out[i] = kept
    return out


def _swinging_door(t: Values, x: Values, door: float) -> Values:
    """Straight lines between the points that a swinging door of ``door`` of the range keeps."""
    band = door * float(np.ptp(x))
    kept, first = [0], 0
    up, down = np.inf, -np.inf
    for i in range(1, len(x)):
        span = t[i] - t[first]
        up, down = min(up, (x[i] + band - x[first]) / span), max(down, (x[i] - band - x[first]) / span)
        if down > up:
            first = i - 1
            kept.append(first)
            span = t[i] - t[first]
            up, down = (x[i] + band - x[first]) / span, (x[i] - band - x[first]) / span
    kept.append(len(x) - 1)
    return np.asarray(np.interp(t, t[kept], x[kept]))
