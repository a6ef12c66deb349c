"""Under what conditions a record was taken: what a simulation needs to make records like it.

Everything is measured on the record alone and counts in shares of its own ranges, in periods and in samples; the period
is the mean time between crossings of OP, as in ``crossings``.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stickslip.calibration.crossings import extent, period
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values
from stickslip.logs.normal import spread_about

LEVELS = 0.25  # a signal with fewer different values per sample than this is rounded
STRAIGHT = 0.3  # share of points on a straight line with their neighbours from which a signal is compressed
HELD = 0.02  # share of samples at which PV and OP both stand still, from which collection was stale
ALWAYS = 0.2  # share of samples at which SP moves, from which it is that of a slave


@dataclass(frozen=True)
class Conditions:
    """How a record was taken.

    samples : int              in the record
    points : float             samples per period
    dt : float                 sampling interval [s]
    op_range, op_mean : float  range and mean of OP [% of its span, or of its unit where no span is known]
    noise : float              standard deviation of what PV does from sample to sample [share of its range]
    step_pv, step_op : float   steps per range of PV and OP; 0: not rounded
    compressed : bool          whether the signals are joined by straight lines
    stale, stale_hold : float  share of samples held [-], mean length of a hold [samples]
    sp : str                   "none", "still", "moves", "always"
    sp_move, sp_hold : float   range of SP over that of PV [-], mean time between moves [periods]
    drifting : float           range of the moving average of OP over three periods, share of the range of OP
    limited : float            share of samples at which OP stands at its highest or lowest value
    integrating : bool or None whether the process integrates; None where nobody said
    span_known : bool
    """

    samples: int
    points: float
    dt: float
    op_range: float
    op_mean: float
    noise: float
    step_pv: float
    step_op: float
    compressed: bool
    stale: float
    stale_hold: float
    sp: str
    sp_move: float
    sp_hold: float
    drifting: float
    limited: float
    integrating: bool | None
    span_known: bool


def conditions(record: LoopRecord) -> Conditions:
    """Return the conditions of a record; samples that are missing are left out.

    Raises ``ValueError`` if OP or PV does not move, or fewer than 40 samples are good.

    >>> import numpy as np
    >>> t = np.arange(800.0)
    >>> seen = conditions(LoopRecord.from_arrays(t, pv=np.sin(t / 4), op=50 - 5 * np.cos(t / 4), sp=0 * t))
    >>> round(seen.points), round(seen.op_range), seen.sp, seen.compressed
    (25, 10, 'still', False)
    """
    good = record.good
    op: Values = (record.op if record.op_percent is None else record.op_percent)[good]
    pv = record.pv[good]
    if len(op) < 40:
        raise ValueError(f"{len(op)} good samples of OP and PV; a simulation of the record needs at least 40")
    op_range, pv_range = extent(op), extent(pv)
    for name, size in (("OP", op_range), ("PV", pv_range)):
        if not size > 0.0:
            raise ValueError(f"{name} does not move; there is nothing that a simulation could be compared with")
    still = (np.diff(op) == 0.0) & (np.diff(pv) == 0.0)
    fresh = np.concatenate([[True], ~still])
    stale = float(still.mean()) if still.mean() > HELD else 0.0
    points = period(op)
    points = min(points, len(op) / 2.0) if points == points else len(op) / 2.0
    word, move, hold = _set_point(None if record.sp is None else record.sp[good], pv_range, points)
    return Conditions(
        samples=len(op),
        points=points,
        dt=record.dt,
        op_range=op_range,
        op_mean=float(op.mean()),
        noise=_noise(pv[fresh]) / pv_range,
        step_pv=_steps(pv[fresh]),
        step_op=_steps(op[fresh]),
        compressed=_straight(pv[fresh]) > STRAIGHT,
        stale=stale,
        stale_hold=len(op) * stale / max(_runs(still), 1),
        sp=word,
        sp_move=move,
        sp_hold=hold,
        drifting=_drifting(op, points) / op_range,
        limited=float(np.mean((op <= op.min()) | (op >= op.max()))),
        integrating=None if record.process == "unknown" else record.process == "integrating",
        span_known=record.op_span is not None,
    )


def _noise(values: Values) -> float:
    """Return the standard deviation of white noise on a smooth signal, from its third differences."""
    if len(values) < 8:
        return 0.0
    third = np.diff(values, 3)
    return spread_about(third) / math.sqrt(20.0)


def _steps(values: Values) -> float:
    """Return the steps per range of a rounded signal; 0 for one that is not."""
    levels = np.unique(values)
    if len(levels) < 3 or len(levels) > LEVELS * len(values):
        return 0.0
    step = float(np.median(np.diff(levels)))
    return extent(values) / step


def _straight(values: Values) -> float:
    """Return the share of samples on the line of their neighbours, where the signal moves."""
    second = np.abs(np.diff(values, 2))
    moving = np.abs(np.diff(values))[1:] > 0.0
    return float((second[moving] < 1e-6 * extent(values)).mean()) if moving.any() else 0.0


def _runs(still: NDArray[np.bool_]) -> int:
    """Return how many stretches of True there are."""
    return int((np.diff(np.concatenate([[False], still]).astype(int)) == 1).sum())


def _drifting(op: Values, points: float) -> float:
    """Return the range of the moving average over three periods [unit of OP]."""
    width = max(1, min(round(3.0 * points), len(op)))
    sums = np.concatenate([[0.0], np.cumsum(op)])
    return float(np.ptp((sums[width:] - sums[:-width]) / width))


def _set_point(sp: Values | None, pv_range: float, points: float) -> tuple[str, float, float]:
    """Return how SP moves, by how much [ranges of PV], and how long it stands [periods]."""
    if sp is None:
        return "none", 0.0, 0.0
    moves = int((np.diff(sp) != 0.0).sum())
    if not moves:
        return "still", 0.0, 0.0
    word = "always" if moves > ALWAYS * len(sp) else "moves"
    return word, float(np.ptp(sp)) / pv_range, len(sp) / moves / points
